"""Intervals for what was counted and measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest, bootstrap

CONFIDENCE = 0.95
RESAMPLES = 999


def fraction(successes: float, trials: float) -> float:
    """The rate; 0 if nothing was tried."""
    return float(successes / trials) if trials else 0.0


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """The Wilson score interval (95 %) of a rate; (0, 1) if nothing was tried."""
    if trials == 0:
        return 0.0, 1.0
    interval = binomtest(successes, trials).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def spread(
    values: Sequence[float], of: Callable[..., NDArray[np.float64]] = np.mean
) -> tuple[float, float] | None:
    """A bootstrap interval (95 %, percentiles, fixed chance) of a statistic of values.

    None of fewer than two.
    """
    if len(values) < 2:
        return None
    if len(set(values)) == 1:
        return values[0], values[0]
    rng = np.random.default_rng(0)
    found = bootstrap(
        (np.asarray(values),),
        of,
        confidence_level=CONFIDENCE,
        method="percentile",
        n_resamples=RESAMPLES,
        rng=rng,
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)
