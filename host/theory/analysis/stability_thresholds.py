"""Where in k rest loses its stability, and where swinging turns into rolling and back.

Rest is a fixpoint of the sampled wheel's map. In a Neimark-Sacker bifurcation, which corresponds to
the flow's Hopf bifurcation, two of its multipliers leave the unit circle. Swinging and rolling are
followed from k to k, in either model, by what wheels do.
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

# The values of k that are tried, in units of a wheel's stiffness.
_SPAN = np.geomspace(1e-5, 1e5, 401)
# Values of k that are tried at once inside an interval, until it is shorter than CLOSE (relative).
SECTIONS, CLOSE = 7, 1e-8
_QUARTER = pi / 2
# Almost as far as the saddle at pi/4: a swing that is too large shrinks faster than a small one
# grows.
_PUSH_RAD = 0.7


def multipliers(wheel: Wheel, clock: Clock) -> Any:
    """The multipliers of rest: eigenvalues of a tick's Jacobian, (5,), one 0 without latency."""
    matrix: Any = sampled.jacobian(sampled.at_rest(), wheel, clock)
    return np.linalg.eigvals(matrix)


def leading(wheel: Wheel, clock: Clock) -> complex:
    """The leading multiplier of rest among those that can leave the unit circle.

    A positive multiplier cannot: for it to be 1, the pull k (a/2 - x_t(1)) of the rods would have
    to vanish.

    Args:
        wheel: The wheel.
        clock: Tick and latency.

    Returns:
        The multiplier of greatest modulus, of a pair the one with positive imaginary part; 0 if
        none can leave.
    """
    able = [
        complex(value)
        for value in multipliers(wheel, clock)
        if abs(value.imag) > 1e-9 or value.real < 0.0
    ]
    found = max(able, key=abs, default=0j)
    return complex(found.real, abs(found.imag))


def critical_k(wheel: Wheel, clock: Clock) -> float | None:
    """The least k at which rest of the sampled wheel loses its stability.

    Args:
        wheel: The wheel; its own k does not matter.
        clock: Tick and latency.

    Returns:
        The k, to 1e-12 of it; 0 if rest is unstable for every k, None if it is stable for every k
        or if potentials diverge because the tick is too long for the neurons.
    """

    def growth(k: float) -> float:
        return abs(leading(wheel._replace(k=k), clock)) - 1.0

    if sampled.overshoots(wheel.a, wheel.tau, clock):
        return None
    stiffness = wheel.f / wheel.tau + wheel.I / wheel.tau**2
    below = 0.0
    for k in map(float, stiffness * _SPAN):
        if growth(k) > 1e-13:
            return float(brentq(growth, below, k, xtol=1e-15, rtol=1e-13)) if below else 0.0
        below = k
    return None


def rolling_ends(
    model: Model, wheel: Wheel, high: float, low: float, seconds: float
) -> float | None:
    """The k below which a wheel that rolls stops rolling.

    A wheel rolls if it covers three quarter turns in the second half of the time.

    Args:
        model: The continuous or the sampled model.
        wheel: The wheel; its own k does not matter.
        high: The k to start from.
        low: The k to go down to.
        seconds: How long to follow it at each k, s.

    Returns:
        The k, to 1e-8 of it; None if the wheel does not roll at `high`, or still rolls at `low`.

    Raises:
        WrongUse: The wheel cannot be followed.
    """
    fast = model.states_of(resting(np.zeros(1)))
    fast[OMEGA] = 2 * sqrt(high * (1 + wheel.a / 2) / wheel.I)
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
    """The k above which a wheel that rests, or swings around a rest, no longer does.

    A wheel swings if it covers less than a quarter turn in the second half of the time. At `low` it
    is pushed aside.

    Args:
        model: The continuous or the sampled model.
        wheel: The wheel; its own k does not matter.
        low: The k to start from.
        high: The k to go up to.
        seconds: How long to follow it at each k, s.

    Returns:
        The k, to 1e-8 of it; None if the wheel does not swing at `low`, or still swings at `high`.

    Raises:
        WrongUse: The wheel cannot be followed.
    """
    pushed = model.states_of(resting(np.full(1, _PUSH_RAD)))
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
    """The k between `begin`, where a motion lasts, and `end`, where it does not, at which it ends.

    `lasts` says it of the states after half and after the whole of the time. The interval is cut
    into SECTIONS + 1 until it is shorter than CLOSE; wheels start in the state at the last k.
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
