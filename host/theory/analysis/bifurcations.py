"""A curve of cycles followed to its ends, and the bifurcations on it.

Folds, pitchforks and Neimark-Sacker points.

A multiplier -1 of the reduced map is +1 for the whole period: there the cycle loses its symmetry in
a pitchfork. For the same reason a cycle with its symmetry has no period doubling: the period's
multipliers are squares at least.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from host.errors import NotDone
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import Shooting
from host.theory.analysis.fixpoints import NDComplex
from host.theory.analysis.merging import saddle
from host.theory.model.wheel import OMEGA

FOLD, PITCHFORK, NEIMARK_SACKER = "fold", "pitchfork", "neimark-sacker"
# Where a curve may end.
MERGING, RANGE, HOPF, STICKS, LOST, LONG = "merging", "range", "hopf", "sticks", "lost", "long"
# A reduced map of so many times of the saddle's growth is within about 1e-7 of the merging.
_LONGEST = 18.0
_SHORTEST_STEP, _LONGEST_STEP, _MOST_POINTS = 1e-7, 0.2, 1500
# What vanishes by rounding alone, near a merging, is no bifurcation: a multiplier is as near to
# where it should be.
_SURE = 1e-3
_FINER = 1.5


class Special(NamedTuple):
    """A bifurcation: its type, the point, its place, between the points before - 1 and before of its curve, and a check.

    off_by: by how much (relative) the followed constant differs if it is located with shorter steps
    in time.
    """

    type: str
    point: Point
    before: int
    off_by: float


class Followed(NamedTuple):
    """A curve's points, the bifurcations on it, and why it ended."""

    points: list[Point]
    specials: list[Special]
    end: str


def _tests(shooting: Any) -> dict[str, Callable[[Point], float]]:
    """What vanishes at each type of bifurcation."""

    def flip(point: Point) -> float:
        return float(np.linalg.det(shooting.map_derivative(point.unknowns) + np.eye(3)))

    def pair(point: Point) -> float:
        a, b, c = shooting.multipliers(point.unknowns)
        return float(((a * b - 1) * (a * c - 1) * (b * c - 1)).real)

    return {FOLD: lambda point: float(point.tangent[-1]), PITCHFORK: flip, NEIMARK_SACKER: pair}


def _sure(kind: str, multipliers: NDComplex) -> bool:
    if kind == NEIMARK_SACKER:  # two real multipliers of product 1 are none
        return bool(
            np.any((np.abs(multipliers.imag) > 0.0) & (np.abs(np.abs(multipliers) - 1) < _SURE))
        )
    return bool(np.abs(multipliers - (1 if kind == FOLD else -1)).min() < _SURE)


def _end(shooting: Shooting, point: Point, low: float, high: float, smallest: float) -> str | None:
    value, seconds = point.unknowns[4], point.unknowns[3]
    if not low < value < high:
        return RANGE
    wheel = shooting.wheel_at(point.unknowns)
    left = saddle(wheel)
    if left is not None and seconds * left.eigenvalues[0].real > _LONGEST:
        return MERGING
    if wheel.dry_friction > 0.0 and shooting.path(point.unknowns)[:, OMEGA, 0].min() < 0.0:
        return STICKS
    if abs(point.unknowns[2]) < smallest:
        return HOPF
    return None


def _beyond(bound: float) -> Callable[[Point], float]:
    return lambda point: float(point.unknowns[4] - bound)


def follow(curve: Curve, first: Point, low: float, high: float) -> Followed:
    """The curve of cycles from its first point on, as long as the followed constant is between low and high."""
    shooting = curve.problem
    assert isinstance(shooting, Shooting)
    tests = _tests(shooting)
    finer = curve._replace(
        problem=type(shooting)(
            shooting.wheel, shooting.family, shooting.along, _FINER * shooting.fineness
        )
    )
    points: list[Point] = []
    specials: list[Special] = []
    values: dict[str, float] = {}
    smallest = (
        0.0 if shooting.family.turn else abs(first.unknowns[2]) / 2
    )  # smaller cycles have come back to the fixpoint
    try:
        for length, point in curve.follow(first, _SHORTEST_STEP, _LONGEST_STEP):
            now = {kind: test(point) for kind, test in tests.items()}
            for kind in tests if points else ():
                if values[kind] * now[kind] < 0.0:
                    there = curve.locate(points[-1], length, tests[kind])
                    if _sure(kind, shooting.multipliers(there.unknowns)):
                        again = finer.locate(points[-1], length, _tests(finer.problem)[kind])
                        specials.append(
                            Special(
                                kind,
                                there,
                                len(points),
                                abs(float(again.unknowns[4] / there.unknowns[4]) - 1),
                            )
                        )
            end = _end(shooting, point, low, high, smallest)
            if end == RANGE and points:
                points.append(
                    curve.locate(
                        points[-1], length, _beyond(low if point.unknowns[4] <= low else high)
                    )
                )
            else:
                points.append(point)
            values = now
            if end or len(points) == _MOST_POINTS:
                return Followed(points, specials, end or LONG)
    except NotDone:
        return Followed(points, specials, LOST)
    raise AssertionError("a curve has no last point")
