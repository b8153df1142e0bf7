"""The play between the simulated motor and its wheel."""

from dataclasses import replace
from math import degrees

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_motor.constants import SUBSTEP_S, names
from sim_motor.exact_step import COAST
from sim_motor.motor import (
    ANGLE,
    GAP,
    SPEED,
    WHEEL_SPEED,
)
from tests.sim.motor.motions import ROBOTS, at_rest, history, moving, push


@pytest.fixture(params=names())
def robot(request):
    return ROBOTS[request.param]


def test_after_a_reversal_the_encoder_moves_three_degrees_before_the_wheel(robot):
    state = push(robot, push(robot, at_rest(), 1000, 60), 3000, 0)
    push(robot, state, 300, 10)  # rest at the forward end of the play
    push(robot, state, 3000, 0)
    state[GAP] = robot.backlash / 2
    begin, wheel = state[ANGLE], state[ANGLE] - state[GAP]
    while state[WHEEL_SPEED] == 0.0:
        free = degrees(begin - state[ANGLE])
        assert state[ANGLE] - state[GAP] == pytest.approx(wheel, abs=1e-12)
        push(robot, state, 1, -30)
    assert 2.5 < free <= 3.0


@given(
    data=st.data(),
    name=st.sampled_from(names()),
    duties=st.lists(st.integers(-100, COAST), min_size=1, max_size=8),
)
def test_the_wheel_stays_within_its_play(data, name, duties):
    robot = ROBOTS[name]
    state = data.draw(moving(robot))
    for duty in duties:
        for _ in range(20):
            push(robot, state, 1, duty)
            assert abs(state[GAP]) <= robot.backlash / 2


def test_an_impact_keeps_momentum_and_is_plastic(robot):
    smooth = replace(robot, kinetic=0.0, static=0.0, rolling=0.0, viscous=0.0)
    state = np.array([0.0, 0.0, 5.0, 0.0, 0.02, 1.0])
    inertias = smooth.motor_inertia, smooth.wheel_inertia
    momentum = inertias[0] * state[SPEED] + inertias[1] * state[WHEEL_SPEED]
    centre = inertias[0] * state[ANGLE] + inertias[1] * (state[ANGLE] - state[GAP])
    push(smooth, state, 20, COAST)
    assert state[SPEED] == pytest.approx(state[WHEEL_SPEED])
    assert inertias[0] * state[SPEED] + inertias[1] * state[WHEEL_SPEED] == pytest.approx(momentum)
    moved = inertias[0] * state[ANGLE] + inertias[1] * (state[ANGLE] - state[GAP])
    assert moved - centre == pytest.approx(momentum * 20 * SUBSTEP_S)


def test_braking_parts_the_wheel_from_the_motor_and_brings_it_to_the_other_end(robot):
    state = push(robot, at_rest(), 1000, 85)
    assert state[GAP] == robot.backlash / 2
    gaps = history(robot, state, 100, 0)[:, GAP]
    assert np.any(np.abs(gaps) < robot.backlash / 2)
    assert gaps[-1] == -robot.backlash / 2


def test_a_load_holds_drives_and_stops_the_wheel(robot):
    """In coast a load must overcome the gearing's static friction.

    A torque above the motor's stops a running wheel and turns it back.
    """
    hold = robot.static + robot.rolling
    end = -robot.backlash / 2  # the wheel pushes the motor forward
    assert push(robot, at_rest(end), 1000, COAST, torque=0.95 * hold)[SPEED] == 0.0
    assert push(robot, at_rest(end), 1000, COAST, torque=1.05 * hold)[SPEED] > 0.0
    assert push(robot, push(robot, at_rest(), 1000, 50), 1000, 50, torque=-1.0)[WHEEL_SPEED] < 0
