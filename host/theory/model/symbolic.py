"""The analytic model in symbols, from the same source as its numbers, and its derivatives as plain functions of floats."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import sympy

from host.theory.model.wheel import Array, Wheel, rates
from sim_motor.compiled import retold

STATE = sympy.symbols("x1 x2 phi omega", real=True)
CONSTANTS = sympy.symbols(" ".join(Wheel._fields), positive=True)
Floats = Callable[..., tuple[float, ...]]


@cache
def field() -> tuple[Any, ...]:
    """The four rates as expressions in STATE and CONSTANTS. Eq. dot_x_phi."""
    told = retold(rates, {"sin": sympy.sin, "cos": sympy.cos, "exp": sympy.exp})
    return tuple(sympy.nsimplify(rate) for rate in told(*STATE, *CONSTANTS))


def function(expressions: Sequence[Any]) -> Floats:
    """Expressions as a plain function of STATE and CONSTANTS that returns a tuple.

    It uses `math` only, so that numba compiles it.
    """
    made: Floats = sympy.lambdify(
        [*STATE, *CONSTANTS], tuple(expressions), modules="math", cse=True
    )
    return made


@cache
def jacobian() -> Floats:
    """The function of the 16 derivatives of the rates by the state, row by row."""
    return function([sympy.diff(rate, variable) for rate in field() for variable in STATE])


def jacobian_at(state: Sequence[float], wheel: Wheel) -> Array:
    """The Jacobian, (4, 4), in 1/s."""
    return np.array(jacobian()(*state, *wheel)).reshape(4, 4)


def jacobian_by_differences(state: Sequence[float], wheel: Wheel, step: float = 1e-5) -> Array:
    """The Jacobian, (4, 4), by central differences of the rates: a check, good to about step^2."""
    columns, constants = [], list(wheel)
    for index in range(4):
        ahead, behind = (list(state) for _ in range(2))
        ahead[index] += step
        behind[index] -= step
        columns.append(
            (np.array(rates(*ahead, *constants)) - np.array(rates(*behind, *constants)))
            / (2 * step)
        )
    return np.array(columns).T
