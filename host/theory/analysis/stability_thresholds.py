"""Where in k a wheel's rest loses its stability, and where swinging turns into rolling and rolling back: sampled, or continuous.

Rest is a fixpoint of the sampled wheel's map; in a Neimark-Sacker bifurcation, the twin of the
flow's Hopf, two of its multipliers leave the unit circle. Swinging and rolling are followed from k
to k by what wheels do.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq

from host.theory.engine import sampled
from host.theory.engine.kicked import Model
from host.theory.engine.sampled import Clock
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, resting

# Times a wheel's own k, between which its rest is watched.
_SPAN = np.geomspace(1e-5, 1e5, 401)
# So many values of k at once share an interval out, down to this part of k.
SECTIONS, CLOSE = 7, 1e-8
_QUARTER = pi / 2
# Nearly as far as the saddle at pi/4: a swing that is too large shrinks faster than a small one
# grows.
_PUSH_RAD = 0.7


def multipliers(wheel: Wheel, clock: Clock) -> Any:
    """The eigenvalues of a tick's Jacobian at rest, (5,), complex; one is 0 without latency."""
    matrix: Any = sampled.jacobian(sampled.at_rest(), wheel, clock)
    return np.linalg.eigvals(matrix)


def leading(wheel: Wheel, clock: Clock) -> complex:
    """The largest multiplier of those that can leave the unit circle, 0 if there is none.

    Of a pair the one that turns forward.

    A positive one stays within: at 1 the pull k (a/2 - x_t(1)) of the rods would have to vanish.
    """
    able = [
        complex(value)
        for value in multipliers(wheel, clock)
        if abs(value.imag) > 1e-9 or value.real < 0.0
    ]
    found = max(able, key=abs, default=0j)
    return complex(found.real, abs(found.imag))


def critical_k(wheel: Wheel, clock: Clock) -> float | None:
    """The least k at which rest loses its stability, to 1e-12 of it.

    0 if it is unstable however small k is, None if it is stable for every k, or the tick so long
    that the potentials run away.
    """

    def growth(k: float) -> float:
        return abs(leading(wheel._replace(k=k), clock)) - 1.0

    if sampled.overshoots(wheel.a, wheel.tau_s, clock):
        return None
    stiffness = wheel.friction / wheel.tau_s + wheel.inertia / wheel.tau_s**2
    below = 0.0
    for k in map(float, stiffness * _SPAN):
        if growth(k) > 1e-13:
            return float(brentq(growth, below, k, xtol=1e-15, rtol=1e-13)) if below else 0.0
        below = k
    return None


def rolling_ends(
    model: Model, wheel: Wheel, high: float, low: float, seconds: float
) -> float | None:
    """Below which k a wheel that rolls stops rolling, followed from `high` down to `low`.

    None if no such change is seen.

    A wheel that still covers three quarter turns in the last half of `seconds` rolls.
    """
    fast = model.begun(resting(np.zeros(1)))
    fast[OMEGA] = 2 * sqrt(high * (1 + wheel.a / 2) / wheel.inertia)
    return _narrowed(
        model,
        fast,
        wheel,
        high,
        low,
        seconds,
        lambda before, after: np.abs(after[PHI] - before[PHI]) > 3 * _QUARTER,
    )


def swinging_ends(
    model: Model, wheel: Wheel, low: float, high: float, seconds: float
) -> float | None:
    """Above which k a wheel that rests, or swings around a rest, no longer does.

    Followed from `low` up to `high`.

    None if no such change is seen, or no swinging at `low`. There a wheel is pushed aside.
    """
    pushed = model.begun(resting(np.full(1, _PUSH_RAD)))
    return _narrowed(
        model,
        pushed,
        wheel,
        low,
        high,
        seconds,
        lambda before, after: np.abs(after[PHI] - before[PHI]) < _QUARTER,
    )


def _narrowed(
    model: Model,
    state: Array,
    wheel: Wheel,
    begin: float,
    end: float,
    seconds: float,
    lasts: Callable[[Array, Array], Any],
) -> float | None:
    """The k between `begin`, where a motion is, and `end`, where it is not, at which it ceases.

    To CLOSE, in ever smaller steps.
    """
    tried, reached, ceased = np.array([begin]), None, False
    while abs(end - begin) > CLOSE * abs(begin):
        parameters = wheel.columns(len(tried))
        parameters[list(Wheel._fields).index("k")] = tried
        before = model.averages(
            np.repeat(state, len(tried), axis=1), parameters, seconds / 2
        ).states
        after = model.averages(before, parameters, seconds / 2).states
        lasting = [*lasts(before, after), False]
        count = lasting.index(False)
        if count:
            begin = reached = float(tried[count - 1])
            state = after[:, count - 1 : count]
        elif reached is None:
            return None
        if count < len(tried):
            end, ceased = float(tried[count]), True
        tried = np.linspace(begin, end, SECTIONS + 2)[1:-1]
    return reached if ceased else None
