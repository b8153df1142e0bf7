"""A class at one robot: 25 watch and one drives for a minute of virtual time, at a brick's cost."""

from collections import Counter
from contextlib import suppress
from types import SimpleNamespace
from uuid import uuid4

import pytest

from host.client.robot import Robot
from host.link.transport import LinkLost
from host.logs.log import Log
from robot import server, wire
from robot.record import STATES
from robot.session import Session
from tests.link.machines import RigLink
from tests.rig import BusyClock

WATCHERS = 25
MINUTE_TICKS = 2000
# Hosts look after their links 20 times a second, every second tick; `watch` asks for the status
# once a second; the driver kicks twice a second.
LOOK_TICKS, ASK_TICKS, KICK_TICKS = 2, 33, 17
# What the brick takes for a hello or a proof, another frame, and a frame of records (s).
GREETING_S, FRAME_S, STREAM_S = 0.025, 0.0015, 0.0003


class Classroom:
    """A robot, who drives it, and who watches it; `heard` counts the frames that they send."""

    def __init__(self):
        self.heard = Counter()
        self.link = RigLink()
        self.link.loop.set_params({"link_loss_s": 10.0})
        self.links = [self.link, *(self.link.another() for _ in range(WATCHERS))]
        self.hosts = []
        self.logs = []

    def enter(self):
        """All connect and watch, one after the other; the first one drives."""
        for number, link in enumerate(self.links):
            token = None if number else link.token
            self.hosts.append(Robot(link, token, f"host {number}"))
            self.logs.append(Log({}))
            self.hosts[-1].add_tap(self.logs[-1])
        self.driver.lease()
        self.run(40)

    @property
    def driver(self):
        return self.hosts[0]

    def run(self, ticks, *, at_work=False):
        """Let some ticks pass. Returns how many kicks the driver made."""
        box = self.link.loop.blackbox
        end, kicks = box.next_tick + ticks, 0
        while box.next_tick < end:
            tick = box.next_tick
            if at_work and tick % KICK_TICKS == 0:
                self.driver.kick("membrane")
                kicks += 1
            for number, host in enumerate(self.hosts):
                if at_work and number and (tick + number) % ASK_TICKS == 0:
                    with suppress(LinkLost):  # the next look finds it, too
                        host._send(host._talk.request("status", {}, sealed=False)[1])
                if (tick + number) % LOOK_TICKS == 0:
                    host.pump(0.0)
            if box.next_tick == tick:
                self.link.run_tick()
        return kicks

    def records_from(self, tick):
        return [record for record in self.link.records() if record.tick >= tick]


@pytest.fixture
def room(monkeypatch):
    monkeypatch.setattr("tests.link.machines.Clock", BusyClock)
    monkeypatch.setattr("host.client.neighbours.client_id", lambda: uuid4().hex)
    # Nobody waits in real time for what comes in virtual time.
    quick = SimpleNamespace(**{**vars(server.select), "select": lambda *_: ((), (), ())})
    monkeypatch.setattr(server, "select", quick)
    room = Classroom()
    clock = room.link.loop.clock
    receive, stream = Session.receive, Session.stream

    def costly_receive(session, kind, payload):
        room.heard[kind] += 1
        clock.time += GREETING_S if kind in (wire.HELLO, wire.AUTH) else FRAME_S
        return receive(session, kind, payload)

    def costly_stream(session):
        frame = stream(session)
        clock.time += STREAM_S if frame is not None else 0.0
        return frame

    monkeypatch.setattr(Session, "receive", costly_receive)
    monkeypatch.setattr(Session, "stream", costly_stream)
    room.enter()
    yield room
    for host in reversed(room.hosts):
        host.close()


def test_for_a_minute_no_tick_is_late_and_nobody_storms_the_robot(room):
    room.heard.clear()
    first = room.link.loop.blackbox.next_tick
    kicks = room.run(MINUTE_TICKS, at_work=True)
    room.run(20)
    records = room.records_from(first)
    assert len(records) >= MINUTE_TICKS
    assert max(record.late_s for record in records) < 1e-6
    assert room.link.loop.missed == room.link.loop.overruns == 0

    assert [link.opened for link in room.links] == [1] * len(room.links)
    asked = WATCHERS * (len(records) / ASK_TICKS + 1)
    assert room.heard[wire.ASK] <= asked
    assert room.heard[wire.COMMAND] <= 2 * kicks
    assert room.heard[wire.BEAT] <= len(records) * 0.03 / 0.1
    assert set(room.heard) == {wire.ASK, wire.COMMAND, wire.BEAT}

    kick_events = [event for event in room.link.events() if event["event"] == "kick"]
    assert len(kick_events) == kicks >= MINUTE_TICKS // KICK_TICKS // 2
    assert room.link.loop.lease.name == "host 0"
    assert STATES[room.link.loop.safety.state] == "running"
    for log in room.logs:
        assert log.missing() == []
        assert log.records[0].tick <= first
        assert log.records[-1].tick >= first + MINUTE_TICKS


def test_when_all_links_break_at_once_each_host_dials_once(room):
    first = room.link.loop.blackbox.next_tick
    room.run(100, at_work=True)
    for link in room.links:
        link.cut()
    room.run(300, at_work=True)
    assert [link.opened for link in room.links] == [2] * len(room.links)
    assert room.link.loop.lease.name == "host 0"
    records = room.records_from(first)
    assert max(record.late_s for record in records) < 1e-6
    assert room.link.loop.missed == 0
    for log in room.logs:
        assert log.missing() == []
        assert log.records[-1].tick > first + 390
