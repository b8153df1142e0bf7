"""The largest Lyapunov exponent from one measured series, and from pairs of runs.

From a series by the methods of Rosenstein et al. (Physica D 65, 1993) and Kantz (Phys. Lett. A 185,
1994). A wheel's encoder counts whole degrees and its duty cycle whole percents. Differences below
these steps do not reach the loop, and die out with the neurons' time constant; larger ones can
grow. The exponents here are those of differences of finite size: larger than the steps, smaller
than the motion.
"""

from __future__ import annotations

from math import exp, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from host.util.intervals import bootstrap_interval

Array = NDArray[np.float64]

# A neighbour is false if the next coordinate takes it this many times farther away. A dimension
# with less than FALSE_SHARE of false neighbours is enough.
FALSE_RATIO, FALSE_SHARE, MOST_DIMENSIONS = 15.0, 0.01, 10
# How many neighbours are looked at first.
_FEW = 8
# Rates are fitted between these times (s): before, neighbours turn into the fastest direction;
# after, they are as far apart as any two moments.
FIT_S = (0.5, 1.5)
BLOCKS = 5


def of_noise(fit_s: tuple[float, float] = FIT_S) -> float:
    """The rate (1/s) that `from_series` may find where only noise drives neighbours apart.

    Their distance then grows like the square root of time, as in a random walk. Only a larger
    exponent is a sign of chaos.
    """
    first, last = fit_s
    return 0.5 * log(last / first) / (last - first)


class Embedding(NamedTuple):
    """Delay coordinates of a series.

    Attributes:
        lag: samples between two coordinates.
        dimension: how many coordinates.
    """

    lag: int
    dimension: int


class Exponent(NamedTuple):
    """A growth rate.

    Attributes:
        rate: 1/s; positive if close states part.
        interval: of the rate, 1/s, with a confidence of 95 %; None if it is not known.
    """

    rate: float
    interval: tuple[float, float] | None


def _delayed(values: Array, embedding: Embedding) -> Array:
    """The states in delay coordinates, (samples, dimension)."""
    lag, dimension = embedding
    rows = len(values) - (dimension - 1) * lag
    return np.stack([values[i * lag : i * lag + rows] for i in range(dimension)], axis=1)


def _neighbours(states: Array, apart: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """The nearest neighbour of each state that has one.

    A neighbour is more than `apart` samples earlier or later, and does not coincide. Returns the
    indices of the states, the indices of their neighbours and the distances, (pairs,) each.
    """
    tree, most = cKDTree(states), min(2 * apart + 2, len(states))
    others, nearest = np.zeros(len(states), np.int64), np.full(len(states), np.inf)
    missing, count = np.arange(len(states)), 0
    # For most states one of the first few does.
    while count < most and len(missing):
        count = min(4 * count or _FEW, most)
        distances, indices = tree.query(states[missing], k=count)
        fit = (np.abs(indices - missing[:, None]) > apart) & (distances > 0)
        found = fit.any(axis=1)
        rows, first = missing[found], fit[found].argmax(axis=1)
        others[rows], nearest[rows] = indices[found, first], distances[found, first]
        missing = missing[~found]
    rows = np.flatnonzero(np.isfinite(nearest))
    return rows, others[rows], nearest[rows]


def embedding(values: Array, apart: int) -> Embedding:
    """Delay coordinates in which few neighbours are false (Kennel et al., Phys. Rev. A 45, 1992).

    Args:
        values: The series, (samples,).
        apart: Neighbours closer in time than this many samples belong to one passage and do not
            count.

    Returns:
        A lag after which the autocorrelation has fallen below 1/e, and the least dimension with
        less than 1 % of false neighbours.
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
    """How far neighbours part.

    Args:
        values: The series, (samples,).
        embedded: Its delay coordinates.
        apart: As of `embedding`.
        steps: How many samples to follow neighbours.

    Returns:
        The mean logarithm of the difference of their values, 0 to `steps` samples after the last
        value of their coordinates, (steps + 1,).
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
    """The largest exponent of a series.

    Args:
        values: The series, (samples,).
        step_s: Time between samples, s.
        apart_s: Neighbours closer in time do not count, s; about a period of the motion.
        fit_s: Start and end of the time in which the logarithm of distances is fitted by a line, s.

    Returns:
        The mean over BLOCKS parts of the series, and the delay coordinates; None for a series that
        is too short, or with a part in which nothing moves.
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
    """The rate at which pairs of runs part.

    Args:
        first: Distances of the pairs, (pairs,).
        last: Distances of the same pairs later, (pairs,).
        span_s: The time between, s.

    Returns:
        The mean growth rate of distances.
    """
    rates = (np.log(last / first) / span_s).tolist()
    return Exponent(float(np.mean(rates)), bootstrap_interval(rates))
