"""Wheels with white noise on the torque and on the angle, by stochastic differential equations.

    dphi   = omega dt + D_phi dW_1
    domega = (torque - friction) / I dt + D_M / I dW_2

The method is Euler and Maruyama's with Heun's corrector: without it a step would take from the
friction. Each wheel has random numbers of its own (SplitMix64 by Steele, Lea and Flood, OOPSLA
2014), so that the same seeds give the same numbers on any number of cores.
"""

from __future__ import annotations

from functools import cache
from math import log, pi, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.engine.elementary import MATHEMATICS, cos, inlined, sin
from host.theory.engine.ensemble import rate_per_s, too_stiff
from host.theory.engine.sliding import DRY
from host.theory.model.laws import Law, law_of, under
from host.theory.model.wheel import Array, rates
from sim_motor.compiled import over_cores, unlocked_jit

# Steps per unit of a wheel's rate (host.theory.engine.ensemble).
FINENESS = 10.0
# More take too long.
MOST_STEPS = 200_000_000
# When a wheel has escaped: never, from its well, or from rolling forward.
NEVER, WELL, ROLL = range(3)
# How far (rad) a wheel goes out of its well, or back from where it has rolled to.
FAR = pi / 2

# As an array: numba keeps its numbers whole and without a sign.
_SPLITMIX = np.array(
    [0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 30, 27, 31, 11], dtype=np.uint64
)
_PART = 2.0**-53


class Noise(NamedTuple):
    """White noise.

    Attributes:
        torque: D_M; the noise's angular momentum after a time t has the standard deviation
            D_M sqrt(t). In sqrt(s), as torques have no unit.
        angle: D_phi; likewise of the angle, rad/sqrt(s).
    """

    torque: float = 0.0
    angle: float = 0.0


class Escapes(NamedTuple):
    """When wheels escaped.

    Attributes:
        time_s: when, or how long it was followed without, s, (wheels,).
        ended: whether it escaped, (wheels,).
        states: the last states, (4, wheels).
    """

    time_s: Array
    ended: NDArray[np.bool_]
    states: Array


@inlined
def _uniform(seed: Any) -> Any:
    """The next seed, and a number between 0 and 1."""
    seed += _SPLITMIX[0]
    z = (seed ^ (seed >> _SPLITMIX[3])) * _SPLITMIX[1]
    z = (z ^ (z >> _SPLITMIX[4])) * _SPLITMIX[2]
    z ^= z >> _SPLITMIX[5]
    return seed, (float(z >> _SPLITMIX[6]) + 0.5) * _PART


@cache
def _wandering(law: Law) -> Any:
    """The compiled function that follows wheels until they escape, in place."""
    of_state: Any = under(law, rates, MATHEMATICS, inlined)

    def wander(
        states: Array, parameters: Array, noise: Any, seeds: Any, step_s: float, count: int,
        way: int, patience: int, times: Array, ended: Any, first: int, every: int,
    ) -> None:  # fmt: skip
        """One of `every` wheels, from the first on."""
        torque, angle = noise
        for i in range(first, states.shape[1], every):
            x1, x2, phi, omega = states[0, i], states[1, i], states[2, i], states[3, i]
            a, tau, k = parameters[0, i], parameters[1, i], parameters[2, i]
            inertia, f, dry = parameters[3, i], parameters[4, i], parameters[5, i]
            bounded, rods, own = parameters[6, i], parameters[7, i], parameters[8, i]
            seed, begin, best, best_at = seeds[i], FAR * round(phi / FAR), phi, 0
            push, turn = torque * sqrt(step_s) / inertia, angle * sqrt(step_s)
            for step in range(1, count + 1):
                seed, one = _uniform(seed)
                seed, other = _uniform(seed)
                size, direction = sqrt(-2.0 * log(one)), 2.0 * pi * other
                turned, pushed = turn * size * cos(direction), push * size * sin(direction)
                r1, r2, r3, r4 = of_state(
                    x1, x2, phi, omega, a, tau, k, inertia, f, dry, bounded, rods, own
                )
                s1, s2, s3, s4 = of_state(
                    x1 + step_s * r1,
                    x2 + step_s * r2,
                    phi + step_s * r3 + turned,
                    omega + step_s * r4 + pushed,
                    a, tau, k, inertia, f, dry, bounded, rods, own,
                )  # fmt: skip
                x1 += step_s / 2 * (r1 + s1)
                x2 += step_s / 2 * (r2 + s2)
                phi += step_s / 2 * (r3 + s3) + turned
                omega += step_s / 2 * (r4 + s4) + pushed
                if way == WELL and abs(phi - begin) > FAR:
                    times[i], ended[i] = step * step_s, True
                    break
                if way == ROLL:
                    if phi > best:
                        best, best_at = phi, step
                    elif phi < best - FAR or step - best_at > patience:
                        times[i], ended[i] = best_at * step_s, True
                        break
            states[0, i], states[1, i], states[2, i], states[3, i] = x1, x2, phi, omega

    return unlocked_jit(wander)


def escapes(
    states: Array,
    parameters: Array,
    noise: Noise,
    seconds: float,
    seeds: NDArray[np.uint64],
    way: int = NEVER,
    fineness: float = FINENESS,
    patience_s: float = np.inf,
) -> Escapes:
    """Follow wheels with noise until they escape.

    Args:
        states: Where they start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        noise: The noise on all of them.
        seconds: For how long at most, s.
        seeds: The random seed of each, (wheels,).
        way: What an escape is. NEVER; WELL, farther than FAR from the nearest multiple of it; ROLL,
            back by FAR from the farthest angle, or no farther angle for some time.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).
        patience_s: That time, s. The wheel has escaped when it was at its farthest angle.

    Returns:
        The times.

    Raises:
        WrongUse: A wheel is too stiff, or has dry friction.
    """
    count = require_followed(parameters, seconds, fineness)
    step_s = seconds / count
    found, own = np.array(states, dtype=np.float64, order="C"), np.ascontiguousarray(parameters)
    times = np.full(states.shape[1], float(seconds))
    ended = np.zeros(states.shape[1], dtype=np.bool_)
    patience = int(min(patience_s / step_s, count))
    wander = _wandering(law_of(parameters))
    given = found, own, tuple(noise), seeds, step_s, count, way, patience, times, ended
    over_cores(lambda core, cores: wander(*given, core, cores), len(times))
    return Escapes(times, ended, found)


def require_followed(parameters: Array, seconds: float, fineness: float) -> int:
    """How many steps these wheels, (constants, wheels), take in some seconds.

    Raises:
        WrongUse: A wheel is too stiff, or has dry friction.
    """
    if parameters[DRY].any():
        raise WrongUse(
            "noise on a wheel with dry friction is not computed", "leave dry friction at 0"
        )
    needed = seconds * fineness * rate_per_s(parameters)
    worst = int(np.argmax(needed))
    if not needed[worst] <= MOST_STEPS:
        raise too_stiff(seconds, parameters[:, worst], needed[worst])
    return int(np.ceil(needed[worst]))


def seeds_of(rng: np.random.Generator, count: int) -> NDArray[np.uint64]:
    """Random seeds for wheels, (count,)."""
    return rng.integers(2**64, size=count, dtype=np.uint64)
