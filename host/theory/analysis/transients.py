"""Chaotic transients: how long wheels switch before they roll, and where chaos begins to last.

In a boundary crisis (Grebogi, Ott, Yorke, Physica D 7, 1983) the chaotic attractor touches the
boundary of its basin. On one side of it chaos is a transient: lives are exponentially distributed,
and their mean grows as a power of the distance, without bound.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from host.theory.analysis.attractors import CHAOS, random_starts, settle, watch
from host.theory.model.wheel import OMEGA, Array, Wheel

# A wheel that has not turned round for QUIET_S (s) has stopped switching. Close to the boundary of
# the basin, a chaotic wheel may roll for a minute. Reversals are noticed to within LOOK_S.
QUIET_S, LOOK_S = 200.0, 1.0
# The search for the least k with chaos: SEARCH_STEPS values of k, then again around the first with
# chaos; SEARCH_WHEELS wheels at each, followed for SEARCH_S (s).
SEARCH_STEPS, SEARCH_WHEELS, SEARCH_S = 64, 8, 200.0
# At first (s) a wheel may be on its way to the chaotic set.
ENTRY_S = 20.0
FEWEST = 20
RESAMPLES = 200


class Lives(NamedTuple):
    """How long wheels switched.

    Attributes:
        life_s: when each wheel turned round for the last time, s, (wheels,).
        ended: whether it was followed for QUIET_S after that, (wheels,).
    """

    life_s: Array
    ended: NDArray[np.bool_]


def lives(states: Array, parameters: Array, most_s: float, fineness: float) -> Lives:
    """Follow wheels until all have stopped switching.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        most_s: How long to follow them at most, s.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Returns:
        Their lives, to LOOK_S.

    Raises:
        WrongUse: Wheels are too stiff to be followed.
    """
    last, sign, now = np.zeros(states.shape[1]), np.sign(states[OMEGA]), 0.0
    while now < most_s and now - last.max() <= QUIET_S:
        states = settle(states, parameters, LOOK_S, fineness)
        now += LOOK_S
        turned = np.sign(states[OMEGA]) != sign
        last[turned], sign = now, np.sign(states[OMEGA])
    return Lives(last, now - last > QUIET_S)


@cache
def least_chaotic_k(wheel: Wheel, most_k: float, fineness: float) -> float | None:
    """The least k at which half of the wheels are still chaotic after SEARCH_S.

    Args:
        wheel: The wheel; its own k does not matter.
        most_k: The greatest k to try.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Returns:
        The k; None if there is none.

    Raises:
        WrongUse: Wheels are too stiff to be followed.
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
    """The lives of wheels at one k, beyond ENTRY_S.

    Attributes:
        k: the spring constant.
        wheels: how many lived longer than ENTRY_S.
        ended: how many of them stopped switching.
        mean_s: the mean life, s, if ends come by chance at a constant rate; the lives that did not
            end count too. None if none ended.
        likeness: probability that a sample of exponentially distributed lives fits worse
            (Anderson and Darling); None if some did not end, or they are too few.
    """

    k: float
    wheels: int
    ended: int
    mean_s: float | None
    likeness: float | None


def sample(k: float, life_s: Array, ended: NDArray[np.bool_]) -> Sample:
    """The lives of wheels at one k.

    Args:
        k: The spring constant.
        life_s: When each wheel turned round for the last time, s, (wheels,).
        ended: Whether it has stopped switching, (wheels,).

    Returns:
        Mean and likeness of the lives.
    """
    late = life_s > ENTRY_S
    own, over = life_s[late] - ENTRY_S, ended[late]
    mean = float(own.sum() / over.sum()) if over.any() else None
    likeness = None
    if over.all() and len(own) >= FEWEST:
        from scipy.stats import expon, goodness_of_fit

        rng = np.random.default_rng(0)
        fitted = goodness_of_fit(
            expon, own, known_params={"loc": 0.0}, statistic="ad", n_mc_samples=RESAMPLES, rng=rng
        )
        likeness = float(fitted.pvalue)
    return Sample(k, len(own), int(over.sum()), mean, likeness)


class Crisis(NamedTuple):
    """The mean life near a crisis, factor (k - k')^-power at k', with 95 % intervals.

    Attributes:
        k: the spring constant of the crisis.
        k_interval: of k.
        power: the exponent of the law.
        power_interval: of the power.
        factor: s, for a distance of 1.
        misfit: rms deviation of the means, in standard errors. If it is above 1, the intervals are
            wider by it.
    """

    k: float
    k_interval: tuple[float, float]
    power: float
    power_interval: tuple[float, float]
    factor: float
    misfit: float

    def mean_s(self, k: Array) -> Array:
        """The mean life, s, at these k below the crisis."""
        return np.asarray(self.factor * (self.k - k) ** -self.power)


def crisis(samples: list[Sample]) -> Crisis | None:
    """Fit the law of a crisis.

    Args:
        samples: Lives at several k. Samples with fewer than FEWEST ends do not count.

    Returns:
        The law; None with fewer than four samples that count.
    """
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
    """(k of the crisis, power, logarithm of the factor), (3,), and the misfit.

    By least squares of the logarithm of the means, whose standard error is 1 / sqrt(ended).
    """
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
