"""How long wheels with noise stay on an attractor, and how that grows as the noise falls.

Escapes from a noisy attractor come at a constant rate, so that times are exponential; the mean time
then is exp(B / D^2) times a constant, with D the noise (Arrhenius's law; Freidlin and Wentzell's
quasi-potential is B / 2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.analysis.attractors import CHAOS, REST, ROLL, settle, watch
from host.theory.engine.noise import FAR, WELL, Noise
from host.theory.engine.noise import ROLL as ROLLING
from host.theory.model.turning import constant_velocity, turning
from host.theory.model.wheel import Array, Wheel
from host.util.intervals import CONFIDENCE

# How long wheels settle without noise, and are watched, s.
SETTLE_S, WATCH_S = 300.0, 40.0
# Wheels that rest are pushed by up to this, rad.
PUSH = 0.02
# A wheel that does not roll on for as many quarter turns' time has come to rest.
PATIENCE = 20.0


class Attractor(NamedTuple):
    """Where wheels with noise begin.

    Attributes:
        states: (4, wheels).
        way: what an escape is, WELL or ROLL of host.theory.engine.noise.
        patience_s: see `escapes` there, s.
    """

    states: Array
    way: int
    patience_s: float


def settled(wheel: Wheel, start: str, count: int, rng: np.random.Generator) -> Attractor:
    """Wheels on one attractor, at any phase of it.

    Args:
        wheel: The wheel.
        start: 'rest', from close to rest, or 'roll', from rolling forward.
        count: How many.
        rng: The source of chance.

    Returns:
        The attractor.

    Raises:
        WrongUse: The wheel does not stay there without noise, or is too stiff.
    """
    if start == "rest":
        phi, omega = rng.uniform(-PUSH, PUSH, count), 0.0
    else:
        phi, omega = rng.uniform(0.0, FAR, count), constant_velocity(wheel) or 1.0 / wheel.tau
    parameters = wheel.columns(count)
    begun = settle(turning(phi, np.full(count, omega), wheel), parameters, SETTLE_S)
    seen = watch(begun, parameters, WATCH_S)
    kinds = seen.kinds()
    if (kinds == CHAOS).any():
        raise WrongUse(
            f"without noise a wheel with k = {wheel.k:g} and tau = {wheel.tau:g} s is chaotic",
            "give a k or tau at which it rests, swings or rolls",
        )
    if start == "rest":
        if (kinds == ROLL).any():
            raise WrongUse(
                f"without noise a wheel with k = {wheel.k:g} and tau = {wheel.tau:g} s rolls away"
                " from rest",
                "write --start roll, or give a smaller k",
            )
        return Attractor(seen.states, WELL, np.inf)
    if (kinds != ROLL).any() or (seen.omega_mean < 0.0).any():
        raise WrongUse(
            f"a wheel with k = {wheel.k:g} and tau = {wheel.tau:g} s does not go on rolling",
            "write --start rest, or give a larger k" if (kinds == REST).any() else "give another k",
        )
    quarter_s = FAR / float(seen.omega_mean.mean())
    return Attractor(seen.states, ROLLING, PATIENCE * quarter_s)


class Stay(NamedTuple):
    """How long wheels stayed.

    Attributes:
        escapes: how many wheels escaped.
        mean_s: the mean time until an escape, s; None without one.
        low_s: the lower end of its 95 % interval, s.
        high_s: the upper end, s; None without an escape.
    """

    escapes: int
    mean_s: float | None
    low_s: float
    high_s: float | None


def stay(times_s: Array, ended: NDArray[np.bool_]) -> Stay:
    """The mean time until wheels escape, if they do so at a constant rate.

    It counts the time of wheels that did not escape, too, while they were followed.

    Args:
        times_s: When a wheel escaped, or how long it was followed, s, (wheels,).
        ended: Whether it escaped, (wheels,).

    Returns:
        The mean with its interval.
    """
    from scipy.special import gammaincinv

    count, total = int(ended.sum()), float(times_s.sum())
    rest = (1.0 - CONFIDENCE) / 2
    low = total / float(gammaincinv(count + 1, 1.0 - rest))
    if not count:
        return Stay(0, None, low, None)
    return Stay(count, total / count, low, total / float(gammaincinv(count, rest)))


class Arrhenius(NamedTuple):
    """The law ln T = ln T_0 + B / D^2, fitted.

    Attributes:
        barrier: B, in the unit of D^2.
        barrier_error: its standard error.
        prefactor_s: T_0, s.
        misfit: the mean square of the differences from the law, in units of their errors; near 1
            where the law holds.
    """

    barrier: float
    barrier_error: float
    prefactor_s: float
    misfit: float | None


def arrhenius(strengths: Array, stays: list[Stay]) -> Arrhenius | None:
    """Fit the law to mean times.

    Args:
        strengths: The noise D of each, (levels,).
        stays: The mean times; the error of ln T is 1 / sqrt(escapes).

    Returns:
        The fit; None with fewer than two mean times.
    """
    known = [
        (1.0 / strength**2, np.log(own.mean_s), own.escapes)
        for strength, own in zip(strengths.tolist(), stays, strict=True)
        if own.mean_s is not None
    ]
    if len(known) < 2:
        return None
    x, y, weights = np.array(known).T
    centre = np.average(x, weights=weights)
    spread = float(weights @ (x - centre) ** 2)
    slope = float(weights @ ((x - centre) * y)) / spread
    cut = float(np.average(y, weights=weights) - slope * centre)
    free = len(known) - 2
    misfit = float(weights @ (y - cut - slope * x) ** 2) / free if free else None
    return Arrhenius(slope, spread**-0.5, float(np.exp(cut)), misfit)


def levels(most: Noise, count: int, span: float) -> list[Noise]:
    """Strengths of noise, falling, at equal distances of 1 / D^2.

    Args:
        most: The greatest.
        count: How many.
        span: 1 / D^2 of the least, in units of that of the greatest.
    """
    parts = 1.0 / np.sqrt(np.linspace(1.0, span, count))
    return [Noise(most.torque * part, most.angle * part) for part in parts.tolist()]
