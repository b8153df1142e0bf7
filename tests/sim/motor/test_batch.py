"""The compiled batch against the robot's own loop, tick by tick and bit by bit."""

import numpy as np
import pytest

from host.logs.motion import settling_of
from robot import controller, kicks
from robot.kicks import (
    DIRECTION_TICKS,
    JUMP,
    MEMBRANE,
    PHASE,
    POSITION,
    PULSE_BETA,
    PULSE_SHIFT,
    WHEELS,
    Kick,
)
from robot.loop import Loop
from robot.params import Params
from robot.record import unpack
from robot.safety import limit_duty
from sim_motor import batch
from sim_motor.brick import SimBrick
from sim_motor.compiled import compiled, on_one_core
from sim_motor.constants import load

TICKS, BEGIN = 600, 250

REQUESTS = [
    {"mode": "phase", "ticks": 4},
    {"mode": "phase", "ticks": 6, "shift": 1.0},
    {"mode": "position", "ticks": 3},
    {"mode": "membrane"},
    {"mode": "jump", "variable": "x1", "delta": 1.5},
    {"mode": "jump", "variable": "x2", "delta": -2.0},
    {"mode": "pulse", "param": "k", "value": 0.0, "ticks": 20},
    {"mode": "pulse", "param": "a", "value": 20.0, "ticks": 9, "shape": "smooth"},
    {"mode": "pulse", "param": "tau_s", "value": 0.1, "ticks": 5},
    {"mode": "waveform", "param": "shift_rad", "waveform": [0.3, 2.0, 2.4, 0.1]},
]


def run_loop(seed, request, changes, motor):
    """(brick, its start, records, kick) of the robot's own loop, kicked in tick BEGIN."""
    brick = SimBrick(seed, motor=motor)
    states = np.array([wheel.state for wheel in brick.motors])
    loop = Loop(brick.motors, brick.battery, brick.clock, seed)
    loop.set_params(changes)
    loop.start()
    for tick in range(TICKS):
        brick.clock.wait(loop.deadline, lambda timeout_s: None)
        if tick == BEGIN:
            loop.kick({"id": "k", **request})
        loop.tick()
    events = {
        event["event"]: event for event in map(loop.blackbox.event, range(loop.blackbox.next_event))
    }
    start = batch.Start(states, np.array(events["start"]["x"]))
    return brick, start, unpack(loop.blackbox.read(0, TICKS)), Kick(**events["kick"]["kick"])


def run_batch(brick, start, records, kick, changes):
    """The two wheels of the same run in a batch."""
    params = Params()
    params.apply(params.check(changes))
    if kick.mode == PHASE and kick.values[0] != kick.values[1]:
        kick.values = (batch.PHASE_SHIFT,) * 2
    constants = tuple(motor.constants for motor in brick.motors)
    times = np.array([record.t_s for record in records])
    return batch.run(
        2, TICKS, 0, params=params, kick=kick, motors=constants, start=start, times=times, record=2
    )


@pytest.mark.parametrize(
    "request_", REQUESTS, ids=lambda request: "-".join(str(value) for value in request.values())
)
@pytest.mark.parametrize(
    ("seed", "changes", "motor"),
    [
        (1, {"k": 8.0}, "pybricks"),
        (
            2,
            {"k": 2.0, "rods": 1, "max_duty_pct": 100.0, "duty_scale": 0.8},
            "nxt_unroller",
        ),
        (3, {"rod_lag_s": 0.0075}, load().with_dither(0.2)),
    ],
)
def test_a_wheel_in_a_batch_equals_the_robots_loop(request_, seed, changes, motor):
    brick, start, records, kick = run_loop(seed, request_, changes, motor)
    result = run_batch(brick, start, records, kick, changes)
    for wheel, side in enumerate(WHEELS):
        for channel, name in enumerate(batch.CHANNELS):
            expected = [getattr(record, f"{side}_{name}") for record in records]
            assert np.array_equal(result.records[wheel, :, channel], expected), name


@pytest.mark.parametrize("request_", REQUESTS[1:5], ids=lambda request: request["mode"])
def test_wheels_that_run_already_go_on_as_in_the_robots_loop(request_):
    """The kick begins in the first tick; each wheel has its own battery voltage."""
    brick = SimBrick(1, jitter=False)
    brick.motors[1].set_supply(6.0)
    loop = Loop(brick.motors, brick.battery, brick.clock, 1)
    loop.start()
    for tick in range(BEGIN + 100):
        brick.clock.wait(loop.deadline, lambda timeout_s: None)
        if tick == BEGIN:
            brick.truth()
            states = np.array([wheel.state for wheel in brick.motors])
            loop.kick({"id": "k", **request_})
        loop.tick()
    records = unpack(loop.blackbox.read(BEGIN - 1, 101))
    last, records = records[0], records[1:]
    start = batch.Start(
        states,
        np.array([[last.left_x1, last.left_x2], [last.right_x1, last.right_x2]]),
        np.array([last.left_duty_pct, last.right_duty_pct]),
    )
    events = map(loop.blackbox.event, range(loop.blackbox.next_event))
    kick = Kick(**next(event["kick"] for event in events if event["event"] == "kick"))
    kick.begin = 0
    result = batch.run(
        2,
        100,
        0,
        kick=kick,
        motors=tuple(motor.constants for motor in brick.motors),
        battery_v=np.array([7.5, 6.0]),
        start=start,
        times=0.03 * np.arange(100),
        record=2,
    )
    assert result.before.tolist() == [0, 0]
    for wheel, side in enumerate(WHEELS):
        logged = [getattr(record, side + "_phi_rad") for record in records]
        assert np.ptp(logged) > 2.0
        assert result.records[wheel, :, 0].tolist() == logged
    alone = start.of(slice(1, 2))
    assert (alone.states == states[1]).all()
    assert alone.duties.tolist() == [last.right_duty_pct]


def test_a_kick_of_wheels_that_run_needs_its_sign_at_once():
    start = batch.Start(np.zeros((1, 6)), np.zeros((1, 2)), np.zeros(1, dtype=np.int64))
    kick = phase_kick(4)
    kick.begin = 0
    with pytest.raises(ValueError, match="to tell directions"):
        batch.run(1, 100, 0, start=start, kick=kick)


def test_a_phase_kick_takes_its_sign_from_each_wheel():
    """Among enough seeds some robot turns on the spot.

    There the loop gives the wheels opposite shifts, and so does the batch.
    """
    for seed in range(20):
        brick, start, records, kick = run_loop(seed, {"mode": "phase"}, {"k": 8.0}, "pybricks")
        if kick.values[0] != kick.values[1]:
            break
    result = run_batch(brick, start, records, kick, {"k": 8.0})
    assert result.before.tolist() in [[1, -1], [-1, 1]]
    assert result.reversed.all()
    assert result.records[1, :, 0].tolist() == [record.right_phi_rad for record in records]


def phase_kick(ticks):
    return Kick(
        "phase", PHASE, WHEELS, ticks, pulse=PULSE_SHIFT, values=(batch.PHASE_SHIFT,) * 2, begin=150
    )


def test_kicks_of_3_to_5_ticks_reverse_and_of_one_do_not():
    """R8 to R10, for a single wheel."""
    position = {
        ticks: Kick("p", POSITION, WHEELS, ticks, pulse=PULSE_BETA, values=(1.0, 1.0), begin=150)
        for ticks in (1, 4)
    }
    assert batch.run(200, 300, 1, kick=Kick("m", MEMBRANE, WHEELS, 1, begin=150)).reversed.all()
    assert batch.run(200, 300, 2, kick=phase_kick(4)).reversed.mean() >= 0.95
    assert batch.run(200, 300, 3, kick=position[4]).reversed.mean() >= 0.95
    assert batch.run(200, 300, 4, kick=phase_kick(1)).reversed.mean() < 0.05
    assert batch.run(200, 300, 5, kick=position[1]).reversed.mean() < 0.05


def test_directions_and_settling_are_those_of_the_record():
    result = batch.run(20, 400, 6, kick=phase_kick(4), record=20)
    times = np.broadcast_to(result.times, (20, 400))
    for wheel in range(20):
        phi = result.records[wheel, :, 0]
        assert result.before[wheel] == kicks.direction(phi[149] - phi[149 - DIRECTION_TICKS])
        assert result.after[wheel] == kicks.direction(phi[-1] - phi[-1 - DIRECTION_TICKS])
        assert result.settled_s[wheel] == settling_of(phi, times[wheel], times[wheel, 150])
        assert 0.1 < result.settled_s[wheel] < 2


def test_what_has_no_time_to_settle_has_not_settled():
    assert np.isnan(batch.run(10, 165, 7, kick=phase_kick(4)).settled_s).all()


def test_a_seed_gives_the_same_wheels_on_any_core_and_another_gives_others():
    first, again, other = (batch.run(64, 200, seed, record=64).records for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_a_wheel_does_not_depend_on_its_neighbours():
    rng = np.random.default_rng(3)
    start, times = batch.random_start(9, rng, load()), batch.random_times(9, 200, 0.03, rng)
    together = batch.run(9, 200, 0, start=start, times=times, record=9).records
    for wheel in range(9):
        one = batch.Start(start.states[wheel : wheel + 1], start.potentials[wheel : wheel + 1])
        alone = batch.run(1, 200, 0, start=one, times=times[wheel], record=1).records[0]
        assert np.array_equal(together[wheel], alone)


def test_running_leaves_its_start_as_it_was():
    start = batch.random_start(3, np.random.default_rng(4), load())
    before = start.states.copy(), start.potentials.copy()
    batch.run(3, 50, 0, start=start)
    assert np.array_equal(start.states, before[0])
    assert np.array_equal(start.potentials, before[1])


@pytest.mark.parametrize("begin", [0, DIRECTION_TICKS, 92, 100, 1000])
def test_a_kick_too_near_to_either_end_is_refused(begin):
    with pytest.raises(ValueError, match="to tell directions"):
        batch.run(1, 100, 0, kick=Kick("m", MEMBRANE, WHEELS, 1, begin=begin))


def test_times_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="do not fit"):
        batch.run(2, 100, 0, times=np.zeros(99))
    with pytest.raises(ValueError, match="too few"):
        batch.run(2, DIRECTION_TICKS, 0)
    with pytest.raises(ValueError, match="use longer ticks"):
        batch.run(2, 100, 0, times=np.arange(100) * 0.003)
    with pytest.raises(ValueError, match="do not fit"):
        batch.run(2, 100, 0, start=batch.random_start(3, np.random.default_rng(0), load()))
    lost = batch.Start(np.zeros((2, 6)), np.full((2, 2), np.nan))
    for wrong in ({"start": lost}, {"battery_v": np.inf}, {"times": np.full(100, np.nan)}):
        with pytest.raises(ValueError, match="finite"):
            batch.run(2, 100, 0, **wrong)


def test_a_jump_is_bounded_as_in_the_robot():
    far = Kick("j", JUMP, WHEELS, 1, variable="x1", delta=1000.0, begin=20)
    x1 = batch.run(1, 60, 0, kick=far, record=1).records[0, 20, 1]
    assert kicks.X_LIMIT * 0.8 < x1 <= kicks.X_LIMIT


# Compiled functions.


def test_duties_round_half_to_even_when_compiled():
    """As Python does: 0.5, 1.5 and 2.5 % become 0, 2 and 2."""
    fast = compiled(limit_duty)
    for torque in (0.005, 0.015, 0.025, -0.005, -0.015, 0.994999, 2.0, -2.0, float("nan")):
        assert fast(torque, 100.0) == limit_duty(torque, 100.0)
    assert [fast(torque, 100.0) for torque in (0.005, 0.015, 0.025)] == [0, 2, 2]


def test_compiling_leaves_the_robots_functions_alone():
    fast = compiled(controller.step_wheel)
    assert type(controller.step_wheel) is type(controller.motor_torque) is type(lambda: None)
    arguments = (0.1, -0.2, 0.54, 0.84, 0.52, 0.85, 0.5, 0.8, 0.031, 4.0, 0.25, 8.0, 2)
    assert fast(*arguments) == controller.step_wheel(*arguments)


def test_on_one_core_wheels_are_the_same():
    spread = batch.run(40, 60, 1, record=40).records
    with on_one_core():
        assert np.array_equal(batch.run(40, 60, 1, record=40).records, spread)
