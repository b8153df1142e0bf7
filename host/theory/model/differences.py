"""Derivatives of the rates by central differences of order 8, for equations without symbols.

`driven` and its kin are plain functions that call `rates`, so that host.theory.model.laws gives
them the equations of any law, and numba compiles them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt
from typing import Any

import numpy as np

from host.theory.model.wheel import Array, rates

# The weights of values 1 to 4 steps to either side in the first derivative.
_WEIGHTS = _W1, _W2, _W3, _W4 = 4 / 5, -1 / 5, 4 / 105, -1 / 280
# The step, in units of the state. Rounding and the formula then both err by about 1e-12.
STEP = 0.01
# A wider one for the second and third derivatives, in which rounding counts more.
WIDE = 0.04


def driven(
    x1: Any, x2: Any, phi: Any, omega: Any, v1: Any, v2: Any, v3: Any, v4: Any,
    a: Any, tau_s: Any, k: Any, inertia: Any, friction: Any, dry_friction: Any,
    bounded: Any, rods: Any, own: Any,
) -> Any:  # fmt: skip
    """The Jacobian's product with the vector (v1, v2, v3, v4), not 0, four floats."""
    size = sqrt(v1 * v1 + v2 * v2 + v3 * v3 + v4 * v4)
    step = STEP / size
    s1 = s2 = s3 = s4 = 0.0
    for distance, weight in ((1.0, _W1), (2.0, _W2), (3.0, _W3), (4.0, _W4)):
        d = distance * step
        p1, p2, p3, p4 = rates(
            x1 + d * v1, x2 + d * v2, phi + d * v3, omega + d * v4,
            a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
        )  # fmt: skip
        m1, m2, m3, m4 = rates(
            x1 - d * v1, x2 - d * v2, phi - d * v3, omega - d * v4,
            a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
        )  # fmt: skip
        s1 += weight * (p1 - m1)
        s2 += weight * (p2 - m2)
        s3 += weight * (p3 - m3)
        s4 += weight * (p4 - m4)
    return s1 / step, s2 / step, s3 / step, s4 / step


def jacobian(
    x1: Any, x2: Any, phi: Any, omega: Any,
    a: Any, tau_s: Any, k: Any, inertia: Any, friction: Any, dry_friction: Any,
    bounded: Any, rods: Any, own: Any,
) -> Any:  # fmt: skip
    """The 16 derivatives of the rates by the state, the last variable fastest."""
    a1, a2, a3, a4 = driven(
        x1, x2, phi, omega, 1.0, 0.0, 0.0, 0.0,
        a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
    )  # fmt: skip
    b1, b2, b3, b4 = driven(
        x1, x2, phi, omega, 0.0, 1.0, 0.0, 0.0,
        a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
    )  # fmt: skip
    c1, c2, c3, c4 = driven(
        x1, x2, phi, omega, 0.0, 0.0, 1.0, 0.0,
        a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
    )  # fmt: skip
    d1, d2, d3, d4 = driven(
        x1, x2, phi, omega, 0.0, 0.0, 0.0, 1.0,
        a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
    )  # fmt: skip
    return a1, b1, c1, d1, a2, b2, c2, d2, a3, b3, c3, d3, a4, b4, c4, d4


def rates_and_driven(
    x1: Any, x2: Any, phi: Any, omega: Any, v1: Any, v2: Any, v3: Any, v4: Any,
    a: Any, tau_s: Any, k: Any, inertia: Any, friction: Any, dry_friction: Any,
    bounded: Any, rods: Any, own: Any,
) -> Any:  # fmt: skip
    """The rates, and the Jacobian's product with a vector, eight floats."""
    r1, r2, r3, r4 = rates(
        x1, x2, phi, omega, a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own
    )
    s1, s2, s3, s4 = driven(
        x1, x2, phi, omega, v1, v2, v3, v4,
        a, tau_s, k, inertia, friction, dry_friction, bounded, rods, own,
    )  # fmt: skip
    return r1, r2, r3, r4, s1, s2, s3, s4


# Which constant is varied, in the order of Wheel.
_WHICH = (0, 0, 1, 0, 0, 0)


def by_constant(
    x1: Any, x2: Any, phi: Any, omega: Any,
    a: Any, tau_s: Any, k: Any, inertia: Any, friction: Any, dry_friction: Any,
    bounded: Any, rods: Any, own: Any,
) -> Any:  # fmt: skip
    """The derivatives of the four rates by one of the first six constants, _WHICH."""
    c1, c2, c3, c4, c5, c6 = _WHICH
    size = c1 * a + c2 * tau_s + c3 * k + c4 * inertia + c5 * friction + c6 * dry_friction
    step = STEP * size if size > 0.0 else STEP
    s1 = s2 = s3 = s4 = 0.0
    for distance, weight in (
        (1.0, _W1), (2.0, _W2), (3.0, _W3), (4.0, _W4),
        (-1.0, -_W1), (-2.0, -_W2), (-3.0, -_W3), (-4.0, -_W4),
    ):  # fmt: skip
        d = distance * step
        r1, r2, r3, r4 = rates(
            x1, x2, phi, omega,
            a + c1 * d, tau_s + c2 * d, k + c3 * d,
            inertia + c4 * d, friction + c5 * d, dry_friction + c6 * d,
            bounded, rods, own,
        )  # fmt: skip
        s1 += weight * r1
        s2 += weight * r2
        s3 += weight * r3
        s4 += weight * r4
    return s1 / step, s2 / step, s3 / step, s4 / step


def which(number: int) -> dict[str, tuple[int, ...]]:
    """The value of _WHICH by its name for the constant of this number."""
    return {"_WHICH": tuple(int(other == number) for other in range(6))}


def of_order(order: int, own_rates: Callable[..., Any]) -> Callable[..., tuple[float, ...]]:
    """All derivatives of this order of some rates by the state.

    Args:
        order: 1, 2 or 3.
        own_rates: A function as `rates`, of arrays.

    Returns:
        A function of the state and the constants. In its result the rate counts first, and the last
        variable runs fastest.
    """
    step = STEP if order == 1 else WIDE
    stencil = [(sign * n, sign * w) for n, w in enumerate(_WEIGHTS, 1) for sign in (1, -1)]

    def derivative(state: Array, constants: Sequence[float]) -> tuple[float, ...]:
        def nested(at: Array, left: int) -> Array:
            if not left:
                return np.array(own_rates(*at.tolist(), *constants))
            columns = [
                sum(weight * nested(at + n * step * unit, left - 1) for n, weight in stencil) / step
                for unit in np.eye(4)
            ]
            # The variable of the outermost derivative comes first, after the rate.
            return np.stack(columns, axis=1)

        return tuple(nested(state, order).ravel().tolist())

    return lambda *arguments: derivative(np.array(arguments[:4]), arguments[4:])
