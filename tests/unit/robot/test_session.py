"""A conversation, from the robot's side alone: this runs on the brick's Python too."""

import binascii
import sys
import unicodedata

import pytest

from robot import wire
from robot.session import Session, _printable
from tests.rig import TOKEN, Rig, whole

# What a screen would obey: controls, lines, halves of pairs, and letters that change the direction.
OBEYED = ("Cc", "Cs", "Zl", "Zp")
TURNING = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
NONCE = bytes(range(wire.NONCE_BYTES))


@pytest.fixture
def session():
    return Session(Rig().loop, TOKEN, "boot")


def answer(session, kind, payload):
    """The one message with which the robot answers a frame."""
    ((_, payload),) = whole(session.receive(kind, payload))
    return wire.load(payload)


def hello(session, **changes):
    message = {"protocol": wire.PROTOCOL, "name": "anna", "client": "1", "token": True}
    message.update(nonce=binascii.hexlify(NONCE).decode("ascii"))
    message.update(changes)
    return answer(session, wire.HELLO, wire.dump(message))


def handshake(session):
    """What both ends compute, after the hello."""
    return wire.Handshake(TOKEN, NONCE, binascii.unhexlify(hello(session)["nonce"]))


def prove(session):
    """The key of the session, after the host's proof."""
    shake = handshake(session)
    proof = binascii.hexlify(shake.host_proof).decode("ascii")
    theirs = answer(session, wire.AUTH, wire.dump({"proof": proof}))["proof"]
    assert binascii.unhexlify(theirs) == shake.robot_proof
    return shake.key


def test_a_name_keeps_its_letters_and_loses_what_a_screen_would_obey():
    """Not by the letters that this Python knows: the brick's is of 2017, and hosts are newer."""
    obeyed = [
        letter
        for letter in map(chr, range(sys.maxunicode + 1))
        if unicodedata.category(letter) in OBEYED or unicodedata.bidirectional(letter) in TURNING
    ]
    assert [letter for letter in obeyed if _printable(letter)] == []
    for name in ("anna", "Zo\u00eb \u4e00", "\U0001f9be", "\U0001fae8", "\u0916"):
        assert _printable(name) == name
    assert _printable("o'hara\x1b[2J" + "x" * 99) == "o\u2019hara[2J" + "x" * 30


def test_a_host_with_the_token_commands_and_its_reply_has_the_number_of_its_request(session):
    key = prove(session)
    body = wire.dump({"id": 7, "do": "lease"})
    assert answer(session, wire.COMMAND, wire.seal(key, 1, body)) == {"id": 7, "result": {}}
    assert session.trusted


@pytest.mark.parametrize("spoil", ["counter", "mac", "short"])
def test_a_command_with_a_wrong_seal_ends_the_conversation(session, spoil):
    sealed = wire.seal(prove(session), 1, wire.dump({"id": 7, "do": "lease"}))
    if spoil == "counter":
        assert answer(session, wire.COMMAND, sealed)["id"] == 7
    elif spoil == "mac":
        sealed = sealed[:10] + b"\0" + sealed[11:]
    else:
        sealed = sealed[:20]
    refusal = answer(session, wire.COMMAND, sealed)
    assert (refusal["id"], refusal["error"]["code"]) == (None, "broken")
    assert session.closing
    assert not session.trusted


def test_a_host_with_another_token_may_say_hello_again(session):
    handshake(session)
    refusal = answer(session, wire.AUTH, wire.dump({"proof": "00" * 32}))
    assert refusal["error"]["code"] == "token"
    assert not session.closing
    assert "nonce" in hello(session, token=False)


@pytest.mark.parametrize(
    ("kind", "payload", "code"),
    [
        (wire.ASK, b'{"id": 1, "do": "status"}', "broken"),  # there was no hello
        (wire.HELLO, b'{"protocol": [9, 0]}', "version"),
        (wire.HELLO, b"\xff", "broken"),
        (wire.HELLO, b"[" * 4000, "broken"),
        (wire.AUTH, b"{}", "broken"),
        (wire.SAMPLES, b"", "broken"),
    ],
)
def test_what_is_no_conversation_is_refused_in_words(session, kind, payload, code):
    error = answer(session, kind, payload)["error"]
    assert error["code"] == code
    assert error["message"]
    assert error["hint"]


def test_a_stop_needs_no_hello_and_names_who_sent_it(session):
    session._loop.start()
    name = wire.dump({"name": "Zo\u00eb \U0001f9be"})
    result = answer(session, wire.STOP, name)["result"]
    assert result["state"] == "stopped"
    assert result["reason"] == "'Zo\u00eb \U0001f9be' stopped it"


def test_events_stand_before_the_records_that_they_concern(session):
    loop = session._loop
    loop.start()
    loop.tick()
    hello(session)
    session.subscribe(0)
    kinds = []
    while True:
        frames = session.stream()
        if frames is None:
            break
        kinds += [
            (
                kind,
                wire.load(body).get("event")
                if kind == wire.EVENT
                else len(wire.open_samples(body)[1]),
            )
            for kind, body in whole(frames)
        ]
    assert [kind for kind, _ in kinds] == [wire.EVENT, wire.EVENT, wire.SAMPLES]
    assert [what for _, what in kinds[:2]] == ["snapshot", "start"]
