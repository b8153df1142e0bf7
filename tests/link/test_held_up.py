"""A robot that hosts keep busy, or that its machine holds up, in virtual time."""

import pytest

from robot import schedule, wire
from robot.motors import MonotonicClock
from robot.record import STATES
from tests.link.desk import Desk

# How long each look at the clock takes (s): work is what makes time pass.
LOOK_S = 20e-6


class Clock(MonotonicClock):
    """The program's own clock, on which time passes as it works or sleeps."""

    def __init__(self):
        self.time = self.slept_s = 0.0

    def now(self):
        self.time += LOOK_S
        return self.time

    def sleep(self, seconds):
        self.time += seconds
        self.slept_s += seconds


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr("robot.server.time.sleep", clock.sleep)
    # Waiting for who sends something, while nobody does.
    monkeypatch.setattr(
        "robot.server.select.select", lambda reads, writes, errors, left_s: clock.sleep(left_s)
    )
    return clock


@pytest.fixture
def desk(clock):
    desk = Desk(clock)
    desk.loop._before = desk.loop.epoch = desk.loop.deadline = clock.now()
    yield desk
    desk.close()


def flooded(desk, monkeypatch, ticks):
    """Ticks while a host without a token asks for more than can be answered; share of sleep."""
    flood = desk.connect(token=None, name="flood", paired=True).greet()
    ask = b"".join(flood.talk.request("status", {}, False)[1] for _ in range(50))
    real = desk.server._hear

    def hear(until):
        flood.send(ask)
        flood.read()
        flood.talk._answers.clear()
        return real(until)

    monkeypatch.setattr(desk.server, "_hear", hear)
    monkeypatch.setattr(  # somebody always has sent something
        "robot.server.select.select", lambda reads, writes, errors, left_s: None
    )
    begin, desk.clock.slept_s = desk.clock.time, 0.0
    desk.run(ticks)
    return desk.clock.slept_s / (desk.clock.time - begin)


def test_a_program_with_real_time_priority_sleeps_in_each_period_whatever_hosts_want(
    desk, monkeypatch
):
    desk.loop.real_time = True
    share = flooded(desk, monkeypatch, 50)
    assert 0.05 < share <= schedule.REST_SHARE + 0.001  # the kernel wants 0.05
    assert desk.loop.missed == 0


def test_without_that_priority_it_works_all_the_time(desk, monkeypatch):
    assert flooded(desk, monkeypatch, 20) == 0.0


@pytest.mark.parametrize("real_time", [True, False])
def test_a_stop_in_the_last_moment_of_a_period_is_obeyed_before_the_next_tick(
    desk, clock, monkeypatch, real_time
):
    desk.loop.real_time = real_time
    desk.loop.start()
    host = desk.connect(token=None, paired=True).greet()
    real, sent = clock.sleep, []

    def sleep(seconds):
        real(seconds)
        if not sent and desk.loop.deadline - clock.time < 0.001:
            sent.append(host.send(wire.encode(wire.STOP, b"")))

    monkeypatch.setattr("robot.server.time.sleep", sleep)
    monkeypatch.setattr(
        "robot.server.select.select",
        lambda reads, writes, errors, left_s: sleep(max(0.0, left_s - 0.0005)),
    )
    desk.run()
    assert sent
    assert STATES[desk.last.state] == "stopped"


def test_who_sent_beats_while_the_program_was_held_up_was_not_silent(desk, clock, monkeypatch):
    driver = desk.connect(name="driver", paired=True).greet()
    driver.ask("lease", sealed=True)
    driver.ask("start", sealed=True)

    def halted(reads, writes, errors, left_s):
        clock.sleep(2.0)
        driver.send(driver.talk.beat())

    monkeypatch.setattr("robot.server.select.select", halted)
    desk.run()
    assert desk.loop.missed > 50
    assert STATES[desk.last.state] == "running"
    assert desk.loop.lease.holder == "driver"


def test_who_was_silent_for_longer_than_that_was_silent(desk, clock, monkeypatch):
    driver = desk.connect(name="driver", paired=True).greet()
    driver.ask("lease", sealed=True)
    driver.ask("start", sealed=True)
    monkeypatch.setattr("robot.server.select.select", lambda *_: clock.sleep(2.0))
    desk.run()
    assert STATES[desk.last.state] == "stopped"
    assert "'driver' was silent" in desk.events[-1]["reason"]
