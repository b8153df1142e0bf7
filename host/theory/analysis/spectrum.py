"""Means of wheels with errors, and the four Lyapunov exponents of wheels that move or rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from host.theory.analysis.tangent import growth, smooth_mean
from host.theory.engine.ensemble import FINE
from host.theory.model.wheel import Array

Mask = NDArray[np.bool_]

# With as many wheels the spread between them is known well enough.
ENOUGH = 8


class Mean(NamedTuple):
    """A mean over wheels and times.

    Attributes:
        value: the mean.
        error: its standard error.
        by_wheels: the error from the spread between wheels, which are independent; None with fewer
            than two.
        by_blocks: the error from the spread between blocks of time, as if these were independent;
            None with fewer than two.
    """

    value: float
    error: float
    by_wheels: float | None
    by_blocks: float | None


def mean(values: Array) -> Mean:
    """The mean of values of wheels in blocks of time.

    Args:
        values: (wheels, blocks).

    Returns:
        The mean. Its error is that from wheels if they are at least ENOUGH, else the greater one.
    """
    by_wheels, by_blocks = _error(values.mean(axis=1)), _error(values.ravel())
    known = [error for error in (by_wheels, by_blocks) if error is not None]
    error = (
        by_wheels if by_wheels is not None and len(values) >= ENOUGH else max(known, default=0.0)
    )
    return Mean(float(values.mean()), error, by_wheels, by_blocks)


def quantile(wheels: int, confidence: float) -> float:
    """How many standard errors to either side hold the true mean with this confidence."""
    return float(stdtrit(max(1, wheels - 1), (1 + confidence) / 2))


def _error(values: Array) -> float | None:
    count = len(values)
    return float(values.std(ddof=1) / np.sqrt(count)) if count > 1 else None


class Exponents(NamedTuple):
    """The exponents of wheels.

    Attributes:
        blocks: 1/s, (blocks, 4, wheels). The first is that along the flow for wheels that move.
        states: the last states, (4, wheels).
    """

    blocks: Array
    states: Array


def exponents(
    states: Array,
    parameters: Array,
    align_s: float,
    seconds: float,
    blocks: int,
    moving: Mask,
    regular: Mask,
    fineness: float = FINE,
) -> Exponents:
    """All four exponents of wheels on their attractors.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        align_s: How long their vectors turn into place first, s.
        seconds: How long to follow the wheels, s.
        blocks: In how many blocks of time.
        moving: Which wheels do not come to rest, (wheels,).
        regular: Which wheels repeat themselves, (wheels,): their blocks open and close smoothly.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Raises:
        WrongUse: Wheels are too stiff to be followed.
    """
    found, ended = np.empty((blocks, 4, states.shape[1])), states.copy()
    for with_flow in (True, False):
        chosen = moving == with_flow
        if not chosen.any():
            continue
        own = parameters[:, chosen]
        begin, vectors = states[:, chosen], None
        aligned = growth(begin, own, align_s, 4, vectors, fineness, with_flow=with_flow)
        begin, vectors = aligned.states, aligned.vectors
        after = growth(begin, own, seconds, 4, vectors, fineness, with_flow=with_flow)
        parts = np.array_split(after.rates, blocks)
        found[:, :, chosen] = [
            np.where(regular[chosen], smooth_mean(part), part.mean(axis=0)) for part in parts
        ]
        ended[:, chosen] = after.states
    return Exponents(found, ended)


def largest_exponents(
    states: Array, parameters: Array, seconds: float, moving: Mask, fineness: float = FINE
) -> Array:
    """The largest exponent of each wheel, 1/s, (wheels,): that of a cycle is 0.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        seconds: How long to follow them, s.
        moving: Which wheels do not come to rest, (wheels,).
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Raises:
        WrongUse: Wheels are too stiff to be followed.
    """
    found = np.empty(states.shape[1])
    for with_flow in (True, False):
        chosen = moving == with_flow
        if chosen.any():
            count = 2 if with_flow else 1
            rates = growth(
                states[:, chosen],
                parameters[:, chosen],
                seconds,
                count,
                None,
                fineness,
                with_flow=with_flow,
            ).rates
            found[chosen] = smooth_mean(rates).max(axis=0)
    return found
