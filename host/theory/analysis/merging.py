"""Where forth-and-back cycles and rotations merge: a heteroclinic connection of saddles.

A wheel leaves the saddle near -pi/4 along its unstable manifold. On one side of the merging it
turns back before the next saddle, and swings; on the other side it passes, and rolls. At the
merging it ends in that saddle, and the four saddles are joined in a ring (Kuznetsov, Elements of
Applied Bifurcation Theory, chapter 6). Mergings are found by bisection.
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
from host.theory.analysis.bisection import last_alike
from host.theory.analysis.fixpoints import Fixpoint, NDComplex, fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.engine.flow import FINENESS, plain_under, run, steps_for
from host.theory.model.laws import law_of, rates_of
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel
from robot.controller import actual_positions

SADDLE = -pi / 4
# Distance from the saddle (rad) at which a wheel starts on the tangent of the manifold. It is off
# the manifold by about the square of this.
NEAR = 1e-6
# A wheel that neither passes nor turns back within _PATIENCE times of the saddle's growth has
# settled in between: it does not pass. It is integrated in chunks of _CHUNK times.
_PATIENCE, _CHUNK = 60.0, 2.0
# In units of the k of the Hopf bifurcation: below _RESTS no wheel passes; mergings of least k are
# searched in _SEARCHED. They lie at 0.9 to 1.5, with steep neurons (a = 100) at 11.
_RESTS, _SEARCHED = 0.3, (0.5, 20.0)
# A wheel that leaves the saddle slower than this share of the rate at which all else settles creeps
# along a line of rests, without momentum, and ends in the next one.
_CREEPS = 0.03
# Values of the constant that are tried.
GRID = 160


class Merging(NamedTuple):
    """A merging.

    Attributes:
        wheel: the wheel at it.
        saddle_quantity: the sum of the two leading real parts of the saddle's eigenvalues, 1/s. If
            it is negative, cycles close to the merging are stable; if it is positive, they are
            unstable, and each branch has a fold before.
        eigenvalues: the saddle's, 1/s, (4,), in descending order of the real part.
        passes_above: whether wheels roll above the merging, not below.
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
    """The saddle that a wheel leaves forward.

    Args:
        wheel: The wheel.

    Returns:
        The saddle at -pi/4, or where dry friction moves it for a wheel that rolls forward; None if
        dry friction leaves none.

    Raises:
        WrongUse: The wheel can rest at any angle.
    """
    if wheel.dry_friction == 0.0:
        return fixpoint(SADDLE, wheel)

    def torque(phi: float) -> float:
        x1, x2 = actual_positions(phi)
        return float(rates_of(wheel)(x1, x2, phi, 0.0, *wheel)[OMEGA])

    steepest = minimize_scalar(lambda phi: -torque(phi), bounds=(SADDLE, 0.0), method="bounded").x
    return (
        fixpoint(float(brentq(torque, SADDLE, steepest, xtol=1e-15)), wheel)
        if torque(steepest) > 0.0
        else None
    )


def course(
    wheel: Wheel, near: float = NEAR, fineness: float = FINENESS
) -> tuple[bool, Array, float]:
    """The course of a wheel that leaves the saddle forward, until it passes the next or turns back.

    Args:
        wheel: The wheel.
        near: The distance from the saddle at which it starts, rad.
        fineness: Steps per unit of the wheel's rate (see host.theory.engine.flow).

    Returns:
        Whether it passes, its states, (4, times), and the time between them, s.

    Raises:
        WrongUse: The wheel is too stiff to be followed, or can rest at any angle.
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
        piece = run(plain_under(law_of(wheel)), state[:, None], tuple(wheel), chunk_s, count)[
            :, :, 0
        ]
        ended = np.flatnonzero((piece[:, OMEGA] < 0.0) | (piece[:, PHI] > left.phi + 3 * pi / 4))
        pieces.append(piece[: ended[0] + 1] if len(ended) else piece[:-1])
        if len(ended):
            break
        state = piece[-1]
    whole = np.concatenate(pieces)
    return bool(whole[-1, PHI] > left.phi + 3 * pi / 4), whole.T, chunk_s / count


def passes(wheel: Wheel, near: float = NEAR, fineness: float = FINENESS) -> bool:
    """Whether a wheel that leaves the saddle forward passes the next one before it turns back.

    Raises WrongUse as `course` and `hopf` do.
    """
    return (
        wheel.k > _RESTS * hopf(wheel).k and not _creeps(wheel) and course(wheel, near, fineness)[0]
    )


def _creeps(wheel: Wheel) -> bool:
    """Whether a wheel leaves the saddle too slowly to pass the next one. It takes no integration.

    That would take very many steps, as with a gain of 0.15 and k = 8.
    """
    left = saddle(wheel)
    if left is None:
        return False
    growth, settling = left.eigenvalues[:2].real
    return bool(growth < -_CREEPS * settling)


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
    """The mergings along a constant, each to the last digits.

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        low: Least value of the constant, above 0.
        high: Greatest value of the constant.
        along: The field of Wheel.
        points: How many values are tried; two mergings between neighbours are not seen.
        near: The distance from the saddle at which wheels start, rad.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.flow).

    Yields:
        The mergings, ascending in the constant.

    Raises:
        WrongUse: As `course` and `hopf` do.
    """

    def rolls(value: float) -> bool:
        return passes(wheel._replace(**{along: value}), near, fineness)

    values = np.geomspace(low, high, points).tolist()
    for (value, rolled), (next_value, rolling) in pairwise(
        (value, rolls(value)) for value in values
    ):
        if rolled != rolling:
            there = wheel._replace(**{along: last_alike(rolls, value, next_value)})
            left = saddle(there)
            if left is not None:
                yield Merging(
                    there,
                    float(left.eigenvalues[0].real + left.eigenvalues[1].real),
                    left.eigenvalues,
                    rolling,
                )


def merging(wheel: Wheel) -> Merging:
    """The merging of least k.

    Args:
        wheel: The wheel; its own k does not matter.

    Returns:
        The merging.

    Raises:
        NotDone: There is none up to 20 times the k of the Hopf bifurcation.
        WrongUse: As `course` and `hopf` do.
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
    """The merging of least k over tau.

    Args:
        wheel: The wheel; its own tau and k do not matter.
        taus_s: Time constants, s.

    Returns:
        (tau, merging), without time constants at which there is none or the wheel is too stiff.
    """
    found = []
    for tau_s in map(float, taus_s):
        with suppress(NotDone, WrongUse):
            found.append((tau_s, merging(wheel._replace(tau=tau_s))))
    return found


def neutral_tau_s(wheel: Wheel, low: float, high: float) -> float | None:
    """The time constant at which the saddle quantity at the merging changes its sign.

    Args:
        wheel: The wheel; its own tau and k do not matter.
        low: Least time constant, s.
        high: Greatest time constant, s.

    Returns:
        The time constant, s; None if the sign is the same at both ends.

    Raises:
        NotDone: There is no merging.
        WrongUse: As `course` and `hopf` do.
    """

    def quantity(tau_s: float) -> float:
        return merging(wheel._replace(tau=tau_s)).saddle_quantity

    if (quantity(low) < 0.0) == (quantity(high) < 0.0):
        return None
    return float(brentq(quantity, low, high, xtol=1e-9))
