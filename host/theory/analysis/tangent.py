"""How fast small differences between wheels grow, by two algorithms.

The variational equations, and pairs of near wheels.

A wheel and one vector that its Jacobian drives are a column of eight rows, so that as many as one
likes are followed at once (host.theory.engine.ensemble); for several vectors of a wheel there are
several columns of it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from host.theory.analysis.attractors import settle
from host.theory.engine.elementary import MATHEMATICS, inlined, vectorised
from host.theory.engine.ensemble import FINE, advance, rate_per_s
from host.theory.model.symbolic import jacobian_at, rates_of_vector
from host.theory.model.wheel import Array, Wheel
from sim_motor.mathematics import with_mathematics

# Between two orthonormalisations all vectors turn towards the fastest, on average by a factor of
# e^6 or less, of the 16 digits they have. One vector alone must only stay within what a float can
# hold.
MOST_DECAY, MOST_GROWTH = 6.0, 100.0
LONGEST_S, LONGEST_ALONE_S = 1.0, 2.0
# Pairs of wheels begin so far apart: after a second that is still little, and well above the last
# digit.
PAIR_DISTANCE = 1e-7

_both: Any = with_mathematics(rates_of_vector(), MATHEMATICS, inlined)


@vectorised
def tangent_rates(states: Array, parameters: Array, out: Array) -> None:
    """The rates of all wheels, and of the vector below each, (8, wheels)."""
    s, p, o = states, parameters, out
    for i in range(states.shape[1]):
        o[0, i], o[1, i], o[2, i], o[3, i], o[4, i], o[5, i], o[6, i], o[7, i] = _both(
            s[0, i], s[1, i], s[2, i], s[3, i],
            s[4, i], s[5, i], s[6, i], s[7, i],
            p[0, i], p[1, i], p[2, i], p[3, i], p[4, i], p[5, i],
        )  # fmt: skip


class Growth(NamedTuple):
    """Logarithmic rates (1/s) in successive equal intervals, (intervals, vectors, wheels), and the last states, (4, wheels).

    vectors: orthonormal, (wheels, 4, vectors), to go on with.
    """

    rates: Array
    states: Array
    vectors: Array


def _intervals(parameters: Array, seconds: float, count: int) -> int:
    """How many intervals, each so short that `count` vectors may be left alone."""
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
) -> Growth:
    """How `count` vectors grow that are made orthonormal again and again (Benettin et al., Meccanica 15, 1980).

    In the long run their rates are the Lyapunov exponents, the greatest first. vectors: to begin
    with; else some, always the same. Raises WrongUse as host.theory.engine.ensemble.advance does.
    """
    wheels, rounds = states.shape[1], _intervals(parameters, seconds, count)
    if vectors is None:
        vectors = np.linalg.qr(np.random.default_rng(0).normal(size=(wheels, 4, count)))[0]
    columns = np.tile(parameters, (1, count))
    rates = np.empty((rounds, count, wheels))
    for step in range(rounds):
        both = np.vstack([np.tile(states, (1, count)), vectors.transpose(1, 2, 0).reshape(4, -1)])
        both = advance(both, columns, seconds / rounds, fineness, tangent_rates)
        # Copies of a chaotic wheel would part in the end, from the last bit on.
        states = both[:4, :wheels]
        vectors, upper = np.linalg.qr(both[4:].reshape(4, count, wheels).transpose(2, 0, 1))
        rates[step] = np.log(np.abs(np.diagonal(upper, axis1=1, axis2=2))).T * (rounds / seconds)
    return Growth(rates, states, vectors)


def pair_growth(states: Array, parameters: Array, seconds: float, fineness: float = FINE) -> Array:
    """The rates (1/s) at which pairs of near wheels part, in successive equal intervals, (intervals, wheels); no Jacobian is used.

    After each interval the second wheel is put back to PAIR_DISTANCE from the first, in the
    direction in which it then is.
    """
    wheels, rounds = states.shape[1], max(1, round(seconds / LONGEST_S))
    away = np.random.default_rng(1).normal(size=states.shape)
    columns = np.tile(parameters, (1, 2))
    rates = np.empty((rounds, wheels))
    for step in range(rounds):
        away *= PAIR_DISTANCE / np.linalg.norm(away, axis=0)
        both = settle(np.hstack([states, states + away]), columns, seconds / rounds, fineness)
        states, away = both[:, :wheels], both[:, wheels:] - both[:, :wheels]
        rates[step] = np.log(np.linalg.norm(away, axis=0) / PAIR_DISTANCE) * (rounds / seconds)
    return rates


def divergence(wheel: Wheel) -> float:
    """The sum of the four exponents (1/s): the Jacobian's trace, the same in all states."""
    return float(np.trace(jacobian_at((0.0, 0.0, 0.0, 0.0), wheel)))


def smooth_mean(rates: Array) -> Array:
    """The mean over the first axis with a weight that opens and closes smoothly.

    Of regular motion it is free of what depends on where in a period the time begins and ends, and
    of the vectors' first turns.
    """
    weights = np.sin(np.pi * (np.arange(len(rates)) + 0.5) / len(rates)) ** 6
    return np.asarray(np.tensordot(weights / weights.sum(), rates, 1))


def kaplan_yorke(exponents: Array, least: float = 0.0) -> float:
    """The Lyapunov dimension of exponents, the greatest first.

    Those nearer to 0 than `least` are taken for 0.

    Kaplan and Yorke: as many of the first as have no negative sum, and for the rest their sum in
    parts of the next.
    """
    own = np.where(np.abs(exponents) < least, 0.0, exponents)
    sums = np.cumsum(own)
    whole = int(np.sum(np.cumprod(sums >= 0.0)))
    if whole in (0, len(own)):
        return float(whole)
    return float(whole + sums[whole - 1] / abs(own[whole]))
