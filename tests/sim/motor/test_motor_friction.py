"""Friction of the simulated motor: what sticks, what stops, and where energy goes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_motor.constants import GRAVITY, SUBSTEP_S, data, names
from sim_motor.exact_step import COAST
from sim_motor.motor import (
    ANGLE,
    CURRENT,
    SPEED,
    WHEEL_SPEED,
)
from tests.sim.motor.motions import NOMINAL_V, ROBOTS, at_rest, moving, push, stored


@pytest.fixture(params=names())
def robot(request):
    return ROBOTS[request.param]


@settings(max_examples=40)
@given(
    gap=st.sampled_from([-1.0, 1.0]) | st.floats(-1, 1),
    name=st.sampled_from(names()),
    sign=st.sampled_from([1, -1]),
    angle=st.floats(-10, 10),
)
def test_duty_8_leaves_the_robots_wheel_where_it_is_and_9_moves_it(gap, name, sign, angle):
    """R5: M of 0.1 is 8.5 %, wherever in its play the wheel stands."""
    robot = ROBOTS[name]
    state = at_rest(gap * robot.backlash / 2, angle)
    before = state.copy()
    push(robot, state, 5000, 8 * sign)
    before[CURRENT] = state[CURRENT]
    assert np.array_equal(state, before)
    push(robot, state, 500, 9 * sign)
    assert sign * state[WHEEL_SPEED] > 0


def test_what_moves_keeps_moving_where_what_rests_stays(robot):
    """Static friction exceeds kinetic.

    Duty 7 does not start a wheel, but does not stop it either.
    """
    moving, resting = push(robot, at_rest(), 400, 20), at_rest()
    push(robot, moving, 5000, 7)
    push(robot, resting, 5000, 7)
    assert moving[WHEEL_SPEED] > 0.1
    assert resting[WHEEL_SPEED] == resting[SPEED] == 0.0


@pytest.mark.parametrize("duty", [0, 1, 2, COAST])
def test_a_stopped_wheel_is_exactly_still(robot, duty):
    state = push(robot, push(robot, at_rest(), 1000, 85), 6000, duty)
    still = state.copy()
    push(robot, state, 1000, duty)
    assert state[SPEED] == state[WHEEL_SPEED] == 0.0
    assert np.array_equal(state, still)


@given(data=st.data(), name=st.sampled_from(names()), duty=st.sampled_from([0, COAST]))
def test_friction_and_impacts_create_no_energy(data, name, duty):
    """Without a supply, the stored energy never grows, in no substep."""
    robot = ROBOTS[name]
    state = data.draw(moving(robot))
    energy = stored(robot, state)
    for _ in range(150):
        left = stored(robot, push(robot, state, 1, duty))
        assert left <= energy * (1 + 1e-12)
        energy = left


@given(
    data=st.data(),
    name=st.sampled_from(names()),
    duties=st.lists(st.integers(-100, 100), min_size=1, max_size=6),
)
def test_energy_comes_from_the_battery_only(data, name, duties):
    """What a driven motor stores is at most what the supply put in.

    (Kt/Ke) V times the charge, from the circuit's own balance.
    """
    robot = ROBOTS[name]
    state = data.draw(moving(robot))
    energy, supplied = stored(robot, state), 0.0
    for duty in duties:
        volts, ohms = (
            NOMINAL_V * duty / 100,
            robot.resistance + 2 * robot.source_resistance * (duty / 100) ** 2,
        )
        for _ in range(30):
            before = state.copy()
            push(robot, state, 1, duty)
            turned = state[ANGLE] - before[ANGLE]
            charge = (
                volts * SUBSTEP_S
                - robot.inductance * (state[CURRENT] - before[CURRENT])
                - robot.emf_constant * turned
            ) / ohms
            supplied += robot.torque_constant / robot.emf_constant * volts * charge
    # A microjoule for events within a substep, at which the charge is not exactly known.
    assert stored(robot, state) <= energy + supplied + 1e-6


def test_rolling_friction_is_the_wheels_share_of_the_weight(robot):
    table = data()["robot"]
    weight = table["mass"][0] / 2 * GRAVITY
    assert robot.rolling == pytest.approx(
        table["rolling_resistance"][0] * weight * table["wheel_radius"][0]
    )
