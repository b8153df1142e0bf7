"""The robot's links under load: ticks go on, memory is bounded, and a stop is heard."""

import os
import socket
import struct
import time

import pytest

from robot import server as server_module
from robot import wire
from robot.record import STATES
from robot.server import FULL_BYTES, MAX_PEERS, STREAM_BYTES
from tests.link.desk import FRAME, STOP, Desk, open_files
from tests.rig import Clock


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
        assert len(desk.server._peers) <= MAX_PEERS
        if number % 10 == 0:
            desk.run()
            controller.send(controller.talk.request("heartbeat", {}, sealed=True)[1])
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
        assert len(desk.server._peers) <= MAX_PEERS
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


def test_a_peer_that_never_reads_delays_nobody_and_costs_bounded_memory(desk):
    deaf = desk.connect(receive_buffer=65536).greet()
    deaf.send(deaf.talk.request("subscribe", {"from": 0}, sealed=False)[1])
    reader = desk.connect(name="reader").greet()
    reader.ask("subscribe", **{"from": 0})
    largest = 0
    for _ in range(20000):
        desk.run()
        reader.read()
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
    flooders = [desk.connect(name=f"flooder {number}").greet() for number in range(MAX_PEERS - 1)]
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
    for number in range(MAX_PEERS - 1):
        desk.connect(name=f"trusted {number}").greet()
    strangers = [desk.connect() for _ in range(4)]
    strangers[0].send(STOP)
    desk.run(1)
    assert STATES[desk.last.state] == "stopped"


class BusyClock(Clock):
    """Time passes with the work that is done, and by itself where there is none."""

    def wait(self, deadline, serve):
        while self.time < deadline:
            before = self.time
            serve(deadline - before)
            if self.time == before:
                self.time = deadline
        serve(0.0)


def test_the_work_that_a_tick_can_be_late_by_is_one_frame_of_each_peer(monkeypatch):
    """Every frame costs 1 ms here, and there is always another.

    A tick is at most one round of all peers late.
    """
    clock = BusyClock()
    desk = Desk(clock, capacity=2000)
    try:
        flooders = [desk.connect(name=f"flooder {number}").greet() for number in range(MAX_PEERS)]
        real = server_module.Session.receive

        def costly(session, kind, payload):
            clock.time += 0.001
            return real(session, kind, payload)

        monkeypatch.setattr(server_module.Session, "receive", costly)
        frame = wire.encode_json(wire.ASK, {"id": 1, "do": "unsubscribe"})
        first = desk.loop.blackbox.next_tick
        for _ in range(60):
            for flooder in flooders:
                flooder.send(frame * 100)
                flooder.read()
            desk.run()
        late = [record.late_s for record in desk.records_from(first)]
        assert desk.loop.missed == 0
        assert max(late) <= 0.001 * 2 * MAX_PEERS + 1e-6
        assert sum(value > 0.0005 for value in late) > 30, "nobody was busy"
    finally:
        desk.close()
