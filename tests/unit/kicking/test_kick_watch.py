"""The outcome of a kick from the robot's records, as they come in."""

import pytest

from host.kicking.kick_watch import KickWatch
from robot.loop import Loop
from robot.record import unpack
from sim_motor.brick import SimBrick

BEGIN = 130


def kicked(request, ticks=300, **changes):
    """(kick, records) of a robot that is kicked in tick BEGIN."""
    brick = SimBrick(1)
    loop = Loop(brick.motors, brick.battery, brick.clock, 1)
    if changes:
        loop.set_params(changes)
    loop.start()
    for tick in range(ticks):
        brick.clock.wait(loop.deadline, lambda timeout_s: None)
        if tick == BEGIN:
            event = loop.kick({"id": "k", **request})
            assert event == BEGIN
        loop.tick()
    events = [loop.blackbox.event(number) for number in range(loop.blackbox.next_event)]
    kick = next(event["kick"] for event in events if event["event"] == "kick")
    return kick, unpack(loop.blackbox.read(0, ticks))


def watch(kick, records, step=7):
    """A watch from the kick on, which gets some records at a time."""
    found = KickWatch(kick, records[:BEGIN])
    for first in range(BEGIN, len(records), step):
        found.take_records(records[first : first + step])
    return found


@pytest.fixture(scope="module")
def inversion():
    return kicked({"mode": "membrane", "wheel": "left"})


def test_a_reversal_is_told_with_its_time(inversion):
    outcome = watch(*inversion).outcome
    assert outcome.results == {"left": "reverses", "right": "continues"}
    assert outcome.reversed
    assert outcome.wheel == "left"
    assert outcome.applied_tick == BEGIN
    assert {outcome.before["left"], outcome.after["left"]} == {"forward", "backward"}
    assert 0.1 < outcome.settling_s < 1.5


@pytest.mark.parametrize("step", [1, 50, 1000])
def test_it_does_not_matter_how_records_come(inversion, step):
    assert watch(*inversion, step=step).outcome == watch(*inversion).outcome


def test_nothing_is_told_before_the_wheels_have_settled(inversion):
    kick, records = inversion
    found = watch(kick, records[: BEGIN + 36])
    assert not found.done
    found.take_records(records[BEGIN + 36 :])
    assert found.outcome.reversed


def test_a_kick_that_does_not_reverse_continues():
    outcome = watch(*kicked({"mode": "position", "ticks": 1})).outcome
    assert set(outcome.results.values()) == {"continues"}
    assert not outcome.reversed


def test_wheels_that_never_settle_are_judged_by_their_headings():
    kick, records = kicked({"mode": "membrane"}, ticks=450, k=15.0, tau_s=1.0)
    found = watch(kick, records)
    assert found.outcome is not None
    assert found.outcome.settling_s is None


def test_slow_wheels_are_watched_until_it_is_known_when_they_had_settled():
    kick, records = kicked({"mode": "phase", "ticks": 5}, k=1.2)
    outcome = watch(kick, records).outcome
    assert outcome.reversed
    assert 0.9 < outcome.settling_s < 1.8


def test_without_records_around_the_kick_there_is_no_outcome(inversion):
    kick, records = inversion
    stopped = [*records[: BEGIN + 20], records[BEGIN + 20]._replace(state=3)]
    assert "stopped" in watch(kick, stopped).gave_up
    assert "missing" in watch(kick, [*records[:140], *records[141:]]).gave_up
    late = KickWatch(kick)
    late.take_records(records[BEGIN + 1 :])
    assert "before the kick" in late.gave_up
    assert late.outcome is None
