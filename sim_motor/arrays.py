"""Motors as arrays, for compiled code."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim_motor.compiled import compiled, jit
from sim_motor.constants import SUBSTEP_S, Constants
from sim_motor.exact_step import COAST, step_of

Array = NDArray[np.float64]

_step_of = compiled(step_of)


def tables(motors: Sequence[Constants]) -> Array:
    """The steps of motors, with the same bits as sim_motor.constants.Steps.

    Returns:
        (motors, alone or with wheel, |duty| in % or COAST, 14).

    Raises:
        ValueError: A motor is too fast for the step.
    """
    for motor in motors:
        motor.require_slow()
    out = np.empty((len(motors), 2, COAST + 1, 14))
    _fill(np.array([motor.circuit() for motor in motors]), out)
    return out


def scalars(motors: Sequence[Constants]) -> Array:
    """Constants.scalars of motors, (motors, 8)."""
    return np.array([motor.scalars() for motor in motors])


@jit
def _fill(circuits: Array, out: Array) -> None:
    for motor in range(len(circuits)):
        c = circuits[motor]
        circuit = (c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7])
        for wheel in range(2):
            for duty in range(COAST + 1):
                step = _step_of(wheel, duty, circuit, SUBSTEP_S)
                for place in range(14):
                    out[motor, wheel, duty, place] = step[place]
