"""One peer's conversation: who may do what, and that whatever is refused has changed nothing."""

import json
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from host.errors import KickctlError, NotDone, RefusedByRobot
from robot import commands, wire
from robot.params import TABLE
from robot.session import Session
from tests.rig import TOKEN, Rig, whole
from tests.talk import Client

SEALED = [row.name for row in commands.TABLE.values() if row.sealed]
OPEN = [row.name for row in commands.TABLE.values() if not row.sealed]


@pytest.fixture
def rig():
    rig = Rig(capacity=100)
    rig.loop.start()
    rig.run(3)
    return rig


@pytest.fixture
def client(rig):
    client = Client(rig.loop).greet()
    client.tell("lease")
    return client


def reply(frames):
    """The one message in the frames of an answer."""
    ((kind, payload),) = whole(frames)
    assert kind == wire.REPLY
    return wire.load(payload)


def refused(code, call, *args, **kwargs):
    """Assert that the robot refuses for a reason of this kind. Returns the error."""
    kinds = {"token": RefusedByRobot, "lease": RefusedByRobot, "busy": NotDone, "any": KickctlError}
    with pytest.raises(kinds[code], match=r"the robot refuses: .{5}") as error:
        call(*args, **kwargs)
    return error.value


# Who may do what


def test_an_observer_may_look_and_stop_and_nothing_else(rig):
    observer = Client(rig.loop, token=None).greet()
    before = rig.fingerprint()
    for name in OPEN:
        observer.ask(name, **({"table": "params"} if name == "describe" else {}))
    for name in SEALED:
        refused("token", observer.ask, name)
    assert rig.fingerprint() == before
    assert not observer.session.closing
    assert observer.stop() == {"tick": 3}
    rig.run(1)
    assert (rig.last.state, rig.duties) == (3, (0, 0))


def test_a_stop_frame_needs_no_hello_no_token_and_no_sense(rig):
    session = Session(rig.loop, TOKEN, "boot")
    assert reply(session.receive(wire.STOP, b"\xff{NaN")) == {"id": None, "result": {"tick": 3}}
    assert rig.duties == (0, 0)
    assert "a peer without a name" in rig.loop.safety.reason
    assert not session.closing


@pytest.mark.parametrize("kind", [wire.ASK, wire.AUTH, wire.COMMAND])
def test_before_the_hello_nothing_is_understood(rig, kind):
    session = Session(rig.loop, TOKEN, "boot")
    before = rig.fingerprint()
    assert reply(session.receive(kind, b'{"id":1,"do":"status"}'))["error"]["code"] == "broken"
    assert session.closing
    assert rig.fingerprint() == before


def test_the_token_alone_does_not_control(rig):
    client = Client(rig.loop).greet()
    before = rig.fingerprint()
    for name, arguments in (
        ("start", {}),
        ("stop", {}),
        ("clear", {}),
        ("kick", {"kick": {"id": "1", "mode": "membrane"}}),
        ("set", {"set": {"k": 1.0}}),
    ):
        refused("lease", client.tell, name, **arguments)
    assert rig.fingerprint() == before


def test_a_second_controller_is_refused_until_the_first_lets_go(rig, client):
    second = Client(rig.loop, name="second").greet()
    before = rig.fingerprint()
    assert "tester" in refused("lease", second.tell, "lease").message
    refused("lease", second.tell, "stop")
    second.tell("release")
    second.tell("heartbeat")
    assert rig.fingerprint() == before
    client.tell("release")
    second.tell("lease")
    refused("lease", client.tell, "stop")
    client.stop()
    assert rig.duties == (0, 0)


def test_others_words_do_not_keep_a_lease(rig, client):
    second = Client(rig.loop, name="second").greet()
    for _ in range(20):
        second.tell("heartbeat")
        client.ask("status")
        rig.run(1)
    assert client.ask("status")["controller"] is None
    assert rig.last.state == 3


def test_a_heartbeat_keeps_it(rig, client):
    for _ in range(20):
        rig.run(10)
        client.tell("heartbeat")
    assert client.ask("status")["controller"] == "tester"


# Version, token, seals


@pytest.mark.parametrize(
    "protocol", [[2, 0], [0, 9], ["1", 0], [1], [], None, "1.0", {}, [[1], 0], [1, 0, 0]]
)
def test_another_version_is_refused_with_both_named(rig, protocol):
    session = Session(rig.loop, TOKEN, "boot")
    before = rig.fingerprint()
    hello = {"protocol": protocol, "name": "n", "client": "c", "nonce": "00" * 16}
    error = reply(session.receive(wire.HELLO, wire.dump(hello)))["error"]
    assert error["code"] == "version"
    assert "1.0" in error["message"]
    assert session.closing
    assert not session.greeted
    assert rig.fingerprint() == before


@pytest.mark.parametrize(
    "change",
    [
        *(
            {"nonce": nonce}
            for nonce in ("", "00" * 15, "00" * 17, "zz" * 16, "é" * 32, None, 7, [])
        ),
        *({"client": client} for client in ("", "x" * 65, None, 7, [])),
        *({"name": name} for name in (None, 7, ["a"])),
    ],
)
def test_half_a_hello_is_none(rig, change):
    session = Session(rig.loop, TOKEN, "boot")
    hello = {"protocol": [1, 0], "name": "n", "client": "c", "nonce": "00" * 16, **change}
    assert reply(session.receive(wire.HELLO, wire.dump(hello)))["error"]["code"] == "broken"
    assert session.closing
    assert not session.greeted


def test_a_later_minor_version_is_welcome(rig):
    session = Session(rig.loop, TOKEN, "boot")
    hello = {"protocol": [1, 7], "name": "n", "client": "c", "nonce": "00" * 16, "colour": "blue"}
    ((kind, _),) = whole(session.receive(wire.HELLO, wire.dump(hello)))
    assert kind == wire.HELLO


def test_a_name_cannot_garble_a_screen(rig):
    client = Client(rig.loop, name="a\x1b[2J\n\u202e" + "b" * 100, client="c").greet()
    client.stop()
    assert rig.loop.safety.reason == "stop frame from '" + ("a[2J" + "b" * 33) + "'"


def test_a_wrong_token_ends_the_conversation(rig):
    before = rig.fingerprint()
    client = Client(rig.loop, token=b"x" * 32)
    client.give(client.talk.hello_frame())
    client.give(client.talk.auth_frame())
    with pytest.raises(RefusedByRobot, match="token"):
        client.talk.raise_refusal()
    assert client.session.closing
    assert not client.session.trusted
    assert rig.fingerprint() == before


@pytest.mark.parametrize("proof", [None, 7, "", "zz", "é", "00" * 32, []])
def test_what_is_no_proof_proves_nothing(rig, proof):
    client = Client(rig.loop)
    client.give(client.talk.hello_frame())
    assert (
        reply(client.session.receive(wire.AUTH, wire.dump({"proof": proof})))["error"]["code"]
        == "token"
    )
    assert not client.session.trusted


def test_a_proof_cannot_be_used_again(rig):
    client = Client(rig.loop)
    client.give(client.talk.hello_frame())
    proof = client.talk.auth_frame()
    client.give(proof)
    assert client.session.trusted
    client.give(client.talk.hello_frame())
    assert not client.session.trusted
    client.give(proof)
    assert not client.session.trusted
    assert client.session.closing


def test_a_robot_without_the_token_is_found_out(rig):
    client = Client(rig.loop)
    client.session._token = b"x" * 32
    client.give(client.talk.hello_frame())
    client.talk.auth_frame()
    with pytest.raises(RefusedByRobot):
        list(client.talk.feed(wire.encode_json(wire.AUTH, {"proof": "00" * 32})))
    assert not client.talk.trusted


def sealed_frames(client, do, **arguments):
    _, frame = client.talk.request(do, arguments, sealed=True)
    return frame


@pytest.mark.parametrize("how", ["again", "older", "flipped", "short", "other session"])
def test_a_command_that_is_not_freshly_sealed_ends_the_conversation(rig, client, how):
    older = sealed_frames(client, "start")
    frame = sealed_frames(client, "heartbeat")
    other = Client(rig.loop, client="tester").greet()
    client.give(frame)
    before = rig.fingerprint()
    ((_, payload),) = whole(frame)
    payload = {
        "again": payload,
        "older": whole(older)[0][1],
        "flipped": payload[:-2] + bytes([payload[-2] ^ 1]) + payload[-1:],
        "short": payload[:10],
        "other session": whole(sealed_frames(other, "stop"))[0][1],
    }[how]
    assert reply(client.session.receive(wire.COMMAND, payload))["error"]["code"] == "broken"
    assert client.session.closing
    assert rig.fingerprint() == before


# Wrong requests


@pytest.mark.parametrize(
    ("do", "arguments"),
    [
        *(
            ("set", {"set": {name: value}})
            for name in TABLE
            for value in (None, "x", True, [], 1e9, -1e9)
        ),
        ("set", {}),
        ("set", {"set": {}}),
        ("set", {"set": {"k": 1.0, "speed": 1.0}}),
        ("set", {"set": {"polarity_left": -1}}),
        ("start", {}),
        ("clear", {}),
        ("stop", {"now": True}),
        ("kick", {}),
        ("kick", {"kick": []}),
        *(
            ("kick", {"kick": {"id": "1", "mode": "phase", "ticks": ticks}})
            for ticks in (0, -1, 1.5, None, 10**9)
        ),
        ("kick", {"kick": {"id": "1", "mode": "shove"}}),
        ("kick", {"kick": {"mode": "phase"}}),
        ("jump", {}),
        (None, {}),
        (["status"], {}),
        ({}, {}),
        ("describe", {"table": []}),
        ("describe", {"table": "secrets"}),
        ("describe", {}),
        *(("subscribe", {"from": tick}) for tick in (-1, 4, 1.0, True, "0", [], 10**30)),
    ],
)
def test_what_makes_no_sense_is_refused_and_changes_nothing(rig, client, do, arguments):
    client.tell("heartbeat")
    before = rig.fingerprint()
    refused("any", client.tell, do, **arguments)
    assert rig.fingerprint() == before
    assert not client.session.closing
    assert client.ask("status")["controller"] == "tester"


@pytest.mark.parametrize("number", [nan, inf, -inf])
@pytest.mark.parametrize("do", ["set", "kick"])
def test_numbers_that_are_none_never_arrive(rig, client, do, number):
    """Neither as JSON that says NaN, nor as JSON that overflows."""
    arguments = (
        {"set": {"k": number}} if do == "set" else {"id": "1", "mode": "phase", "shift": number}
    )
    before = rig.fingerprint()
    for text in (
        json.dumps({"id": 9, "do": do, do: arguments}),
        f'{{"id":9,"do":"{do}","{do}":{{"id":"1","mode":"phase","shift":-1e999,"k":1e999}}}}',
    ):
        fresh = Client(rig.loop, client="tester").greet()
        sealed = wire.seal(fresh.talk._handshake.key, 1, text.encode())
        error = reply(fresh.session.receive(wire.COMMAND, sealed))["error"]
        assert error["code"] in ("broken", "range", "unknown", "usage")
        assert rig.fingerprint() == before


def test_a_kick_while_one_acts_is_refused(rig, client):
    client.tell("kick", kick={"id": "1", "mode": "position"})
    before = rig.fingerprint()
    refused("busy", client.tell, "kick", kick={"id": "2", "mode": "position"})
    assert client.tell("kick", kick={"id": "1", "mode": "position"}) == {"tick": 3}
    assert rig.fingerprint() == before


@pytest.mark.parametrize(
    "identity", [None, "1", 1.0, True, [], pytest.param(10**3900, id="huge"), -1, 2**70]
)
def test_a_request_without_a_number_is_not_carried_out(rig, client, identity):
    """Its answer could not be told from others."""
    client.tell("heartbeat")
    before = rig.fingerprint()
    body = wire.dump({"id": identity, "do": "set", "set": {"k": 1.0}})
    sealed = wire.seal(client.talk._handshake.key, 99, body)
    answer = reply(client.session.receive(wire.COMMAND, sealed))
    assert answer["error"]["code"] == "broken"
    assert answer["id"] is None
    assert rig.fingerprint() == before


def test_the_tables_fit_into_a_frame_and_name_everything(rig, client):
    tables = {
        name: client.ask("describe", table=name)["table"]
        for name in ("params", "channels", "commands")
    }
    assert (
        [row["name"] for row in tables["params"]]
        == list(client.ask("status")["params"])
        == list(TABLE)
    )
    assert {row["name"] for row in tables["commands"] if not row["sealed"]} == set(OPEN)


def test_a_status_with_the_longest_names_fits_into_a_frame(rig):
    longest = Client(rig.loop, name="\U0001f9be" * 40, client="\U0001f9be" * 64).greet()
    longest.tell("lease")
    longest.tell("stop")
    assert longest.ask("status")["controller"] == "\U0001f9be" * 40


@pytest.mark.parametrize(
    "text",
    ["\U0001f9be" * 300, "\x7f" * 4000, "\u20ac" * 600, "\ud800" * 600, "'\\" * 900],
    ids=ascii,
)
@pytest.mark.parametrize(
    "request_",
    [
        {"do": "{}"},
        {"do": "status", "{}": 1},
        {"do": "describe", "table": "{}"},
        {"do": "subscribe", "from": "{}"},
    ],
)
def test_a_refusal_of_something_long_fits_into_a_frame(rig, client, text, request_):
    message = {
        name.replace("{}", text): value.replace("{}", text) if isinstance(value, str) else value
        for name, value in request_.items()
    }
    error = reply(client.session.receive(wire.ASK, json.dumps(dict(message, id=1)).encode()))[
        "error"
    ]
    assert len(error["message"]) <= 200


# Anything at all

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
