"""The simulated motor, against what is published about the real one and against its equations."""

from dataclasses import replace
from math import degrees, pi, radians

import numpy as np
import pytest

from sim_motor.constants import SUBSTEP_S, data, load, names
from sim_motor.exact_step import COAST
from sim_motor.motor import (
    ANGLE,
    CURRENT,
    SPEED,
    WHEEL_SPEED,
)
from tests.sim.motor.motions import NOMINAL_V, ROBOTS, at_rest, bare, history, push


@pytest.fixture(params=names())
def robot(request):
    return ROBOTS[request.param]


@pytest.mark.parametrize(("name", "published"), [("pybricks", 929), ("nxt_unroller", 941)])
def test_turns_at_the_published_no_load_speed(name, published):
    state = push(bare(ROBOTS[name]), at_rest(), 3000, 100, 8.0)
    assert degrees(state[SPEED]) == pytest.approx(published, rel=0.05)


def test_reaches_63_percent_of_its_speed_in_70_to_105_ms(robot):
    speeds = history(bare(robot), at_rest(), 2000, 100, 8.0)[:, SPEED]
    assert 70 <= np.interp(0.63 * speeds[-1], speeds[:500], np.arange(1, 501)) <= 105


@pytest.mark.parametrize(("duty", "shortest_s", "longest_s"), [(0, 0.25, 0.35), (COAST, 1.8, 2.4)])
def test_brakes_in_a_third_of_a_second_and_coasts_for_two(robot, duty, shortest_s, longest_s):
    state = at_rest()
    state[SPEED] = state[WHEEL_SPEED] = radians(900)
    speeds = history(bare(robot), state, 4000, duty)[:, SPEED]
    assert shortest_s < np.argmax(speeds == 0.0) * SUBSTEP_S < longest_s


@pytest.mark.parametrize(("name", "stall"), [("pybricks", 0.383), ("nxt_unroller", 0.349)])
def test_holds_against_its_published_stall_torque(name, stall):
    """At 8 V, give or take its static friction."""
    motor = bare(ROBOTS[name])
    friction = motor.static
    beaten, winning = (
        push(motor, at_rest(), 3000, 100, 8.0, torque)[SPEED]
        for torque in (-stall - 1.1 * friction, -stall + 1.1 * friction)
    )
    assert beaten < 0 < winning
    assert push(motor, at_rest(), 3000, 100, 8.0, -stall)[SPEED] == 0.0


def test_on_the_robot_runs_as_the_paper_says(robot):
    """R2 and R3."""
    speed = push(robot, at_rest(), 3000, 85)[WHEEL_SPEED]
    assert 1.8 < speed / (2 * pi) < 2.3
    assert 0.32 < speed * robot.wheel_radius < 0.39


def test_every_number_has_a_unit_and_a_source():
    for table in data().values():
        for value, unit, source in table.values():
            assert isinstance(value, (int, float))
            assert unit
            assert len(source) > 7


def test_an_unknown_motor_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="pybricks, nxt_unroller"):
        load("nxt")


def test_the_body_decouples_into_the_wheels():
    """Half the mass at each wheel is a body whose radius of gyration is half its track."""
    mass, track, radius = (data()["robot"][key][0] for key in ("mass", "track", "wheel_radius"))
    left, right = 7.0, -2.0
    forward, turning = radius * (left + right) / 2, radius * (right - left) / track
    body = 0.5 * mass * forward**2 + 0.5 * mass * (track / 2) ** 2 * turning**2
    share = load().wheel_inertia - data()["robot"]["wheel_inertia"][0]
    assert 0.5 * share * (left**2 + right**2) == pytest.approx(body)


# The solution of its equations.


def test_a_substep_is_the_exact_solution(robot):
    """Against many small Runge-Kutta steps, through 20 ms in which the motor pushes the wheel."""
    duty, c = 60, robot
    inertia, friction = c.motor_inertia + c.wheel_inertia, c.kinetic + c.rolling
    ohms = c.resistance + 2 * c.source_resistance * (duty / 100) ** 2

    def rate(y):
        _, speed, current = y
        torque = c.torque_constant * current - c.viscous * speed - friction
        return np.array(
            [
                speed,
                torque / inertia,
                (NOMINAL_V * duty / 100 - c.emf_constant * speed - ohms * current) / c.inductance,
            ]
        )

    state = np.array([0.0, 0.0, 3.0, 0.4, c.backlash / 2, 3.0])
    y, h = np.array([0.0, 3.0, 0.4]), 1e-5
    for _ in range(2000):
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
    push(robot, state, 20, duty)
    assert state[[ANGLE, SPEED, CURRENT]] == pytest.approx(y, abs=1e-9)


def test_without_friction_speed_goes_with_voltage(robot):
    ideal = replace(bare(robot), kinetic=0.0, static=0.0)
    single, double = (push(ideal, at_rest(), 250, 40, volts)[SPEED] for volts in (4.0, 8.0))
    assert single > 1
    assert double == pytest.approx(2 * single, rel=1e-12)


def test_forward_and_backward_are_mirror_images(robot):
    duties = [40, -90, 0, 85, COAST, 12, -12, 5]
    there, back = at_rest(0.01, 0.2), at_rest(-0.01, -0.2)
    for duty in duties:
        push(robot, there, 77, duty)
        push(robot, back, 77, duty if duty == COAST else -duty)
    assert np.array_equal(there, -back)


def test_how_substeps_are_portioned_changes_no_bit(robot):
    duties = np.random.default_rng(5).integers(-100, COAST + 1, 60)
    whole, parts = at_rest(), at_rest()
    for duty in duties:
        push(robot, whole, 31, duty)
        for count in (1, 0, 7, 23):
            push(robot, parts, count, duty)
    assert np.array_equal(whole, parts)
