"""Confidence intervals of rates and of measured values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt

import numpy as np
from numpy.typing import NDArray

CONFIDENCE = 0.95
RESAMPLES = 999
# So many standard deviations to either side hold CONFIDENCE of a normal distribution.
_QUANTILE = 1.959963984540054


def fraction(successes: float, trials: float) -> float:
    """The part of the trials that succeeded; 0 without trials."""
    return float(successes / trials) if trials else 0.0


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """The Wilson score interval (95 %) of a rate; (0, 1) without trials."""
    if trials == 0:
        return 0.0, 1.0
    rate = successes / trials
    scale = 2 * (trials + _QUANTILE**2)
    centre = (2 * trials * rate + _QUANTILE**2) / scale
    half = _QUANTILE / scale * sqrt(4 * trials * rate * (1 - rate) + _QUANTILE**2)
    low = 0.0 if successes == 0 else centre - half
    return low, 1.0 if successes == trials else centre + half


def standard_error(interval: tuple[float, float]) -> float:
    """The standard error of which this is the 95 % interval, if chances are normal."""
    low, high = interval
    return (high - low) / (2 * _QUANTILE)


def fair_p(successes: int, trials: int) -> float:
    """The two-sided exact binomial test of a rate against 1/2.

    Returns:
        The probability of a split at least as uneven if both outcomes are equally likely; 1 without
        trials.
    """
    if trials == 0:
        return 1.0
    # Imported where it is used: scipy.stats takes a second.
    from scipy.stats import binomtest

    return float(binomtest(successes, trials).pvalue)


def bootstrap_interval(
    values: Sequence[float], of: Callable[..., NDArray[np.float64]] = np.mean
) -> tuple[float, float] | None:
    """The bootstrap interval (95 %, percentiles, fixed seed) of a statistic of values.

    Returns:
        (low, high); None for fewer than two values.
    """
    if len(values) < 2:
        return None
    if len(set(values)) == 1:
        return values[0], values[0]
    sample = np.asarray(values)
    # scipy.stats has this too, but half a second of every run would be its import.
    places = np.random.default_rng(0).integers(0, len(sample), (RESAMPLES, len(sample)))
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(of(sample[places], axis=-1), (tail, 1 - tail))
    return float(low), float(high)
