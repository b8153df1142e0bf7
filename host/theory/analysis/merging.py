"""Where forth-and-back cycles and rotations merge.

A heteroclinic connection of neighbouring saddles, found by bisection.

The wheel leaves the saddle near -pi/4 along its unstable manifold. On one side of the merging it
turns back before the saddle a quarter turn on, and swings; on the other it passes, and rolls. At
the merging it ends in the saddle, and the four saddles are joined in a ring.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise
from math import ceil, log, pi
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from host.errors import NotDone, WrongUse
from host.theory.analysis.fixpoints import Fixpoint, NDComplex, fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.engine.flow import FINENESS, plain, run, steps_for
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, rates
from robot.controller import actual_positions

SADDLE = -pi / 4
# Where on the manifold a wheel begins; the straight line leaves the manifold by about the square of
# this.
NEAR = 1e-6
# A wheel that does neither for so many times of the saddle's growth settles in between: it does not
# pass.
_PATIENCE, _CHUNK = 60.0, 2.0
# In units of the k of the Hopf bifurcation. Mergings lie at 0.9 to 1.5, with steep neurons (a =
# 100) at 11.
_RESTS, _SEARCHED = 0.3, (0.5, 20.0)
# Of mergings along a constant those are found that are wider apart than a step of so many.
GRID = 160
# Bisection ends at neighbouring floats.
_BISECTIONS = 60


class Merging(NamedTuple):
    """The wheel at a merging.

    eigenvalues: the saddle's, (4,), in 1/s, the greatest real part first. saddle_quantity: the sum
    of the first and of the real part of the second, 1/s. If it is negative, cycles near the merging
    are stable; if positive, they are unstable, and each branch has a fold before it. passes_above:
    whether wheels roll above it, not below.
    """

    wheel: Wheel
    saddle_quantity: float
    eigenvalues: NDComplex
    passes_above: bool = True

    @property
    def k(self) -> float:
        """The spring constant there."""
        return self.wheel.k


def saddle(wheel: Wheel) -> Fixpoint | None:
    """The saddle at -pi/4, or the one to which dry friction moves it, as a wheel feels it that rolls forward; None if it cannot roll."""
    if wheel.dry_friction == 0.0:
        return fixpoint(SADDLE, wheel)

    def torque(phi: float) -> float:
        x1, x2 = actual_positions(phi)
        return float(rates(x1, x2, phi, 0.0, *wheel)[OMEGA])

    steepest = minimize_scalar(lambda phi: -torque(phi), bounds=(SADDLE, 0.0), method="bounded").x
    return (
        fixpoint(float(brentq(torque, SADDLE, steepest, xtol=1e-15)), wheel)
        if torque(steepest) > 0.0
        else None
    )


def course(
    wheel: Wheel, near: float = NEAR, fineness: float = FINENESS
) -> tuple[bool, Array, float]:
    """A wheel that leaves the saddle forward: whether it passes the next one before it turns back.

    And its course until then.

    The course is (4, times), in steps of the third (s). Raises WrongUse of a wheel that cannot be
    followed, or can rest anywhere.
    """
    left = saddle(wheel)
    if left is None:
        return False, np.empty((4, 0)), 0.0
    vector, growth = left.eigenvectors[:, 0].real, left.eigenvalues[0].real
    chunk_s = _CHUNK / growth
    count = steps_for(chunk_s, wheel, fineness)
    pieces = []
    state = left.state + near * vector / vector[PHI]
    for _ in range(ceil((_PATIENCE - log(near)) / _CHUNK)):
        piece = run(plain, state[:, None], tuple(wheel), chunk_s, count)[:, :, 0]
        ended = np.flatnonzero((piece[:, OMEGA] < 0.0) | (piece[:, PHI] > left.phi + 3 * pi / 4))
        pieces.append(piece[: ended[0] + 1] if len(ended) else piece[:-1])
        if len(ended):
            break
        state = piece[-1]
    whole = np.concatenate(pieces)
    return bool(whole[-1, PHI] > left.phi + 3 * pi / 4), whole.T, chunk_s / count


def passes(wheel: Wheel, near: float = NEAR, fineness: float = FINENESS) -> bool:
    """Whether a wheel that leaves the saddle forward passes the next one before it turns back.

    Raises WrongUse as `course`.
    """
    return wheel.k > _RESTS * hopf(wheel).k and course(wheel, near, fineness)[0]


def mergings(
    wheel: Wheel,
    low: float,
    high: float,
    along: str = "k",
    *,
    points: int = GRID,
    near: float = NEAR,
    fineness: float = FINENESS,
) -> Iterator[Merging]:
    """Yields the mergings along a constant, a field of Wheel, from low to high, to the last digits. Raises WrongUse as `course`."""

    def rolls(value: float) -> bool:
        return passes(wheel._replace(**{along: value}), near, fineness)

    values = np.geomspace(low, high, points).tolist()
    for (value, rolled), (next_value, rolling) in pairwise(
        (value, rolls(value)) for value in values
    ):
        if rolled != rolling:
            below, above = value, next_value
            for _ in range(_BISECTIONS):
                middle = (below + above) / 2
                below, above = (middle, above) if rolls(middle) == rolled else (below, middle)
            there = wheel._replace(**{along: below})
            left = saddle(there)
            if left is not None:
                yield Merging(
                    there,
                    float(left.eigenvalues[0].real + left.eigenvalues[1].real),
                    left.eigenvalues,
                    rolling,
                )


def merging(wheel: Wheel) -> Merging:
    """The merging of least k, whatever the wheel's own k.

    Raises NotDone if there is none, WrongUse as `course` and `hopf`.
    """
    begin = hopf(wheel).k
    found = next(mergings(wheel, _SEARCHED[0] * begin, _SEARCHED[1] * begin, points=48), None)
    if found is None:
        raise NotDone(
            f"no merging was found up to k = {_SEARCHED[1] * begin:g}",
            "this wheel does not begin to roll by way of one",
        )
    return found


def merging_line(wheel: Wheel, taus_s: Any) -> list[tuple[float, Merging]]:
    """(tau, merging) at these time constants, without those at which the wheel is too stiff to be followed."""
    found = []
    for tau_s in map(float, taus_s):
        with suppress(NotDone, WrongUse):
            found.append((tau_s, merging(wheel._replace(tau_s=tau_s))))
    return found


def neutral_tau_s(wheel: Wheel, low: float, high: float) -> float | None:
    """The time constant where the saddle quantity at the merging changes its sign.

    None if both ends have the same.
    """

    def quantity(tau_s: float) -> float:
        return merging(wheel._replace(tau_s=tau_s)).saddle_quantity

    if (quantity(low) < 0.0) == (quantity(high) < 0.0):
        return None
    return float(brentq(quantity, low, high, xtol=1e-9))
