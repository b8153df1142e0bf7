"""Runge and Kutta's method of order 8 with fixed steps, for many systems side by side in memory."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import DOP853

from host.theory.engine.elementary import unlocked, vectorised
from host.theory.model.wheel import Array

# The tableau of Hairer, Norsett and Wanner's DOP853, without its error estimate; the last row is
# the step's own.
TABLEAU = np.vstack([DOP853.A, DOP853.B]).astype(np.float64)
STAGES = len(DOP853.A)
# Half of the tableau is zeros; of the others, one pass over the memory adds four.
_ROWS = [[(j, factor) for j, factor in enumerate(row) if factor != 0.0] for row in TABLEAU.tolist()]
_FIRST = np.cumsum([0, *(-(-len(row) // 4) for row in _ROWS)])
_PASSES = [(row[i : i + 4] + 3 * [(0, 0.0)])[:4] for row in _ROWS for i in range(0, len(row), 4)]
_WHICH, _FACTORS = (
    np.array([[term[part] for term in terms] for terms in _PASSES]) for part in range(2)
)


@vectorised
def _begin(to: Array, base: Array, step_s: float, turn: int, rates: Array) -> None:
    """`to` becomes `base` and what a pass adds.

    They must not be the same array, or the compiler would not use vector units.
    """
    f0, f1, f2, f3 = (
        step_s * _FACTORS[turn, 0],
        step_s * _FACTORS[turn, 1],
        step_s * _FACTORS[turn, 2],
        step_s * _FACTORS[turn, 3],
    )
    j0, j1, j2, j3 = _WHICH[turn, 0], _WHICH[turn, 1], _WHICH[turn, 2], _WHICH[turn, 3]
    for i in range(len(to)):
        to[i] = base[i] + (
            f0 * rates[j0, i] + f1 * rates[j1, i] + f2 * rates[j2, i] + f3 * rates[j3, i]
        )


@vectorised
def _add(to: Array, step_s: float, turn: int, rates: Array) -> None:
    """The same in place."""
    f0, f1, f2, f3 = (
        step_s * _FACTORS[turn, 0],
        step_s * _FACTORS[turn, 1],
        step_s * _FACTORS[turn, 2],
        step_s * _FACTORS[turn, 3],
    )
    j0, j1, j2, j3 = _WHICH[turn, 0], _WHICH[turn, 1], _WHICH[turn, 2], _WHICH[turn, 3]
    for i in range(len(to)):
        to[i] += f0 * rates[j0, i] + f1 * rates[j1, i] + f2 * rates[j2, i] + f3 * rates[j3, i]


@cache
def stepping(rates_of: Any) -> Any:
    """The compiled function that takes `count` steps of step_s with these rates.

    It changes states, (rows, systems), in place; rates_of(states, parameters, out) gives their
    rates. What rounding takes from a step is given to the next (Kahan's summation), as an angle
    grows large by small steps.
    """

    def steps(states: Array, parameters: Array, step_s: float, count: int) -> None:
        rates, at, lost = (
            np.zeros((STAGES, *states.shape)),
            np.empty_like(states),
            np.zeros(states.size),
        )
        # The same memory without rows, for the longest loops.
        flat_rates, flat_at, flat_states = (
            rates.reshape((STAGES, states.size)),
            at.reshape(states.size),
            states.reshape(states.size),
        )
        for _ in range(count):
            rates_of(states, parameters, rates[0])
            for stage in range(1, STAGES):
                _begin(flat_at, flat_states, step_s, _FIRST[stage], flat_rates)
                for turn in range(_FIRST[stage] + 1, _FIRST[stage + 1]):
                    _add(flat_at, step_s, turn, flat_rates)
                rates_of(at, parameters, rates[stage])
            for turn in range(_FIRST[STAGES], _FIRST[STAGES + 1]):
                _add(lost, step_s, turn, flat_rates)
            for i in range(len(lost)):
                before = flat_states[i]
                flat_states[i] = before + lost[i]
                lost[i] -= flat_states[i] - before

    return unlocked(steps)
