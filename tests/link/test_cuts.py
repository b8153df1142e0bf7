"""Half an hour of the simulated robot with a link that breaks every half minute.

Not one tick is missing at the host.
"""

from random import Random
from types import SimpleNamespace

import pytest

from host.client.robot import Robot
from host.errors import NoLink
from host.link.sim import SimLink
from host.logs.log import Log
from robot.blackbox import BlackBox
from robot.record import STRUCT
from sim_motor.clock import VirtualClock
from tests.rig import Motor, packed

TICKS = 60000
BETWEEN_S = 30.0


class BreakingLink(SimLink):
    """sim:// whose link breaks every half minute.

    In the middle of what is on its way, and for a while.
    """

    def __init__(self, seed, longest_s=3.0):
        # How wheels move is no subject here, and would take as long to compute as all else.
        motors, clock = (Motor(turn=0.3), Motor(turn=-0.2)), VirtualClock(seed)
        brick = SimpleNamespace(motors=motors, battery=None, clock=clock, seed=seed)
        super().__init__("sim://", brick)
        self.written = bytearray()
        self.breaks = 0
        self._random = Random(seed)
        self._longest_s = longest_s
        self._break_at = BETWEEN_S
        self._back_at = 0.0
        self.follow(self.loop.blackbox)

    def follow(self, box):
        """Keep a copy of everything that goes into the black box."""
        append = box.append

        def appended(fields):
            self.written += STRUCT.pack(box.next_tick, *fields)
            append(fields)

        box.append = appended
        self.loop.blackbox = box

    def open(self):
        if self.now() < self._back_at:
            self.run_tick()
            raise NoLink("out of reach")
        super().open()

    def receive(self, timeout_s):
        data = super().receive(timeout_s)
        if self.now() >= self._break_at:
            self._break_at += BETWEEN_S
            self._back_at = self.now() + self._random.uniform(0.0, self._longest_s)
            self.breaks += 1
            self.close()
            data = data[: self._random.randrange(len(data) + 1)]
        return data


def ticks_of(log):
    return [record.tick for record in log.records]


def test_half_an_hour_with_a_cut_every_half_minute_misses_no_tick():
    link = BreakingLink(seed=1)
    kicks = []
    with Robot(link, link.token) as robot:
        robot.set(link_loss="continue")
        log = Log(robot.info())
        robot.add_tap(log)
        first = link.loop.blackbox.next_tick
        while link.loop.blackbox.next_tick < TICKS:
            robot.wait(29.0)
            kicks.append(robot.kick("phase", ticks=4))
        robot.wait(0.2)
        robot.remove_tap(log)
    assert link.breaks >= 59
    assert len(log) >= TICKS - first
    assert ticks_of(log) == list(range(first, first + len(log)))
    assert log.missing() == []
    begin = first * STRUCT.size
    assert packed(log.records) == link.written[begin : begin + len(log) * STRUCT.size]
    assert [kick["begin"] for _, kick in log.kicks()] == kicks
    assert [log.records[place].kick for place, _ in log.kicks()] == [3] * len(kicks)
    assert {event["event"] for event in log.events} <= {"snapshot", "kick", "params", "link_loss"}
    assert [event["event"] for event in log.events].count("snapshot") == 1


@pytest.mark.parametrize("capacity", [40, 500])
def test_a_host_that_is_away_for_longer_than_the_black_box_is_told_exactly_what_it_lost(capacity):
    link = BreakingLink(seed=2, longest_s=9.0)
    link.written.clear()
    link.follow(BlackBox(link.loop.params.values(), capacity))
    with Robot(link, None) as robot:
        log = Log()
        robot.add_tap(log)
        first = link.loop.blackbox.next_tick
        robot.wait(15 * BETWEEN_S)
        robot.remove_tap(log)
    lost = [(event["from"], event["tick"]) for event in log.events if event["event"] == "lost"]
    assert link.breaks == 15
    assert (len(lost) >= 10) == (capacity == 40)
    assert log.missing() == lost
    gone = [tick for begin, end in lost for tick in range(begin, end)]
    ticks = ticks_of(log)
    assert sorted(ticks + gone) == list(range(first, ticks[-1] + 1))
    written = bytes(link.written)
    assert packed(log.records) == b"".join(
        written[tick * STRUCT.size : (tick + 1) * STRUCT.size] for tick in ticks
    )
