"""A curve of cycles followed to its ends, and the bifurcations on it.

Folds, pitchforks, period doublings and Neimark-Sacker bifurcations. For a cycle with a symmetry, a
multiplier -1 of the reduced map is +1 for the whole period: there the cycle loses its symmetry in a
pitchfork. For the same reason it has no period doubling: the multipliers of its period are squares,
or fourth powers. A cycle without symmetry has one there.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from host.errors import NotDone
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import FORTH_AND_BACK, Shooting
from host.theory.analysis.fixpoints import NDComplex
from host.theory.analysis.merging import saddle
from host.theory.model.wheel import Array

BifurcationType = Literal["fold", "pitchfork", "period-doubling", "neimark-sacker"]
FOLD: BifurcationType = "fold"
PITCHFORK: BifurcationType = "pitchfork"
PERIOD_DOUBLING: BifurcationType = "period-doubling"
NEIMARK_SACKER: BifurcationType = "neimark-sacker"
# Where a curve ends: at a merging; at the end of the range; at a Hopf bifurcation; where a wheel
# with dry friction stops; where it cannot be followed further; after too many points.
End = Literal["merging", "range", "hopf", "sticks", "lost", "long"]
MERGING: End = "merging"
RANGE: End = "range"
HOPF: End = "hopf"
STICKS: End = "sticks"
LOST: End = "lost"
LONG: End = "long"
# A cycle whose reduced map takes this many times of the saddle's growth is within about 1e-7 of the
# merging.
_LONGEST = 18.0
_SHORTEST_STEP, _LONGEST_STEP, _MOST_POINTS = 1e-7, 0.2, 1500
# A multiplier at a bifurcation is this close to where it should be. What vanishes by rounding, near
# a merging, is no bifurcation.
_SURE = 1e-3
_FINER = 1.5


class Bifurcation(NamedTuple):
    """A bifurcation of cycles.

    Attributes:
        type: fold, pitchfork, period doubling or Neimark-Sacker.
        point: the cycle at which it happens.
        before: its place on the curve, between the points number `before` - 1 and `before`.
        off_by: relative difference of the followed constant if located with shorter time steps.
    """

    type: BifurcationType
    point: Point
    before: int
    off_by: float


class Followed(NamedTuple):
    """A curve of cycles: its points, the bifurcations on it, and why it ends."""

    points: list[Point]
    bifurcations: list[Bifurcation]
    end: End


def vanishing(type_: BifurcationType, derivative: Array) -> float:
    """A function of the reduced map that vanishes at a bifurcation (Kuznetsov, section 10.2).

    Args:
        type_: Its type.
        derivative: The map's Jacobian at a fixpoint, (3, 3).

    Returns:
        0 if it has a multiplier 1, a multiplier -1, or two of product 1.
    """
    if type_ == NEIMARK_SACKER:
        # The eigenvalues of the matrix of cofactors are the products of two multipliers each.
        first, second, third = derivative
        derivative = np.array(
            [np.cross(second, third), np.cross(third, first), np.cross(first, second)]
        )
    flips = type_ in (PITCHFORK, PERIOD_DOUBLING)
    return float(np.linalg.det(derivative + np.eye(3) * (1.0 if flips else -1.0)))


def tests_of(shooting: Shooting) -> dict[BifurcationType, Callable[[Point], float]]:
    """The function that vanishes at each type of bifurcation."""

    def of(type_: BifurcationType) -> Callable[[Point], float]:
        return lambda point: vanishing(type_, shooting.map_derivative(point.unknowns))

    flip = PERIOD_DOUBLING if shooting.family.power == 1.0 else PITCHFORK
    return {
        FOLD: lambda point: float(point.tangent[-1]),
        flip: of(flip),
        NEIMARK_SACKER: of(NEIMARK_SACKER),
    }


def is_bifurcation(type_: BifurcationType, multipliers: NDComplex) -> bool:
    """Whether a multiplier is where this type has it."""
    if type_ == NEIMARK_SACKER:  # two real multipliers of product 1 are no such pair
        on_circle = np.abs(np.abs(multipliers) - 1) < _SURE
        return bool(np.any((np.abs(multipliers.imag) > 0.0) & on_circle))
    expected = 1 if type_ == FOLD else -1
    return bool(np.abs(multipliers - expected).min() < _SURE)


def _end(shooting: Shooting, point: Point, low: float, high: float, smallest: float) -> End | None:
    """Why the curve ends at this point; None if it does not."""
    value, seconds = point.unknowns[4], point.unknowns[3]
    if not low < value < high:
        return RANGE
    wheel = shooting.wheel_at(point.unknowns)
    left = saddle(wheel)
    longest = _LONGEST * shooting.family.crossings
    if left is not None and seconds * left.eigenvalues[0].real > longest:
        return MERGING
    if wheel.dry_friction > 0.0 and shooting.least_omega(point) < 0.0:
        return STICKS
    if abs(point.unknowns[2]) < smallest:
        return HOPF
    return None


def follow(shooting: Shooting, curve: Curve, first: Point, low: float, high: float) -> Followed:
    """Follow cycles along a constant, around folds, to the end of their curve.

    Args:
        shooting: The problem that the cycles solve.
        curve: The curve of its solutions.
        first: The first cycle, and the direction in which to go.
        low: Least value of the followed constant.
        high: Greatest value of the followed constant.

    Returns:
        The curve and the bifurcations on it.
    """
    tests, finer = tests_of(shooting), shooting.with_finer_steps(_FINER)
    points: list[Point] = []
    found: list[Bifurcation] = []
    values: dict[BifurcationType, float] = {}
    # Smaller forth-and-back cycles have come back to the fixpoint.
    smallest = abs(first.unknowns[2]) / 2 if shooting.family is FORTH_AND_BACK else 0.0
    try:
        for point in curve.follow(first, _SHORTEST_STEP, _LONGEST_STEP):
            before, values = values, {type_: test(point) for type_, test in tests.items()}
            for type_ in before:
                if before[type_] * values[type_] >= 0.0:
                    continue
                there = curve.locate(points[-1], point, tests[type_])
                if is_bifurcation(type_, shooting.multipliers(there.unknowns)):
                    finer_curve = Curve(finer, curve.scales)
                    again = finer_curve.locate(points[-1], point, tests_of(finer)[type_])
                    off_by = abs(float(again.unknowns[4] / there.unknowns[4]) - 1)
                    found.append(Bifurcation(type_, there, len(points), off_by))
            end = _end(shooting, point, low, high, smallest)
            if end == RANGE and points:
                bound = low if point.unknowns[4] <= low else high
                points.append(curve.locate(points[-1], point, partial(_beyond, bound)))
            elif end == STICKS and points:
                points.append(curve.locate(points[-1], point, shooting.least_omega))
            else:
                points.append(point)
            if end or len(points) == _MOST_POINTS:
                return Followed(points, found, end or LONG)
    except NotDone:
        return Followed(points, found, LOST)
    raise AssertionError("a curve has no last point")


def _beyond(bound: float, point: Point) -> float:
    """How far the followed constant is beyond a bound."""
    return float(point.unknowns[4] - bound)
