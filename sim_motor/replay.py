"""What motors do under duty cycles that a robot has logged."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim_motor.arrays import Array, scalars, tables
from sim_motor.compiled import over_cores, unlocked_jit
from sim_motor.compiled_motor import advance, substep_at, substep_from
from sim_motor.constants import Constants
from sim_motor.motor import ANGLE


def replay(
    states: Array,
    times: Array,
    duties: NDArray[np.int64],
    until_s: float,
    motors: Sequence[Constants],
    volts: Array,
) -> tuple[Array, Array]:
    """Drive motors by logged duty cycles, each from a state of its own.

    Args:
        states: Where they begin, in the first tick, as in sim_motor.motor, (motors, 6).
        times: When ticks began, s, (ticks,).
        duties: The duty cycles that were written in each, %, (motors, ticks). The first ones are
            taken to act from the beginning.
        until_s: When to end, s; in the last tick or after it.
        motors: Motor number i has motors[i % len(motors)]. The latency is that of the first.
        volts: Open-circuit voltage of the battery, V, (motors,).

    Returns:
        The states in the end, (motors, 6), and the motors' angles in each tick, rad, (motors,
        ticks).
    """
    ends = states.copy()
    angles = np.empty((len(states), len(times)))
    given = (
        ends,
        angles,
        times,
        duties,
        until_s,
        motors[0].latency_s,
        tables(motors),
        scalars(motors),
        volts,
    )
    over_cores(lambda core, cores: _replay(*given, core, cores), len(ends))
    return ends, angles


@unlocked_jit
def _replay(
    states: Array,
    angles: Array,
    times: Array,
    duties: NDArray[np.int64],
    until_s: float,
    latency_s: float,
    tables: Array,
    scalars: Array,
    volts: Array,
    first: int,
    every: int,
) -> None:
    """One of `every` motors, from the first on."""
    for row in range(first, len(states), every):
        start = states[row]
        state = (start[0], start[1], start[2], start[3], start[4], start[5])
        table, constants = tables[row % len(tables)], scalars[row % len(tables)]
        substep = turn = substep_at(times[0])
        duty, next_duty = duties[row, 0], duties[row, 0]
        for tick in range(len(times) + 1):
            present = substep_at(times[tick] if tick < len(times) else until_s)
            turn = min(turn, present)
            state = advance(turn - substep, duty, volts[row], 0.0, *state, table, constants)
            state = advance(present - turn, next_duty, volts[row], 0.0, *state, table, constants)
            substep, duty = present, next_duty
            if tick < len(times):
                angles[row, tick] = state[ANGLE]
                turn, next_duty = substep_from(times[tick] + latency_s), duties[row, tick]
        # To check the shape of a whole row takes the compiler as long as all else.
        for index in range(len(state)):
            states[row, index] = state[index]
