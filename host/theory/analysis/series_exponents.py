"""The largest Lyapunov exponent: from one measured series as Rosenstein et al.

And Kantz (1993, 1994) do, and from twins that part.

A wheel's encoder counts whole degrees and its duty cycle whole percents. What is smaller than these
steps does not reach the loop, and a difference between two wheels dies with the neurons' time
constant; what is larger can grow. Exponents are those of differences of finite size: larger than
the steps, smaller than the motion.
"""

from __future__ import annotations

from math import exp, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from host.util.intervals import bootstrap_interval

Array = NDArray[np.float64]

# A neighbour is false if the next coordinate takes it this many times farther away (Kennel et al.,
# 1992); few enough of these will do.
FALSE_RATIO, FALSE_SHARE, MOST_DIMENSIONS = 15.0, 0.01, 10
# Neighbours are followed for so long: first they turn into the fastest direction, in the end they
# are as far apart as any two moments.
FIT_S = (0.5, 1.5)
BLOCKS = 5


def of_noise(fit_s: tuple[float, float] = FIT_S) -> float:
    """The rate (1/s) that `from_series` may find where only noise drives neighbours apart, with the root of time as in a random walk.

    An exponent speaks of chaos only beyond this.
    """
    first, last = fit_s
    return 0.5 * log(last / first) / (last - first)


class Embedding(NamedTuple):
    """A series' delay coordinates: `dimension` values, each `lag` samples after the one before."""

    lag: int
    dimension: int


class Exponent(NamedTuple):
    """A rate (1/s) with its interval (95 %); positive if near states part."""

    rate: float
    interval: tuple[float, float] | None


def _delayed(values: Array, embedding: Embedding) -> Array:
    """The states, (samples, dimension)."""
    lag, dimension = embedding
    rows = len(values) - (dimension - 1) * lag
    return np.stack([values[i * lag : i * lag + rows] for i in range(dimension)], axis=1)


def _neighbours(states: Array, apart: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """(index, index of its nearest neighbour more than `apart` samples before or after, distance), of those that do not coincide."""
    distances, indices = cKDTree(states).query(states, k=min(2 * apart + 2, len(states)))
    fit = (np.abs(indices - np.arange(len(states))[:, None]) > apart) & (distances > 0)
    rows = np.flatnonzero(fit.any(axis=1))
    nearest = fit[rows].argmax(axis=1)
    return rows, indices[rows, nearest].astype(np.int64), distances[rows, nearest]


def embedding(values: Array, apart: int) -> Embedding:
    """A lag after which the autocorrelation has fallen below 1/e, and the fewest dimensions with fewer false neighbours than 1 %.

    apart: neighbours less than so many samples apart are of one passage, and do not count.
    """
    deviation = values - values.mean()
    fallen = float(deviation @ deviation) * exp(-1)
    longest = len(values) // (4 * MOST_DIMENSIONS)
    lag = next(
        (lag for lag in range(1, longest) if deviation[:-lag] @ deviation[lag:] < fallen), longest
    )
    for dimension in range(1, MOST_DIMENSIONS):
        states = _delayed(values, Embedding(lag, dimension + 1))
        rows, others, distances = _neighbours(states[:, :dimension], apart)
        jumps = np.abs(states[rows, dimension] - states[others, dimension])
        if len(rows) and np.mean(jumps > FALSE_RATIO * distances) < FALSE_SHARE:
            return Embedding(lag, dimension)
    return Embedding(lag, MOST_DIMENSIONS)


def divergence(values: Array, embedded: Embedding, apart: int, steps: int) -> Array:
    """The mean logarithm of how much the values of neighbours differ, 0, 1, ...

    `steps` samples after the last by which they are near.
    """
    states = _delayed(values, embedded)
    rows, others, _ = _neighbours(states[: len(states) - steps], apart)
    newest = states[:, -1]
    curve = []
    for step in range(steps + 1):
        differences = np.abs(newest[rows + step] - newest[others + step])
        curve.append(np.log(differences[differences > 0]).mean())
    return np.array(curve)


def from_series(
    values: Array, step_s: float, apart_s: float, fit_s: tuple[float, float] = FIT_S
) -> tuple[Exponent, Embedding] | None:
    """The exponent of a series sampled every step_s, as the mean over BLOCKS parts of it, and how it was embedded.

    apart_s: as `apart`, about a period of the motion. fit_s: from when to when the mean logarithm
    of distances is taken as a straight line. None of a series that is too short for that, or of
    which a part has no motion in it.
    """
    apart, (first, last) = round(apart_s / step_s), (round(edge / step_s) for edge in fit_s)
    blocks = np.array_split(values, BLOCKS)
    if len(blocks[-1]) < 5 * (apart + last) or min(np.ptp(block) for block in blocks) == 0.0:
        return None
    embedded = embedding(blocks[0], apart)
    time_s = np.arange(first, last + 1) * step_s
    rates = [
        float(np.polyfit(time_s, divergence(block, embedded, apart, last)[first:], 1)[0])
        for block in blocks
    ]
    return Exponent(float(np.mean(rates)), bootstrap_interval(rates)), embedded


def from_twins(first: Array, last: Array, span_s: float) -> Exponent:
    """The mean rate at which twins' distances went from `first` to `last` (one each) within span_s."""
    rates = (np.log(last / first) / span_s).tolist()
    return Exponent(float(np.mean(rates)), bootstrap_interval(rates))
