"""The robot's links under load: ticks go on, memory is bounded, and a stop is heard."""

import os
import socket
import struct
import time
from contextlib import suppress

import pytest

from host.errors import NoLink
from robot import blackbox, wire
from robot.peer import FULL_BYTES, STREAM_BYTES, Peer
from robot.record import STATES
from robot.server import DEAF_S, HEARING_S, PLACES, SPARE_PLACES, STRANGERS, STREAMS_PER_TICK
from robot.session import Session
from tests.link.desk import FRAME, STOP, Desk, open_files
from tests.rig import BusyClock

MOST = PLACES + SPARE_PLACES + STRANGERS


def test_ten_thousand_connections_in_a_row(desk):
    """Some hang up politely, some not, some send half a frame, some rubbish, some stay."""
    controller = desk.connect().greet()
    controller.ask("lease", sealed=True)
    files = open_files()
    ends = (b"", STOP[:5], b"GET / HTTP/1.1\r\n\r\n", wire.encode(wire.ASK, b"{}"))
    staying = []
    for number in range(10000):
        link = socket.create_connection(desk.address)
        if number % 5:
            link.send(ends[number % 4])
        if number % 3 == 0:
            link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        if number % 97:
            link.close()
        else:
            staying.append(link)
        desk.server.serve(0.0)
        assert len(desk.server._peers) <= MOST
        if number % 10 == 0:
            desk.run()
            controller.send(controller.talk.beat())
            controller.read()
    for link in staying:
        link.close()
    desk.run(3)
    assert controller.ask("status")["controller"] == "peer"
    assert open_files() <= files
    assert desk.last.state == STATES.index("running")
    assert desk.loop.missed == 0


def test_a_hundred_connect_at_once_and_the_last_is_served(desk):
    peers = []
    for _ in range(100):
        link = socket.socket()
        link.setblocking(False)
        link.connect_ex(desk.address)
        peers.append(link)
    late = None
    for _ in range(400):
        desk.run()
        assert len(desk.server._peers) <= MOST
        if late is None and desk.loop.blackbox.next_tick > 200:
            late = desk.connect().greet()
    assert late.ask("status")["missed"] == 0
    for link in peers:
        link.close()


def test_a_stream_of_garbage_is_cut_off(desk):
    peer = desk.connect()
    sent = 0
    for _ in range(200):
        try:
            sent += peer.send(os.urandom(50000))
        except ConnectionError:
            break
        desk.run()
        assert all(len(link.decoder._buffer) <= 2 * FRAME for link in desk.server._peers)
    else:
        pytest.fail("never cut off")
    assert desk.server._peers == []


def test_a_peer_that_hardly_reads_delays_nobody_and_costs_bounded_memory(desk):
    deaf = desk.connect(receive_buffer=16384).greet()
    deaf.send(deaf.talk.request("subscribe", {"from": 0}, sealed=False)[1])
    reader = desk.connect(name="reader").greet()
    reader.ask("subscribe", **{"from": 0})
    largest = 0
    for tick in range(20000):
        desk.run()
        reader.read()
        if tick % int(0.8 * DEAF_S / 0.03) == 0:
            assert deaf.read()
        largest = max(largest, *(len(link.out) for link in desk.server._peers))
    assert largest <= STREAM_BYTES + FRAME
    ticks = [item.tick for item in reader.stream if not isinstance(item, dict)]
    assert ticks == list(range(len(ticks)))
    assert len(ticks) >= 20000
    assert desk.loop.missed == 0
    # When it reads at last, it hears what it still can, and what is lost.
    while not deaf.stream or getattr(deaf.stream[-1], "tick", 0) < 20000:
        desk.run()
        assert deaf.read()
        time.sleep(0.0002)
    missing, due = 0, 0
    for item in deaf.stream:
        if isinstance(item, dict):
            if item["event"] == "lost":
                assert item["from"] == due
                missing += item["tick"] - item["from"]
                due = item["tick"]
        else:
            assert item.tick == due
            due += 1
    assert missing > 10000


def test_a_peer_that_asks_and_never_reads_is_not_read_either(desk):
    deaf = desk.connect(receive_buffer=4096).greet()
    question = wire.encode_json(wire.ASK, {"id": 1, "do": "describe", "table": "channels"})
    sent, largest, idle = 0, 0, 0
    while idle < 50:
        taken = deaf.send(question * 50)
        sent += taken
        idle = 0 if taken else idle + 1
        desk.run()
        largest = max(
            largest, *(len(link.out) + len(link.decoder._buffer) for link in desk.server._peers)
        )
    assert FULL_BYTES < largest <= FULL_BYTES + 3 * FRAME
    assert desk.loop.missed == 0


def test_a_stop_is_heard_before_the_next_tick_while_everybody_floods(desk):
    flooders = [desk.connect(name=f"flooder {number}").greet() for number in range(PLACES - 1)]
    frame = wire.encode_json(wire.ASK, {"id": 1, "do": "status"})
    for flooder in flooders:
        flooder.send(frame * 2000)
    desk.run(2)
    stranger = desk.connect()
    stranger.send(STOP)
    for flooder in flooders:
        flooder.send(frame * 500)
    tick = desk.loop.blackbox.next_tick
    desk.run()
    assert STATES[desk.records_from(tick)[0].state] == "stopped"
    assert desk.duties == (0, 0)


def test_a_stop_among_simultaneous_strangers_is_heard(desk):
    """All other places are taken by hosts with the token, so strangers push each other out."""
    for number in range(PLACES - 1):
        desk.connect(name=f"trusted {number}").greet()
    strangers = [desk.connect() for _ in range(4)]
    strangers[0].send(STOP)
    desk.run(1)
    assert STATES[desk.last.state] == "stopped"


@pytest.fixture
def slow_desk(monkeypatch):
    """A robot that takes `frame_s` of its virtual time for each frame."""
    desk = Desk(BusyClock(), capacity=2000)
    desk.frame_s = 0.0
    real = Session.receive

    def costly(session, kind, payload):
        desk.clock.time += desk.frame_s
        return real(session, kind, payload)

    monkeypatch.setattr(Session, "receive", costly)
    desk.loop.start()
    yield desk
    desk.close()


@pytest.mark.parametrize(
    ("frame_s", "late_s"), [(0.001, 0.0), (0.01, 0.0), (0.025, 0.0), (0.045, 0.0155)]
)
def test_what_others_ask_for_makes_no_tick_late_if_it_fits_between_two(slow_desk, frame_s, late_s):
    """A stranger's hello takes 25 ms on the brick; here all say nothing but hello."""
    desk = slow_desk
    strangers = [desk.connect(token=None, name=f"stranger {number}") for number in range(20)]
    hello = strangers[0].talk.hello_frame()
    desk.frame_s = frame_s
    desk.run(5)
    first = desk.loop.blackbox.next_tick
    for _ in range(100):
        for stranger in strangers:
            stranger.send(hello * 50)
            with suppress(NoLink):
                stranger.read()
        desk.run()
    records = desk.records_from(first + 10)  # in the first ticks nobody knows how long it takes
    assert [record.missed for record in records if record.missed] == []
    assert max(record.late_s for record in records) <= late_s + 1e-6
    assert sum(peer.seated for peer in desk.server._peers) >= 10


@pytest.fixture
def slow_reader(monkeypatch):
    """A robot that takes 10 ms for each link that it reads."""
    desk = Desk(BusyClock(), capacity=2000)
    real = Peer.read

    def costly(peer, now):
        desk.clock.time += 0.01
        return real(peer, now)

    monkeypatch.setattr(Peer, "read", costly)
    desk.loop.start()
    yield desk
    desk.close()


def test_noise_of_many_at_once_delays_a_tick_for_a_bounded_time_and_all_are_heard(slow_reader):
    """Else they could silence the loop for longer than its watchdog bears."""
    desk = slow_reader
    links = [socket.create_connection(desk.address) for _ in range(40)]
    desk.run(50)
    first = desk.loop.blackbox.next_tick
    heard = set()
    frame = wire.encode(wire.ASK, bytes(1000))
    for place in range(60):  # byte by byte: there is always something to read, and nothing to do
        for link in links:
            link.send(frame[place : place + 1])
        desk.run()
        heard |= {peer.fd for peer in desk.server._peers if peer.heard > first * 0.03}
    # This clock serves once more when the next tick is due.
    late_s = max(record.late_s for record in desk.records_from(first))
    assert late_s <= 2 * HEARING_S + 0.01 + 1e-6
    assert len(heard) == len(links)
    for link in links:
        link.close()


def test_who_controls_has_a_turn_in_every_pause_and_all_others_have_theirs(slow_desk):
    """Although nothing fits in, heartbeats are heard, and nobody waits for ever."""
    desk = slow_desk
    driver = desk.connect(name="driver").greet()
    driver.ask("lease", sealed=True)
    watchers = [desk.connect(token=None, name=f"watcher {number}").greet() for number in range(9)]
    desk.frame_s = 0.045
    for watcher in watchers:
        watcher.send(watcher.talk.request("status", {}, sealed=False)[1] * 3)
    for _ in range(3 * 9 * 2):
        driver.send(driver.talk.request("heartbeat", {}, sealed=True)[1])
        desk.run()
        driver.read()
    assert desk.loop.lease.holder == "driver"
    assert max(desk.clock.time - peer.heard for peer in desk.server._peers) < 10.0
    for watcher in watchers:
        watcher.read()
        assert watcher.talk._answers


@pytest.mark.parametrize("behind_a_beat", [False, True])
def test_a_stop_is_obeyed_before_the_next_tick_although_no_time_is_left(slow_desk, behind_a_beat):
    desk = slow_desk
    watchers = [desk.connect(token=None, name=f"watcher {number}").greet() for number in range(9)]
    desk.frame_s = 0.045
    for watcher in watchers:
        watcher.send(watcher.talk.request("status", {}, sealed=False)[1] * 30)
    host = desk.connect()
    if behind_a_beat:
        host.greet()
    desk.run(3)
    host.send((host.talk.beat() if behind_a_beat else b"") + STOP)
    tick = desk.loop.blackbox.next_tick
    desk.run()
    assert STATES[desk.records_from(tick)[0].state] == "stopped"


def test_a_stop_of_who_waits_for_records_is_heard_although_it_has_just_beaten(slow_desk):
    desk = slow_desk
    watchers = [desk.connect(token=None, name=f"watcher {number}").greet() for number in range(9)]
    host = desk.connect().greet()
    host.ask("subscribe")
    (robots_end,) = (peer for peer in desk.server._peers if peer.session.trusted)
    desk.frame_s = 0.045
    for watcher in watchers:
        watcher.send(watcher.talk.request("status", {}, sealed=False)[1] * 30)
    while not robots_end.due:
        desk.run()
    host.send(host.talk.beat())
    desk.server._hear(desk.clock.now())
    assert robots_end.due
    host.send(STOP)
    desk.server._hear(desk.clock.now())
    assert STATES[desk.loop.safety.state] == "stopped"


def test_many_watchers_share_the_turns_and_get_every_record(desk):
    """Sixty-three watch and one drives, and the robot sends to nine of them in each tick."""
    driver = desk.connect(name="driver").greet()
    driver.ask("lease", sealed=True)
    watchers = [
        desk.connect(token=None, name=f"watcher {number}").greet() for number in range(PLACES - 1)
    ]
    for peer in (driver, *watchers):
        peer.ask("subscribe", **{"from": 0})
    for tick in range(200):
        sizes = [len(peer.stream) for peer in (driver, *watchers)]
        if tick % 3 == 0:
            driver.send(driver.talk.beat())
        desk.run()
        time.sleep(0.0005)
        assert all(peer.read() for peer in (driver, *watchers))
        got = [
            len(peer.stream) - size for peer, size in zip((driver, *watchers), sizes, strict=True)
        ]
        assert got[0] >= 1 or tick < 2
        assert sum(map(bool, got[1:])) <= STREAMS_PER_TICK or tick < 2
    assert desk.loop.missed == 0
    due = desk.loop.blackbox.next_tick
    for watcher in watchers:
        ticks = [item.tick for item in watcher.stream if not isinstance(item, dict)]
        assert ticks == list(range(ticks[-1] + 1))
        assert ticks[-1] >= due - 2 - PLACES // STREAMS_PER_TICK


def test_records_for_many_are_encoded_once(monkeypatch, desk):
    encoded = []
    real = blackbox.encode_samples
    monkeypatch.setattr(
        blackbox, "encode_samples", lambda *what: encoded.append(what) or real(*what)
    )
    watchers = [
        desk.connect(token=None, name=f"watcher {number}").greet()
        for number in range(STREAMS_PER_TICK)
    ]
    for watcher in watchers:
        watcher.ask("subscribe")
    desk.run(5)
    encoded.clear()
    desk.run(20)
    assert len(encoded) == 20
