"""Any bytes at all as a conversation: nothing is raised, and answers are sound frames."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot import commands, wire
from tests.link.sessions import reply
from tests.rig import Rig, whole
from tests.talk import Client

strings = st.text(max_size=20) | st.sampled_from(
    ("\U0001f9be" * 300, "\x7f" * 3000, "\u20ac" * 1300, "\ud800" * 600)
)
values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | strings | st.just(10**3000),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=8,
)
names = st.sampled_from(
    (
        "id",
        "do",
        "from",
        "table",
        "kick",
        "set",
        "proof",
        "protocol",
        "name",
        "client",
        "nonce",
        "mode",
        "k",
    )
)
sensible = st.fixed_dictionaries(
    {"do": st.sampled_from(list(commands.TABLE)) | values, "id": st.integers(0, 9) | values},
    optional={
        "kick": st.dictionaries(st.sampled_from(("id", "mode", "ticks", "wheel")), values) | values,
        "set": st.dictionaries(names, values) | values,
    },
)
messages = (st.dictionaries(names | strings, values, max_size=5) | sensible).map(
    lambda message: json.dumps(message).encode()
)
payloads = st.binary(max_size=100) | messages


@given(
    st.lists(st.tuples(st.sampled_from(wire.TYPES), st.booleans(), payloads), max_size=5),
    st.booleans(),
)
def test_any_frame_gets_sound_frames_and_nothing_is_raised(sent, greeted):
    rig = Rig(capacity=10)
    rig.loop.start()
    client = Client(rig.loop)
    if greeted:
        client.greet().tell("lease")
    for counter, (kind, seal, body) in enumerate(sent, 10):
        payload = wire.seal(client.talk._handshake.key, counter, body) if seal and greeted else body
        if len(payload) <= wire.MAX_PAYLOAD:
            assert whole(client.session.receive(kind, payload))
            client.flow()
    rig.run(2)


@pytest.mark.parametrize(
    "request_",
    ["%s", '"describe","table":%s', '"kick","kick":{"id":"1","mode":%s}', '"set","set":{"k":%s}'],
)
@pytest.mark.parametrize(("opening", "closing"), [("[", "]"), ('{"a":', "}")])
def test_no_depth_of_nesting_is_too_much(rig, client, request_, opening, closing):
    """Neither to read nor, which happens deeper in the stack, to show in a refusal."""
    before = rig.fingerprint()
    for depth in (*range(1, 600, 7), *range(600, 1000)):
        nested = opening * depth + "1" + closing * depth
        text = (f'{{"id":1,"do":{request_}}}' % nested).encode()
        if len(text) > wire.MAX_PAYLOAD - 24:
            break
        sealed = wire.seal(client.talk._handshake.key, depth + 10, text)
        assert "error" in reply(client.session.receive(wire.COMMAND, sealed))
        if client.session.closing:
            client.session = Client(rig.loop, client="tester").greet().session
            client.session._handshake = client.talk._handshake
    before.pop("lease")
    after = rig.fingerprint()
    after.pop("lease")
    assert after == before
