"""One wheel at a time, step by step, with derivatives of its states: for shooting and bisection.

The method is Runge and Kutta's of order 8 with fixed steps, as in host.theory.engine.ensemble,
which is for many wheels.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from host.theory.engine.ensemble import rate_per_s, too_stiff
from host.theory.engine.runge_kutta import STAGES, TABLEAU
from host.theory.model.laws import PAPER, Law, under
from host.theory.model.symbolic import derivatives, derivatives_by_constant
from host.theory.model.wheel import Array, Wheel, rates
from sim_motor.compiled import compiled, inner_jit, jit

# Steps per unit of a wheel's rate (see host.theory.engine.ensemble); at this, the error of a period
# is of the order of rounding.
FINENESS = 3.0
_LEAST_STEPS = 16
# A piece of a period that takes more is that of a stiff wheel, for which an explicit method is the
# wrong one.
MOST_STEPS = 40_000


def steps_for(seconds: float, wheel: Wheel, fineness: float = FINENESS) -> int:
    """How many steps this time takes.

    Raises:
        WrongUse: The wheel is too stiff.
    """
    needed = float(np.ceil(seconds * fineness * rate_per_s(np.array(wheel)[:, None])[0]))
    if not needed <= MOST_STEPS:
        raise too_stiff(seconds, np.array(wheel), needed)
    return max(_LEAST_STEPS, int(needed))


def run(own_rates: Any, states: Array, constants: Any, seconds: float, count: int) -> Array:
    """The states (4, columns) in the course of `count` steps, (count + 1, 4, columns).

    own_rates: one of `plain_under` or `varied`.
    """
    # The same kinds of arguments from all callers: each other kind would be compiled once more.
    own, numbers = np.array(states, order="C"), tuple(map(float, constants))
    path: Array = _running(own_rates, own.shape[1])(own, numbers, seconds, count)
    return path


@cache
def _running(own_rates: Any, columns: int) -> Any:
    """`run` with these rates and as many columns, compiled."""
    # The compiler knows the size, so that one instruction does several of the numbers.
    size = 4 * columns

    # Loops over numbers instead of slices: these take the compiler ten times as long.
    def run(at: Array, constants: Any, seconds: float, count: int) -> Array:
        step_s = seconds / count
        path, stages = np.empty((count + 1, 4, columns)), np.zeros((STAGES, 4, columns))
        # The same memory without rows.
        flat_path, flat_stages, flat_at = (
            path.reshape((count + 1, size)),
            stages.reshape((STAGES, size)),
            at.reshape(size),
        )
        total = np.empty(size)
        for index in range(count + 1):
            for i in range(size):
                flat_path[index, i] = flat_at[i]
            for stage in range(1, STAGES + 1):
                own_rates(at, constants, stages[stage - 1])
                for i in range(size):
                    total[i] = 0.0
                # Four at a time; where there are less, the others' factors are 0.
                for j in range(0, stage, 4):
                    f0, f1, f2, f3 = (
                        TABLEAU[stage, j],
                        TABLEAU[stage, j + 1],
                        TABLEAU[stage, j + 2],
                        TABLEAU[stage, j + 3],
                    )
                    for i in range(size):
                        total[i] = (
                            total[i]
                            + f0 * flat_stages[j, i]
                            + f1 * flat_stages[j + 1, i]
                            + f2 * flat_stages[j + 2, i]
                            + f3 * flat_stages[j + 3, i]
                        )
                for i in range(size):
                    flat_at[i] = flat_path[index, i] + step_s * total[i]
        return path

    return jit(run)


@cache
def plain_under(law: Law) -> Any:
    """The compiled rates of a state alone, (4, 1)."""
    of_state: Any = compiled(under(law, rates))

    def plain(states: Array, constants: Any, out: Array) -> None:
        out[0, 0], out[1, 0], out[2, 0], out[3, 0] = of_state(
            states[0, 0], states[1, 0], states[2, 0], states[3, 0], *constants
        )

    return inner_jit(plain)


# The paper's.
plain = plain_under(PAPER)


@cache
def varied(followed: int, law: Law = PAPER) -> Any:
    """The compiled rates of a state and of its derivatives, (4, 1 + 4 + 1).

    The derivatives are by the initial state, and by the wheel's constant of number `followed`.
    """
    of_state: Any = compiled(under(law, rates))
    jacobian: Any = compiled(derivatives(1, law))
    by_constant: Any = compiled(derivatives_by_constant(followed, law))

    def own_rates(states: Array, constants: Any, out: Array) -> None:
        x1, x2, phi, omega = states[0, 0], states[1, 0], states[2, 0], states[3, 0]
        out[0, 0], out[1, 0], out[2, 0], out[3, 0] = of_state(x1, x2, phi, omega, *constants)
        m = jacobian(x1, x2, phi, omega, *constants)
        for column in range(1, 6):
            u, v, w, z = states[0, column], states[1, column], states[2, column], states[3, column]
            out[0, column] = m[0] * u + m[1] * v + m[2] * w + m[3] * z
            out[1, column] = m[4] * u + m[5] * v + m[6] * w + m[7] * z
            out[2, column] = m[8] * u + m[9] * v + m[10] * w + m[11] * z
            out[3, column] = m[12] * u + m[13] * v + m[14] * w + m[15] * z
        direct = by_constant(x1, x2, phi, omega, *constants)
        out[0, 5] += direct[0]
        out[1, 5] += direct[1]
        out[2, 5] += direct[2]
        out[3, 5] += direct[3]

    return inner_jit(own_rates)
