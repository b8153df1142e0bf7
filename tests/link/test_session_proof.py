"""Versions, tokens and seals: who is let into a conversation, and what ends it."""

import pytest

from host.errors import RefusedByRobot
from robot import wire
from robot.session import Session
from tests.link.sessions import reply
from tests.rig import TOKEN, whole
from tests.talk import Client


@pytest.mark.parametrize(
    "protocol", [[2, 0], [0, 9], ["1", 0], [1], [], None, "1.0", {}, [[1], 0], [1, 0, 0]]
)
def test_another_version_is_refused_with_both_named(rig, protocol):
    session = Session(rig.loop, TOKEN, "boot")
    before = rig.fingerprint()
    hello = {"protocol": protocol, "name": "n", "client": "c", "nonce": "00" * 16}
    error = reply(session.receive(wire.HELLO, wire.dump(hello)))["error"]
    assert error["code"] == "version"
    assert "{}.{}".format(*wire.PROTOCOL) in error["message"]
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
    assert rig.loop.safety.reason == "'" + ("a[2J" + "b" * 33) + "' stopped it"


def test_a_name_cannot_seem_to_end_its_quotes(rig):
    Client(rig.loop, name="x' stopped it, not 'anna", client="c").greet().stop()
    assert rig.loop.safety.reason == "'x\u2019 stopped it, not \u2019anna' stopped it"


def test_a_wrong_token_ends_the_conversation(rig):
    before = rig.fingerprint()
    client = Client(rig.loop, token=b"x" * 32)
    client.give(client.talk.hello_frame())
    client.give(client.talk.auth_frame())
    with pytest.raises(RefusedByRobot, match="token"):
        client.talk.raise_refusal()
    assert not client.session.greeted
    assert not client.session.trusted
    assert rig.fingerprint() == before


def test_after_a_wrong_token_a_host_looks_on_over_the_same_link(rig):
    client = Client(rig.loop, token=b"x" * 32)
    client.give(client.talk.hello_frame())
    client.give(client.talk.auth_frame())
    client.talk.token = None
    client.talk.begin()
    assert client.greet().ask("status")["state"] == "running"
    assert not client.session.trusted


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
    assert not client.session.greeted


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


@pytest.mark.parametrize("kind", [wire.COMMAND, wire.BEAT])
@pytest.mark.parametrize("how", ["again", "older", "flipped", "short", "other session"])
def test_what_is_not_freshly_sealed_ends_the_conversation(rig, client, how, kind):
    older = sealed_frames(client, "start")
    frame = sealed_frames(client, "heartbeat") if kind == wire.COMMAND else client.talk.beat()
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
    assert reply(client.session.receive(kind, payload))["error"]["code"] == "broken"
    assert client.session.closing
    assert rig.fingerprint() == before


def test_a_beat_is_no_way_to_command(rig, client):
    before = rig.fingerprint()
    ((_, payload),) = whole(sealed_frames(client, "stop"))
    assert reply(client.session.receive(wire.BEAT, payload))["error"]["code"] == "broken"
    assert client.session.closing
    assert rig.fingerprint() == before


def test_a_beat_without_the_token_is_refused(rig):
    observer = Client(rig.loop, token=None).greet()
    assert reply(observer.session.receive(wire.BEAT, bytes(24)))["error"]["code"] == "token"
    assert observer.session.closing
