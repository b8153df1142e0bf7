"""A stop that has reached the robot is obeyed although its connection ends before its turn."""

import socket
import struct

import pytest

from robot import wire
from robot.peer import FULL_BYTES, Peer
from robot.record import STATES
from robot.server import DEAF_S, GREETING_S, HEARING_S, PLACES
from tests.link.desk import STOP, Desk
from tests.rig import BusyClock

STATUS = wire.encode_json(wire.ASK, {"id": 1, "do": "status"})
IDENTIFY = wire.encode_json(wire.ASK, {"id": 1, "do": "identify"})
NAMED = wire.encode_json(wire.STOP, {"name": "ann"})
DAMAGED = STOP[:-1] + bytes([STOP[-1] ^ 1])
# A stop by its beginning, which would go on for longer than what follows.
TOO_LONG = wire.SYNC + bytes([wire.STOP]) + b"\x10\x00"


def state(desk):
    """The robot's state, in words."""
    return STATES[desk.loop.safety.state]


def heard(desk, data):
    """A host whose bytes the robot has read, without a turn for it. No time passes in between."""
    host = desk.connect(token=None, paired=True).greet()
    host.send(data)
    desk.server._hear(desk.clock.now())
    assert state(desk) == "running"
    return host


def gone(desk, host):
    """End a host's connection, and have the robot notice when it reads."""
    host.socket.close()
    for _ in range(FULL_BYTES // 2048 + 1):
        desk.server._hear(desk.clock.now())
    assert desk.server._peers == []


@pytest.mark.parametrize("stop", [STOP, NAMED], ids=["bare", "named"])
@pytest.mark.parametrize("others", [1, 100, 200])
def test_a_stop_behind_what_nobody_has_answered(desk, others, stop):
    gone(desk, heard(desk, STATUS * others + stop))
    assert state(desk) == "stopped"
    assert desk.duties == (0, 0)
    assert desk.loop.safety.reason == "'peer' stopped it"


def test_a_stop_that_comes_after_what_nobody_has_answered(desk):
    host = heard(desk, STATUS)
    host.send(STOP)
    gone(desk, host)
    assert state(desk) == "stopped"


def test_a_stop_of_who_resets_the_connection(desk):
    host = desk.connect(token=None).greet()
    (peer,) = desk.server._peers
    host.send(STATUS + STOP)
    while peer.frame is None:
        desk.server._hear(desk.clock.now())
    assert state(desk) == "running"
    host.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    host.socket.close()
    while desk.server._peers:
        desk.server._hear(desk.clock.now())
    assert state(desk) == "stopped"


@pytest.mark.parametrize("together", [True, False])
def test_a_stop_of_who_is_gone_when_the_answer_is_sent(desk, together):
    host = heard(desk, STATUS + STOP if together else STATUS)
    if not together:
        host.send(STOP)
    host.socket.close()
    desk.server._take_turn(desk.server._turns.next(1.0), 0.0)
    assert desk.server._peers == []
    assert state(desk) == "stopped"


@pytest.mark.parametrize(
    "data",
    [STATUS, STATUS + STOP[:-1], STATUS + DAMAGED, STATUS + TOO_LONG, TOO_LONG, IDENTIFY * 2],
    ids=["no stop", "half a stop", "damaged", "cut short", "never whole", "others"],
)
def test_nothing_but_a_whole_stop_counts(desk, data):
    before = desk.loop.blackbox.next_event
    gone(desk, heard(desk, data))
    assert state(desk) == "running"
    assert desk.loop.blackbox.next_event == before


@pytest.mark.parametrize(
    "noise", [DAMAGED, TOO_LONG, wire.SYNC], ids=["damaged", "too long", "half a header"]
)
def test_a_stop_behind_noise_on_a_line_that_breaks(desk, noise):
    host = heard(desk, STATUS)
    desk.server._peers[0].lasting = True
    host.send(noise + STOP)
    gone(desk, host)
    assert state(desk) == "stopped"


def test_a_flood_of_false_stops_costs_few_checksums(desk, monkeypatch):
    host = heard(desk, STATUS + TOO_LONG * 300)
    encoded = []
    real = wire.encode
    monkeypatch.setattr(wire, "encode", lambda *what: encoded.append(what) or real(*what))
    gone(desk, host)
    assert len(encoded) <= 4


def test_a_stop_behind_a_message_that_is_refused(desk):
    host = heard(desk, wire.encode(wire.ASK, b"[1]") + STOP)
    desk.run()
    assert host.hung_up
    assert state(desk) == "stopped"


def test_a_stop_behind_the_hello_of_who_finds_no_place(desk):
    for number in range(PLACES):
        desk.connect(token=None, name=f"watcher {number}", paired=True).greet()
    late = desk.connect(token=None, paired=True)
    late.send(late.talk.hello_frame() + STOP)
    desk.run()
    assert late.hung_up
    assert state(desk) == "stopped"


@pytest.mark.parametrize("hello", [True, False])
def test_a_stop_of_who_gives_way_to_a_newcomer(desk, hello):
    desk.loop.stop("the test")
    stranger = desk.connect(token=None, paired=True)
    stranger.send((stranger.talk.hello_frame() if hello else b"") + STOP)
    desk.server._hear(desk.clock.now())
    desk.loop.start()
    desk.server._turn_out(desk.server._peers[0])
    assert state(desk) == "stopped"


def test_a_stop_of_who_reads_nothing_for_too_long(desk):
    host = desk.connect(token=None, paired=True).greet()
    host.send(wire.encode_json(wire.ASK, {"id": 1, "do": "subscribe", "from": 0}))
    (peer,) = desk.server._peers
    while len(peer.out) < FULL_BYTES:
        host.send(wire.encode_json(wire.ASK, {"id": 1, "do": "describe", "table": "channels"}))
        desk.run()
    host.send(STATUS + STOP)
    desk.run(int(DEAF_S / 0.03) + 50)
    assert desk.server._peers == []
    assert state(desk) == "stopped"


def test_hanging_up_on_many_at_once_delays_a_tick_for_a_bounded_time(monkeypatch):
    """Each may have left a lot among which a stop is looked for."""
    desk = Desk(BusyClock(), capacity=2000)
    real = Peer.close

    def costly(peer):
        desk.clock.time += 0.004
        real(peer)

    monkeypatch.setattr(Peer, "close", costly)
    desk.loop.start()
    for _ in range(40):
        desk.connect(paired=True)
    desk.run(int((GREETING_S + 2.0) / 0.03))
    assert desk.server._peers == []
    # This clock serves once more when the next tick is due.
    late_s = max(record.late_s for record in desk.records_from(0))
    assert late_s <= 2 * (HEARING_S + 0.004)
    desk.close()
