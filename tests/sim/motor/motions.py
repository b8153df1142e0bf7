"""Motions of the simulated motor, for its tests."""

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from sim_motor.arrays import scalars, tables
from sim_motor.compiled_motor import advance_in_place
from sim_motor.constants import load, names
from sim_motor.motor import CURRENT, SPEED, WHEEL_SPEED


def bare(constants):
    """The motor alone on a stiff supply: no wheel to speak of, no floor, no backlash."""
    return replace(constants, wheel_inertia=1e-9, rolling=0.0, backlash=0.0, source_resistance=0.0)


ROBOTS = {name: load(name) for name in names()}
ARRAYS = {
    constants: (tables([constants])[0], scalars([constants])[0])
    for robot in ROBOTS.values()
    for constants in (robot, bare(robot))
}
NOMINAL_V = 7.5


def at_rest(gap=0.0, angle=0.0):
    return np.array([angle, angle, 0.0, 0.0, gap, 0.0])


def push(constants, state, substeps, duty, battery_v=NOMINAL_V, torque=0.0):
    """Advance a state in place and return it."""
    advance_in_place(
        state,
        substeps,
        duty,
        battery_v,
        torque,
        *(ARRAYS.get(constants) or (tables([constants])[0], scalars([constants])[0])),
    )
    return state


def history(constants, state, substeps, duty, battery_v=NOMINAL_V):
    """The state after each substep."""
    return np.array([push(constants, state, 1, duty, battery_v).copy() for _ in range(substeps)])


def stored(constants, state):
    """Energy (J) of a wheel.

    The inductor's is scaled by Kt/Ke, as iron losses make the torque constant smaller than Ke.
    """
    coil = constants.inductance * constants.torque_constant / constants.emf_constant
    inertias = constants.motor_inertia, constants.wheel_inertia, coil
    return 0.5 * sum(
        weight * state[index] ** 2
        for weight, index in zip(inertias, (SPEED, WHEEL_SPEED, CURRENT), strict=True)
    )


@st.composite
def moving(draw, constants):
    """A state in motion: within the play, or touching and moving as one."""
    half = constants.backlash / 2
    speed, current = draw(st.floats(-20, 20)), draw(st.floats(-2, 2))
    gap = draw(st.sampled_from([-half, half]) | st.floats(-half, half))
    wheel_speed = draw(st.just(speed) | st.floats(-20, 20))
    return np.array([0.3, 0.3, speed, current, gap, wheel_speed])
