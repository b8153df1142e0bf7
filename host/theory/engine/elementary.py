"""sin, cos, exp and tanh without branches and without calls.

With them the compiler can do several wheels in one instruction. numba calls the C library instead,
one value at a time. Here they are within two units in the last place, for |x| < 1e6 (sin, cos) and
|x| < 700 (exp); tanh is within 2e-16 absolute.
"""

from __future__ import annotations

from math import factorial
from typing import Any

import numba.extending
from numba.core import types

from sim_motor.compiled import inner, njit

# Contracting a product and a sum to one instruction, or dividing by means of a reciprocal, changes
# the last bit only.
OPTIONS: Any = {"fastmath": {"contract", "arcp", "nsz"}, "error_model": "numpy"}

# numba gives intrinsics another signature than the one that they are written with.
_intrinsic: Any = numba.extending.intrinsic

# Added to a float, it rounds that to a whole number, which then stands in the sum's last bits.
_ROUNDER = 1.5 * 2.0**52
# pi/2 and ln 2 in two parts, the first with so few digits that its multiples are exact.
_QUARTER_HIGH, _QUARTER_LOW, _QUARTERS = (
    1.5707963267341256,
    6.077100506506192e-11,
    0.6366197723675814,
)
_LN2_HIGH, _LN2_LOW, _LOG2_E = 0.6931471803691238, 1.9082149292705877e-10, 1.4426950408889634
# Taylor's series, from the highest power down.
_EXP = tuple(1.0 / factorial(power) for power in range(12, -1, -1))
_SIN = tuple((-1.0) ** (power // 2) / factorial(power) for power in range(15, 0, -2))
_COS = tuple((-1.0) ** (power // 2) / factorial(power) for power in range(16, -1, -2))


@_intrinsic
def _bits(context: Any, value: Any) -> Any:
    """A float's bits as a whole number."""
    return types.int64(types.float64), lambda own, builder, _, given: builder.bitcast(
        given[0], own.get_value_type(types.int64)
    )


@_intrinsic
def _float(context: Any, bits: Any) -> Any:
    """The float with these bits."""
    return types.float64(types.int64), lambda own, builder, _, given: builder.bitcast(
        given[0], own.get_value_type(types.float64)
    )


def vectorised(function: Any) -> Any:
    """Compile a function for compiled ones, so that one instruction may do several wheels."""
    return inner(function, **OPTIONS)


def unlocked(function: Any) -> Any:
    """As `vectorised`, for `over_cores`."""
    return njit(function, nogil=True, **OPTIONS)


def inlined(function: Any) -> Any:
    """As `vectorised`, and compile the function into those that call it."""
    return inner(function, forceinline=True, **OPTIONS)


@inlined
def _polynomial(coefficients: Any, x: Any) -> Any:
    value = 0.0
    for coefficient in coefficients:
        value = value * x + coefficient
    return value


@inlined
def _chosen(condition: Any, one: Any, other: Any) -> Any:
    return one if condition else other


@inlined
def exp(x: Any) -> Any:
    """e to the power of x."""
    rounded = x * _LOG2_E + _ROUNDER
    whole = rounded - _ROUNDER
    rest = (x - whole * _LN2_HIGH) - whole * _LN2_LOW
    return _polynomial(_EXP, rest) * _float((_bits(rounded) + 1023) << 52)


@inlined
def _sin_of_quarters(rounded: Any, x: Any, more: int) -> Any:
    """sin(x + more pi/2); rounded: quarter turns in x."""
    whole = rounded - _ROUNDER
    rest = (x - whole * _QUARTER_HIGH) - whole * _QUARTER_LOW
    square = rest * rest
    sine, cosine = rest * _polynomial(_SIN, square), _polynomial(_COS, square)
    quarter = _bits(rounded) + more
    return _float(_bits(_chosen(quarter & 1, cosine, sine)) ^ ((quarter & 2) << 62))


@inlined
def sin(x: Any) -> Any:
    """The sine of x (rad)."""
    return _sin_of_quarters(x * _QUARTERS + _ROUNDER, x, 0)


@inlined
def cos(x: Any) -> Any:
    """The cosine of x (rad)."""
    return _sin_of_quarters(x * _QUARTERS + _ROUNDER, x, 1)


@inlined
def hyperbolic_tangent(x: Any) -> Any:
    """The hyperbolic tangent of x; beyond 20 it is 1."""
    square = exp(2.0 * min(max(x, -20.0), 20.0))
    return (square - 1.0) / (square + 1.0)


MATHEMATICS = {"sin": sin, "cos": cos, "exp": exp, "tanh": hyperbolic_tangent}
