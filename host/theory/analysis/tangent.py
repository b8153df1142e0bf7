"""How fast small differences between wheels grow, by tangent vectors and by close pairs.

A wheel and one tangent vector, which the wheel's Jacobian drives, are a column of eight rows. Any
number of columns is followed at once (host.theory.engine.ensemble); a wheel with several vectors
has several columns.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from host.errors import WrongUse
from host.theory.engine.elementary import MATHEMATICS, inlined, vectorised
from host.theory.engine.ensemble import FINE, advance, rate_per_s
from host.theory.engine.sliding import DRY
from host.theory.model.laws import PAPER, Law, array_rates, law_of
from host.theory.model.symbolic import jacobian_at, rates_of_vector
from host.theory.model.wheel import Array, Wheel
from sim_motor.mathematics import with_mathematics

# Between two orthonormalisations all vectors turn towards the fastest, by a factor of e^6 or less
# on average: a float has 16 digits. A single vector must only stay within the range of floats.
MOST_DECAY, MOST_GROWTH = 6.0, 100.0
LONGEST_S, LONGEST_ALONE_S = 1.0, 2.0
# Distance of a pair at the start of an interval: still small after a second, and far above the last
# digit.
PAIR_DISTANCE = 1e-7


@cache
def tangent_rates(law: Law = PAPER) -> Any:
    """The compiled rates of all wheels and of the vector below each, (8, wheels)."""
    both: Any = with_mathematics(rates_of_vector(law), MATHEMATICS, inlined)

    def tangent_rates(states: Array, parameters: Array, out: Array) -> None:
        s, p, o = states, parameters, out
        for i in range(states.shape[1]):
            o[0, i], o[1, i], o[2, i], o[3, i], o[4, i], o[5, i], o[6, i], o[7, i] = both(
                s[0, i], s[1, i], s[2, i], s[3, i],
                s[4, i], s[5, i], s[6, i], s[7, i],
                p[0, i], p[1, i], p[2, i], p[3, i], p[4, i], p[5, i], p[6, i], p[7, i], p[8, i],
            )  # fmt: skip

    return vectorised(tangent_rates)


class Growth(NamedTuple):
    """How vectors grow.

    Attributes:
        rates: growth rates in successive equal intervals, 1/s, (intervals, vectors, wheels).
        states: the last states, (4, wheels).
        vectors: the last vectors, orthonormal, (wheels, 4, vectors).
    """

    rates: Array
    states: Array
    vectors: Array


def _intervals(parameters: Array, seconds: float, count: int) -> int:
    """How many intervals, so short that `count` vectors do not become parallel in one."""
    free = parameters.copy()
    free[Wheel._fields.index("k")] = 0.0
    longest = (
        LONGEST_ALONE_S
        if count == 1
        else min(LONGEST_S, MOST_DECAY / float(rate_per_s(free).max()))
    )
    return max(
        1, int(np.ceil(seconds / min(longest, MOST_GROWTH / float(rate_per_s(parameters).max()))))
    )


def growth(
    states: Array,
    parameters: Array,
    seconds: float,
    count: int = 1,
    vectors: Array | None = None,
    fineness: float = FINE,
    *,
    with_flow: bool = False,
) -> Growth:
    """How tangent vectors grow that are orthonormalised again and again.

    In the long run their rates are the Lyapunov exponents, the largest first (Benettin et al.,
    Meccanica 15, 1980).

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        seconds: How long to follow them, s.
        count: How many vectors.
        vectors: The first vectors, (wheels, 4, count); without them random ones, always the same.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).
        with_flow: Whether the first vector is that of the flow itself, along which the exponent of
            a wheel that moves for ever is 0. The others are then those across the flow, in
            descending order. Two exponents that are close to 0 would otherwise take thousands of
            seconds to part.

    Returns:
        The rates, and what is needed to go on.

    Raises:
        WrongUse: Wheels are too stiff to be followed, or have dry friction.
    """
    if parameters[DRY].any():
        raise WrongUse(
            "the tangent vectors of a wheel with dry friction jump whenever it stops",
            "leave dry friction out, or use pair_growth",
        )
    wheels, rounds = states.shape[1], _intervals(parameters, seconds, count)
    if vectors is None:
        vectors = np.random.default_rng(0).normal(size=(wheels, 4, count))
        if with_flow:
            vectors[:, :, 0] = _flow(states, parameters).T
        vectors = np.linalg.qr(vectors)[0]
    first, own_rates = 1 if with_flow else 0, tangent_rates(law_of(parameters))
    columns = np.tile(parameters, (1, count - first))
    rates = np.empty((rounds, count, wheels))
    for step in range(rounds):
        own, speed = vectors[:, :, first:], np.linalg.norm(_flow(states, parameters), axis=0)
        both = np.vstack(
            [np.tile(states, (1, count - first)), own.transpose(1, 2, 0).reshape(4, -1)]
        )
        both = advance(both, columns, seconds / rounds, fineness, own_rates)
        # Copies of a chaotic wheel would part from the last bit on: all go on from the first.
        states = both[:4, :wheels]
        grown = both[4:].reshape(4, count - first, wheels).transpose(2, 0, 1)
        if with_flow:
            # The flow takes its own vector along.
            grown = np.dstack([(_flow(states, parameters) / speed).T, grown])
        vectors, upper = np.linalg.qr(grown)
        rates[step] = np.log(np.abs(np.diagonal(upper, axis1=1, axis2=2))).T * (rounds / seconds)
    return Growth(rates, states, vectors)


def _flow(states: Array, parameters: Array) -> Array:
    """The rates of wheels, (4, wheels)."""
    return np.array(array_rates(law_of(parameters))(*states, *parameters))


def pair_growth(states: Array, parameters: Array, seconds: float, fineness: float = FINE) -> Array:
    """How fast pairs of close wheels part. No Jacobian is used.

    After each interval the second wheel is put back to PAIR_DISTANCE from the first, in the
    direction in which it then is.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        seconds: How long to follow them, s.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Returns:
        Growth rates in successive equal intervals, 1/s, (intervals, wheels).

    Raises:
        WrongUse: Wheels are too stiff to be followed.
    """
    wheels, rounds = states.shape[1], max(1, round(seconds / LONGEST_S))
    away = np.random.default_rng(1).normal(size=states.shape)
    columns = np.tile(parameters, (1, 2))
    rates = np.empty((rounds, wheels))
    for step in range(rounds):
        away *= PAIR_DISTANCE / np.linalg.norm(away, axis=0)
        both = advance(np.hstack([states, states + away]), columns, seconds / rounds, fineness)
        states, away = both[:, :wheels], both[:, wheels:] - both[:, :wheels]
        rates[step] = np.log(np.linalg.norm(away, axis=0) / PAIR_DISTANCE) * (rounds / seconds)
    return rates


def divergence(wheel: Wheel) -> float:
    """The sum of the four exponents, 1/s: the Jacobian's trace, the same in all states.

    A wheel with mechanics of its own may have another in each state.
    """
    return float(np.trace(jacobian_at((0.0, 0.0, 0.0, 0.0), wheel)))


def smooth_mean(rates: Array) -> Array:
    """The mean over the first axis, with a weight that opens and closes smoothly.

    For regular motion it does not depend on where in a period the time starts and ends, nor on how
    the vectors turn at first.
    """
    weights = np.sin(np.pi * (np.arange(len(rates)) + 0.5) / len(rates)) ** 6
    return np.asarray(np.tensordot(weights / weights.sum(), rates, 1))


def kaplan_yorke(exponents: Array, least: float = 0.0) -> float:
    """The Lyapunov dimension (Kaplan and Yorke 1979).

    The number of leading exponents with a sum of 0 or more, plus that sum divided by the modulus of
    the next exponent.

    Args:
        exponents: 1/s, in descending order.
        least: Exponents closer to 0 count as 0, 1/s.

    Returns:
        The dimension.
    """
    own = np.where(np.abs(exponents) < least, 0.0, exponents)
    sums = np.cumsum(own)
    whole = int(np.sum(np.cumprod(sums >= 0.0)))
    if whole in (0, len(own)):
        return float(whole)
    return float(whole + sums[whole - 1] / abs(own[whole]))
