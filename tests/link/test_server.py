"""The robot's links over real sockets, in virtual time.

Peers that say nothing, send rubbish, read nothing or are too many change nothing for the others.
"""

import socket
import time

import pytest

from robot import wire
from robot.record import STATES
from robot.server import DEAF_S, GREETING_S, PLACES, RETRY_S, SPARE_PLACES, STRANGERS
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


def fill(desk):
    """Have hosts without a token take all places."""
    return [desk.connect(token=None, name=f"watcher {number}").greet() for number in range(PLACES)]


def busy(peer, desk):
    """Assert that a peer was turned away, and learned for how long."""
    desk.run()
    error = refusal(peer)["error"]
    assert (error["code"], error["retry_s"]) == ("busy", RETRY_S)
    assert f"try again in {RETRY_S} s" in error["hint"]


def test_when_all_places_are_taken_a_newcomer_is_refused_and_nobody_gives_way(desk):
    watchers = fill(desk)
    for _ in range(3):
        late = desk.connect(token=None)
        late.send(late.talk.hello_frame())
        busy(late, desk)
    assert all(peer.read() for peer in watchers)
    watchers[0].socket.close()
    desk.run()
    assert desk.connect(token=None).greet().ask("status")["state"] == "running"


def test_who_proves_the_token_gets_in_when_watchers_have_taken_all_places(desk):
    fill(desk)
    drivers = [desk.connect(name=f"driver {number}").greet() for number in range(SPARE_PLACES)]
    drivers[0].ask("lease", sealed=True)
    assert drivers[-1].ask("status")["controller"] == "driver 0"
    late = desk.connect()
    late.send(late.talk.hello_frame())
    desk.run()
    late.read()
    late.send(late.talk.auth_frame())
    busy(late, desk)


@pytest.mark.parametrize("command", [True, False])
def test_who_only_says_that_it_has_the_token_gets_no_place(desk, command):
    fill(desk)
    liar = desk.connect()
    liar.send(liar.talk.hello_frame())
    desk.run()
    liar.read()
    assert liar.talk.hello
    if command:
        liar.send(liar.talk.request("status", {}, sealed=False)[1])
        busy(liar, desk)
    else:
        desk.run(int((GREETING_S + 1.0) / 0.03))
        assert liar.hung_up


def test_a_stop_needs_no_place(desk):
    fill(desk)
    stranger = desk.connect()
    stranger.send(STOP)
    desk.run()
    assert STATES[desk.last.state] == "stopped"
    stranger.read()
    assert stranger.talk.stopped.state == "stopped"


def test_of_too_many_strangers_the_one_that_came_first_gives_way(desk):
    watcher = desk.connect(token=None).greet()
    strangers = [desk.connect() for _ in range(STRANGERS)]
    desk.run()
    assert all(peer.read() for peer in strangers)
    strangers.append(desk.connect())
    busy(strangers[0], desk)
    assert all(peer.read() for peer in strangers[1:])
    assert watcher.ask("status")["missed"] == 0


def test_who_reads_nothing_for_a_minute_is_hung_up_on(desk):
    """Else a lost computer would keep its place until the kernel gives up, which takes hours."""
    deaf, slow = (desk.connect(name=name, paired=True).greet() for name in ("deaf", "slow"))
    for peer in (deaf, slow):
        peer.ask("subscribe", **{"from": 0})
    while not desk.server._peers[0].out:
        desk.run()
    ticks = 0
    while len(desk.server._peers) > 1 and ticks < 2 * DEAF_S / 0.03:
        ticks += 1
        desk.run()
        slow.read()
    assert ticks * 0.03 > DEAF_S - 1.0
    assert [peer.session.name for peer in desk.server._peers] == ["slow"]
    assert slow.ask("status")["missed"] == 0


def test_closing_hangs_up_on_everybody(desk):
    peers = [desk.connect().greet() for _ in range(3)]
    files = open_files()
    desk.server.close()
    assert open_files() == files - 5  # with the listener, and what the robot waits by
    assert all(not peer.read() for peer in peers)
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(desk.address)
