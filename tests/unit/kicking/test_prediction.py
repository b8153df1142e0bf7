"""Predictions of kicks: what is certain is certain, and what depends on the click is shared."""

import pytest

from host.errors import NotDone, WrongUse
from host.kicking.outcome import RESULTS, compare
from host.kicking.prediction import predict, warm_up
from robot.loop import Loop
from robot.record import unpack
from sim_motor.brick import SimBrick
from sim_motor.constants import load


def run_robot(seed, ticks=130, battery_v=None, **changes):
    """(records, parameters) of a robot that has run for some ticks."""
    brick = SimBrick(seed, battery_v=battery_v)
    loop = Loop(brick.motors, brick.battery, brick.clock, seed)
    if changes:
        loop.set_params(changes)
    loop.start()
    for _ in range(ticks):
        brick.clock.wait(loop.deadline, lambda timeout_s: None)
        loop.tick()
    return unpack(loop.blackbox.read(0, ticks)), dict(loop.params.values())


@pytest.fixture(scope="module")
def rolling():
    return run_robot(1)


def shares(robot, kick, **options):
    records, params = robot
    found = predict(records, params, kick, load(), **options)
    for counts in found.shares.values():
        assert tuple(counts) == RESULTS
        assert sum(counts.values()) == found.of
    return {side: counts["reverses"] / found.of for side, counts in found.shares.items()}


def test_an_inversion_reverses_for_sure_and_a_kick_of_one_tick_does_not(rolling):
    assert shares(rolling, {"mode": "membrane"}) == {"left": 1.0, "right": 1.0}
    assert shares(rolling, {"mode": "position", "ticks": 1}) == {"left": 0.0, "right": 0.0}


def test_only_the_kicked_wheel_reverses(rolling):
    assert shares(rolling, {"mode": "membrane", "wheel": "right"}) == {"left": 0.0, "right": 1.0}


def test_a_phase_kick_gets_the_sign_that_reverses_each_wheel(rolling):
    wrong = [rolling] + [run_robot(seed) for seed in (2, 3)]
    assert all(min(shares(robot, {"mode": "phase"}).values()) > 0.9 for robot in wrong)


def test_a_wheel_that_loses_its_springs_stops(rolling):
    records, params = rolling
    weak = predict(records, params | {"k": 0.0}, {"mode": "membrane"}, load())
    assert weak.shares["left"] == {"reverses": 0, "continues": 0, "stops": weak.of}


def test_the_wheels_own_speed_tells_the_voltage(rolling):
    """Whatever the battery is thought to have, the same robot has the same future."""
    kick = {"mode": "position", "ticks": 2}
    told = [shares(rolling, kick, battery_v=volts)["right"] for volts in (6.5, 7.5, 8.5)]
    assert max(told) - min(told) < 0.15


def test_the_same_seed_gives_the_same_prediction(rolling):
    kick = {"mode": "jump", "variable": "x1", "delta": 1.3}
    assert shares(rolling, kick, seed=4) == shares(rolling, kick, seed=4)


def test_a_wheel_from_rest_continues_to_rest():
    robot = run_robot(1, k=0.0)
    assert shares(robot, {"mode": "membrane"}) == {"left": 0.0, "right": 0.0}


def test_what_the_robot_would_refuse_is_refused(rolling):
    with pytest.raises(WrongUse, match="ticks cannot be 0"):
        shares(rolling, {"mode": "phase", "ticks": 0})


def test_a_robot_that_stands_or_has_only_begun_cannot_be_predicted(rolling):
    records, params = rolling
    with pytest.raises(NotDone, match="does not run"):
        shares(([record._replace(state=3) for record in records], params), {"mode": "membrane"})
    with pytest.raises(NotDone, match="in a row"):
        shares((records[:5], params), {"mode": "membrane"})
    with pytest.raises(NotDone, match="in a row"):
        shares(([*records[:-5], *records[-4:]], params), {"mode": "membrane"})


@pytest.mark.parametrize("tick_s", [0.01, 0.05])
def test_every_control_period_can_be_predicted(tick_s):
    robot = run_robot(1, ticks=round(3 / tick_s), tick_s=tick_s, tau_s=0.4)
    assert min(shares(robot, {"mode": "membrane"}).values()) > 0.9


def test_ticks_may_be_as_late_as_they_like_and_missed(rolling):
    records, params = rolling
    late = [record._replace(late_s=0.029, missed=1) for record in records]
    assert shares((late, params), {"mode": "position", "ticks": 4}) != shares(
        rolling, {"mode": "position", "ticks": 4}
    )


def test_warming_up_needs_no_robot():
    warm_up()


@pytest.mark.parametrize(
    ("before", "after", "result"),
    [
        ("forward", "backward", "reverses"),
        ("forward", "forward", "continues"),
        ("backward", "stopped", "stops"),
        ("stopped", "stopped", "continues"),
        ("stopped", "backward", "reverses"),
    ],
)
def test_results_have_three_names(before, after, result):
    assert compare(before, after) == result
