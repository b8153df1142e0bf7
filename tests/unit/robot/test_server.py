"""The robot's links on loopback, from the robot's side alone: this runs on the brick's Python too.

Time is virtual.
"""

import binascii
import os
import socket

import pytest

from robot import wire
from robot.record import STATES, STRUCT
from robot.server import Server
from robot.session import Session
from tests.rig import TOKEN, BusyClock, Rig, whole

HELLO_S = 0.025  # what a stranger's hello takes on the brick
TICK_S = 0.03
STOP = wire.encode(wire.STOP, b"")


class Desk(Rig):
    """A robot that runs, and takes HELLO_S of its virtual time for each frame."""

    def __init__(self, records_s=0.0):
        Rig.__init__(self)
        self.clock = self.loop.clock = BusyClock()
        self.server = Server(self.loop, TOKEN, records_s)
        self.address = ("127.0.0.1", self.server.listen("127.0.0.1", 0))
        self.links = []
        self.loop.start()

    def connect(self):
        link = socket.create_connection(self.address)
        link.setblocking(False)
        self.links.append(link)
        return link

    def run(self, ticks=1):
        for _ in range(ticks):
            self.clock.wait(self.loop.deadline, self.server.serve)
            self.loop.tick()

    def close(self):
        for link in self.links:
            link.close()
        self.server.close()


@pytest.fixture
def desk(monkeypatch):
    desk = Desk()
    real = Session.receive

    def costly(session, kind, payload):
        desk.clock.time += HELLO_S
        return real(session, kind, payload)

    monkeypatch.setattr(Session, "receive", costly)
    yield desk
    desk.close()


def hello():
    nonce = binascii.hexlify(os.urandom(wire.NONCE_BYTES)).decode("ascii")
    message = {"protocol": wire.PROTOCOL, "name": "anna", "client": nonce, "nonce": nonce}
    return wire.encode_json(wire.HELLO, message)


def test_eight_hellos_at_once_delay_no_tick_by_more_than_one_of_them(desk):
    """All eight in one pause would take 0.2 s, and the watchdog would stop the robot."""
    strangers = [desk.connect() for _ in range(8)]
    desk.run(10)
    first = desk.loop.blackbox.next_tick
    for stranger in strangers:
        stranger.send(hello())
    desk.run(40)
    records = desk.records_from(first)
    assert max(record.late_s for record in records) <= HELLO_S
    assert sum(record.missed for record in records) == 0
    for stranger in strangers:
        ((kind, _),) = whole(stranger.recv(4096))
        assert kind == wire.HELLO


def test_a_stop_is_obeyed_before_the_next_tick_among_eight_hellos(desk):
    strangers = [desk.connect() for _ in range(9)]
    desk.run(10)
    for stranger in strangers[:8]:
        stranger.send(hello())
    strangers[8].send(STOP)
    desk.run()
    assert STATES[desk.last.state] == "stopped"
    assert desk.duties == (0, 0)


def test_who_sends_no_frame_is_told_so_and_hung_up_on(desk):
    noisy = desk.connect()
    noisy.send(b"GET / HTTP/1.1\r\n\r\n")
    desk.run(3)
    ((kind, payload),) = whole(noisy.recv(4096))
    assert (kind, wire.load(payload)["error"]["code"]) == (wire.REPLY, "broken")
    assert noisy.recv(1) == b""


def test_a_serve_without_a_word_from_anybody_leaves_all_links_open(desk):
    links = [desk.connect() for _ in range(3)]
    desk.run(20)
    for link in links:
        with pytest.raises(BlockingIOError):
            link.recv(1)


def frames(link):
    """Whole frames that have arrived; records as how many they are."""
    try:
        data = link.recv(1 << 16)
    except BlockingIOError:
        return []
    return [
        len(wire.open_samples(payload)[1]) // STRUCT.size
        if kind == wire.SAMPLES
        else wire.load(payload)
        for kind, payload in whole(data)
    ]


def test_records_wait_for_each_other_and_events_do_not():
    desk = Desk(records_s=0.1)
    try:
        reader = desk.connect()
        reader.send(hello() + wire.encode_json(wire.ASK, {"id": 1, "do": "subscribe"}))
        desk.run(10)
        frames(reader)
        got = []
        for _ in range(40):
            desk.run()
            got += frames(reader)
        assert sum(got) >= 36
        assert max(got) <= 4
        assert len(got) <= 10
        desk.loop.fail("the test")
        desk.run()
        events = [item["reason"] for item in frames(reader) if isinstance(item, dict)]
        assert events == ["the test"]
    finally:
        desk.close()
