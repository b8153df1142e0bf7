"""The robot's links over real sockets, in virtual time.

Peers that say nothing, send rubbish, or are too many change nothing for the others.
"""

import socket
import time

import pytest

from robot import wire
from robot.server import GREETING_S, MAX_PEERS
from tests.link.desk import STOP, open_files


def refusal(peer):
    """The reply that ended a connection."""
    data = b""
    peer.socket.settimeout(2.0)
    while piece := peer.socket.recv(4096):
        data += piece
    decoder = wire.Decoder()
    decoder.feed(data)
    kind, payload = decoder.next()
    assert (kind, decoder.next()) == (wire.REPLY, None)
    return wire.load(payload)


def test_who_says_no_hello_is_hung_up_on(desk):
    silent, half, slow, greeted = (desk.connect() for _ in range(4))
    greeted.greet()
    half.send(STOP[:4])
    hello = slow.talk.hello_frame()
    for number in range(int((GREETING_S + 1.0) / 0.03)):
        slow.send(hello[number : number + 1] if number < len(hello) - 1 else b"")
        desk.run()
    assert silent.hung_up
    assert half.hung_up
    assert slow.hung_up
    assert greeted.ask("status")["state"] == "running"
    assert len(desk.server._peers) == 1


@pytest.mark.parametrize(
    "garbage",
    [
        b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n",
        b"\x16\x03\x01\x02\x00" + bytes(100),
        b"\x00",
        STOP[:-1] + b"\xff" + STOP,
        b"x" + STOP,
        wire.encode(wire.ASK, b"[1]"),
        wire.encode(wire.SAMPLES, b""),
        wire.encode(wire.HELLO, b"\xff\xfe"),
        wire.encode(wire.COMMAND, bytes(24)),
    ],
)
def test_garbage_gets_a_refusal_and_is_hung_up_on(desk, garbage):
    before = desk.fingerprint()
    peer = desk.connect()
    peer.send(garbage)
    for _ in range(20):
        desk.server.serve(0.0)
        time.sleep(0.0005)
    message = refusal(peer)
    assert message["id"] is None
    assert message["error"]["code"] in ("broken", "version")
    assert desk.fingerprint() == before
    assert desk.server._peers == []


def test_who_gives_way_when_all_places_are_taken(desk):
    """Strangers first, the longest there before others; then those with the token.

    The one that controls last.
    """
    holder = desk.connect(name="holder").greet()
    holder.ask("lease", sealed=True)
    trusted = [desk.connect(name=f"trusted {number}").greet() for number in range(3)]
    strangers = [
        desk.connect(token=None, name=f"stranger {number}").greet()
        for number in range(MAX_PEERS - 4)
    ]
    everybody = [*strangers, *trusted, holder]
    assert len(desk.server._peers) == MAX_PEERS
    gone = []
    for number in range(6):
        desk.connect(name=f"new {number}").greet()
        holder.send(holder.talk.request("heartbeat", {}, sealed=True)[1])
        gone += [peer for peer in everybody if peer not in gone and not peer.read()]
    assert [peer.talk._name for peer in gone] == [
        peer.talk._name for peer in [*strangers, *trusted][:6]
    ]
    assert holder.ask("status")["controller"] == "holder"


def test_closing_hangs_up_on_everybody(desk):
    peers = [desk.connect().greet() for _ in range(3)]
    files = open_files()
    desk.server.close()
    assert open_files() == files - 4
    assert all(not peer.read() for peer in peers)
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(desk.address)
