"""Chaotic transients: how long wheels switch before they roll, and at which k chaos turns from a transient into an attractor.

In a boundary crisis (Grebogi, Ott, Yorke, Physica D 7, 1983) the chaotic attractor touches the edge
of its basin. On one side of it chaos is a transient whose lives are exponentially distributed, with
a mean that grows as a power of the distance and has no bound.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import expon, goodness_of_fit

from host.theory.analysis.attractors import CHAOS, random_starts, settle, watch
from host.theory.model.wheel import OMEGA, Array, Wheel

# A wheel that has not turned round for so long has stopped switching: near the edge of its basin,
# rolling may last for a minute and be no end. Reversals are noticed to within LOOK_S.
QUIET_S, LOOK_S = 200.0, 1.0
# The search for the least k with chaos: k in so many steps, then these again; of so many wheels
# half must be chaotic.
SEARCH_STEPS, SEARCH_WHEELS, SEARCH_S = 64, 8, 200.0
# Before, a wheel may be on its way to the chaotic set.
ENTRY_S = 20.0
FEWEST = 20
RESAMPLES = 200


class Lives(NamedTuple):
    """When each wheel turned round for the last time, s, and whether it was watched for QUIET_S after that, (wheels,)."""

    life_s: Array
    ended: NDArray[np.bool_]


def lives(states: Array, parameters: Array, most_s: float, fineness: float) -> Lives:
    """Follow wheels until all have stopped switching, at most for most_s."""
    last, sign, now = np.zeros(states.shape[1]), np.sign(states[OMEGA]), 0.0
    while now < most_s and now - last.max() <= QUIET_S:
        states = settle(states, parameters, LOOK_S, fineness)
        now += LOOK_S
        turned = np.sign(states[OMEGA]) != sign
        last[turned], sign = now, np.sign(states[OMEGA])
    return Lives(last, now - last > QUIET_S)


@cache
def least_chaotic_k(wheel: Wheel, most_k: float, fineness: float) -> float | None:
    """The least k, up to most_k, at which half of the wheels are still chaotic after SEARCH_S.

    None if there is none.
    """
    low, high = 0.0, most_k
    for _ in range(2):
        ks = np.linspace(low, high, SEARCH_STEPS + 1)[1:]
        parameters = wheel.columns(SEARCH_STEPS * SEARCH_WHEELS, k=np.repeat(ks, SEARCH_WHEELS))
        begin = random_starts(parameters.shape[1], np.random.default_rng(0))
        kinds = watch(
            settle(begin, parameters, SEARCH_S, fineness), parameters, SEARCH_S / 2, fineness
        ).kinds()
        found = np.flatnonzero(
            np.mean(kinds.reshape(SEARCH_STEPS, SEARCH_WHEELS) == CHAOS, axis=1) >= 0.5
        )
        if not len(found):
            return None
        step = ks[1] - ks[0]
        low, high = max(0.0, ks[found[0]] - 2 * step), ks[found[0]] + step
    return float(ks[found[0]])


class Sample(NamedTuple):
    """Lives of wheels at one k, beyond ENTRY_S.

    wheels: that lived so long. mean_s: if ends are a matter of chance only; lives that did not end
    count, too. likeness: the chance that so many exponentially distributed lives look less like it
    than these (Anderson and Darling), if all have ended.
    """

    k: float
    wheels: int
    ended: int
    mean_s: float | None
    likeness: float | None


def sample(k: float, life_s: Array, ended: NDArray[np.bool_]) -> Sample:
    """What the lives of wheels at this k come to."""
    late = life_s > ENTRY_S
    own, over = life_s[late] - ENTRY_S, ended[late]
    mean = float(own.sum() / over.sum()) if over.any() else None
    likeness = None
    if over.all() and len(own) >= FEWEST:
        rng = np.random.default_rng(0)
        fitted = goodness_of_fit(
            expon, own, known_params={"loc": 0.0}, statistic="ad", n_mc_samples=RESAMPLES, rng=rng
        )
        likeness = float(fitted.pvalue)
    return Sample(k, len(own), int(over.sum()), mean, likeness)


class Crisis(NamedTuple):
    """The law of the mean life: factor (k_crisis - k)^-power, with 95 % intervals.

    misfit: by how many standard errors (rms) the means are off. Where it is above 1, the intervals
    are wider by it.
    """

    k: float
    k_interval: tuple[float, float]
    power: float
    power_interval: tuple[float, float]
    factor: float
    misfit: float

    def mean_s(self, k: Array) -> Array:
        """The mean life at these k, below the crisis."""
        return np.asarray(self.factor * (self.k - k) ** -self.power)


def crisis(samples: list[Sample]) -> Crisis | None:
    """The power law through samples with enough ends. None of fewer than four of these."""
    fit = [sample for sample in samples if sample.ended >= FEWEST]
    if len(fit) < 4:
        return None
    ks = np.array([sample.k for sample in fit])
    means, ended = (
        np.array(values, dtype=float)
        for values in ([s.mean_s for s in fit], [s.ended for s in fit])
    )
    found, misfit = _fit(ks, means, ended)
    rng, widening = np.random.default_rng(0), max(1.0, misfit) ** 2
    again = np.array(
        [
            _fit(ks, rng.gamma(ended / widening, means / ended * widening), ended)[0]
            for _ in range(RESAMPLES)
        ]
    )
    low, high = np.quantile(again, (0.025, 0.975), axis=0)
    return Crisis(
        float(found[0]),
        (float(low[0]), float(high[0])),
        float(found[1]),
        (float(low[1]), float(high[1])),
        float(np.exp(found[2])),
        misfit,
    )


def _fit(ks: Array, means: Array, ended: Array) -> tuple[Array, float]:
    """(k of the crisis, power, logarithm of the factor) by least squares of the logarithm, whose standard error is 1 / sqrt(ended)."""
    last, width = ks.max(), np.ptp(ks)

    def misses(unknowns: Array) -> Array:
        return np.asarray(
            (np.log(means) + unknowns[1] * np.log(last + np.exp(unknowns[0]) - ks) - unknowns[2])
            * np.sqrt(ended)
        )

    found = least_squares(misses, (np.log(width / 10), 1.0, np.log(means[0])))
    return np.array([last + np.exp(found.x[0]), found.x[1], found.x[2]]), float(
        np.sqrt(2 * found.cost / max(1, len(ks) - 3))
    )
