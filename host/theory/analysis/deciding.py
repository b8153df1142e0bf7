"""What wheels do in the end: they are followed until it is decided.

A wheel that repeats itself is decided by two windows of time that agree
(host.theory.analysis.attractors), a chaotic one by a close wheel that parts from it. A transient
does neither: as it leaves an unstable rest or cycle, a difference grows too, but only as much as
the transient itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.attractors import AGREE, CHAOS, REST, settle, watch
from host.theory.analysis.hopf import rests_stably
from host.theory.engine.ensemble import rate_per_s
from host.theory.model.wheel import PHI, Array, Wheel

UNDECIDED = -1
# Each round takes twice the time of the one before, s.
FIRST_S, ROUNDS = 50.0, 6
# Two wheels that are CLOSE at the start of a round and APART at its end (rad, rad/s, potentials)
# are chaotic: a transient that begins 1e-4 away from what it leaves grows 1e4 times.
CLOSE, APART = 1e-8, 3e-2
# What takes more steps than this in a round is left undecided.
MOST_STEPS = 100_000
# Steps where a kind is enough (see host.theory.engine.ensemble).
_FINENESS = 0.6
# A slower wheel (rad/s) that gets slower comes to rest.
STILL = 0.02


def with_close(states: Array) -> Array:
    """Wheels, and behind them a close one for each: (rows, 2 wheels) of (rows, wheels)."""
    return np.hstack([states, states + CLOSE])


def parted(ended: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Whether close wheels have parted.

    Args:
        ended: Where wheels of `with_close` ended, (rows, 2 wheels).

    Returns:
        Where the wheels themselves ended, (rows, wheels), and which the close ones have parted
        from, (wheels,).
    """
    states, others = np.hsplit(ended, 2)
    return states, np.abs(states - others).max(axis=0) > APART


def settle_beside_close(
    states: Array, parameters: Array, seconds: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Follow wheels for some time (s), each beside a close one. Returns what `parted` does."""
    pairs = np.tile(parameters, (1, 2))
    return parted(settle(with_close(states), pairs, seconds, _FINENESS))


def stay_at_rest(states: Array, parameters: Array) -> NDArray[np.bool_]:
    """Which wheels that stand still do so for good.

    Rest may be unstable and disturbances still grow so slowly that nothing moves for minutes.

    Args:
        states: Where the wheels stand, (4, wheels).
        parameters: Their constants, (constants, wheels).

    Returns:
        Whether rest is stable, (wheels,).
    """
    both = zip(parameters.T.tolist(), states[PHI].tolist(), strict=True)
    return np.array([rests_stably(Wheel(*own), phi) for own, phi in both], dtype=bool)


def decide(states: Array, parameters: Array) -> NDArray[np.int64]:
    """The attractors of wheels.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).

    Returns:
        Indices of host.theory.analysis.attractors.KINDS, or UNDECIDED, (wheels,).
    """
    kinds = np.full(states.shape[1], UNDECIDED)
    left, sizes = np.arange(states.shape[1]), np.full(states.shape[1], STILL)
    for number in range(ROUNDS):
        seconds = FIRST_S * 2**number
        quick = rate_per_s(parameters[:, left]) * seconds <= MOST_STEPS
        states, left, sizes = states[:, quick], left[quick], sizes[quick]
        if not len(left):
            break
        states, chaotic = settle_beside_close(states, parameters[:, left], seconds)
        kinds[left[chaotic]] = CHAOS
        states, left, sizes = states[:, ~chaotic], left[~chaotic], sizes[~chaotic]
        if not len(left):
            break
        seen = watch(states, parameters[:, left], seconds, _FINENESS)
        regular, now = seen.apart < AGREE, np.hypot(seen.omega_mean, seen.omega_std)
        # One that gets slower rests, unless a later round sees otherwise.
        so_far = np.where((now < sizes) & (now < STILL), REST, UNDECIDED)
        found = np.where(regular, seen.kinds(), so_far)
        rests = np.flatnonzero(found == REST)
        leave = rests[~stay_at_rest(seen.states[:, rests], parameters[:, left[rests]])]
        found[leave], regular[leave] = UNDECIDED, False
        kinds[left] = found
        states, left, sizes = seen.states[:, ~regular], left[~regular], now[~regular]
    return kinds
