"""The Hopf line and the merging line of the study `lines`, with their special points."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import pairwise
from math import pi
from typing import NamedTuple

import numpy as np

from host.errors import NotDone, WrongUse
from host.theory.analysis.boundaries import Boundary
from host.theory.analysis.hopf import above_hopf, hopf
from host.theory.analysis.merging import NEAR, passes, saddle
from host.theory.engine.flow import FINENESS
from host.theory.model.wheel import Array, Wheel
from host.theory.studies.lines_plane import Plane
from host.theory.studies.lines_rows import BoundaryPart, Measured, SpecialType

# Values of x that are tried for a crossing of an edge; the longest step along a boundary.
_TRIED, _STEP = 160, 0.05
# A line that comes back to a crossing of an edge is the same as the one that begins there.
_SAME = 1e-4
# The merging is located again with another start on the manifold and shorter steps.
_FARTHER, _FINER = 10.0, 1.5


class _Line(NamedTuple):
    """One of the two lines.

    Attributes:
        boundary: the line.
        again: the same with shorter time steps; None where no time steps are taken.
        specials: the function of a wheel that vanishes at each special point.
        period_s: of the cycles there; None where it is infinite.
    """

    boundary: Boundary
    again: Boundary | None
    specials: dict[SpecialType, Callable[[Wheel], float]]
    period_s: Callable[[Wheel], float | None]


def _line(part: BoundaryPart, plane: Plane) -> _Line:
    def boundary(holds: Callable[[Wheel], bool]) -> Boundary:
        return Boundary(lambda point: holds(plane.at_logarithms(point)))

    if part == "Hopf":
        return _Line(
            boundary(lambda wheel: above_hopf(wheel) > 0.0),
            None,
            {"Bautin": lambda wheel: hopf(wheel).l1},
            lambda wheel: 2 * pi / hopf(wheel).omega,
        )
    return _Line(
        boundary(rolls),
        boundary(lambda wheel: rolls(wheel, _FARTHER * NEAR, _FINER * FINENESS)),
        {
            "neutral saddle": _saddle_quantity,
            "crosses Hopf": above_hopf,
        },
        lambda _: None,
    )


def rolls(wheel: Wheel, near: float = NEAR, fineness: float = FINENESS) -> bool:
    """Whether a wheel passes the next saddle (see `passes`).

    One that takes too long to leave its saddle to be followed, as its neurons hardly act, does not.
    """
    try:
        return passes(wheel, near, fineness)
    except WrongUse:
        return False


def _saddle_quantity(wheel: Wheel) -> float:
    left = saddle(wheel)
    assert left is not None  # there is no dry friction
    return float(left.eigenvalues[0].real + left.eigenvalues[1].real)


def boundary_rows(part: BoundaryPart, plane: Plane) -> list[Measured]:
    """The pieces of a line in a plane, and its special points."""
    line = _line(part, plane)
    rows: list[Measured] = []
    for piece, (points, whole) in enumerate(_pieces(line.boundary, plane)):
        for point in points:
            x, y = np.exp(point).tolist()
            period_s = line.period_s(plane.at(x, y))
            rows.append(
                {"kind": "point", "type": part, "piece": piece, "x": x, "y": y, "period": period_s}
            )
        if not whole:
            rows.append({"kind": "end", "type": "lost", "on": part, "x": x, "y": y, "gap": None})
        for point, following in pairwise(points):
            rows += _special_rows(part, line, plane, point, following)
    return rows


def _special_rows(
    part: BoundaryPart, line: _Line, plane: Plane, point: Array, following: Array
) -> Iterator[Measured]:
    """The special points between two neighbours."""
    for special, of_wheel in line.specials.items():

        def vanishing(point: Array, of_wheel: Callable[[Wheel], float] = of_wheel) -> float:
            return of_wheel(plane.at_logarithms(point))

        if vanishing(point) * vanishing(following) >= 0.0:
            continue
        there = line.boundary.where(point, following, vanishing)
        off_by = None
        if line.again is not None:
            again = line.again.where(point, following, vanishing)
            off_by = float(np.abs(again - there).max())
        x, y = np.exp(there).tolist()
        yield {"kind": "special", "type": special, "on": part, "x": x, "y": y, "off_by": off_by}


def _pieces(boundary: Boundary, plane: Plane) -> Iterator[tuple[list[Array], bool]]:
    """The pieces of a boundary, from the upper edge down, then from the lower edge up.

    With each, whether it goes as far as an edge.
    """
    x_from, x_to, y_from, y_to = np.log(plane.window).tolist()

    def inside(point: Array) -> float:
        """How far a point is inside the window; negative outside."""
        x, y = point.tolist()
        return float(min(x - x_from, x_to - x, y - y_from, y_to - y))

    reached: list[Array] = []
    for y, direction in ((y_to, -1.0), (y_from, 1.0)):
        ends = np.array([x_from, y]), np.array([x_to, y])
        for first in boundary.crossings(ends, _TRIED):
            if any(np.abs(first - end).max() < _SAME for end in reached):
                continue
            points, whole = list[Array](), False
            with suppress(NotDone):
                for point in boundary.follow(first, np.array([0.0, direction]), _STEP):
                    if points and inside(point) < 0.0:
                        points.append(boundary.where(points[-1], point, inside))
                        whole = True
                        break
                    points.append(point)
            reached.append(points[-1])
            yield points, whole


def relative_gap(plane: Plane, x: float, y: float, least: float, most: float) -> float | None:
    """How far a point is from the merging line in x.

    Args:
        plane: The plane.
        x: The point's x.
        y: The point's y.
        least: The relative distance to look in at first.
        most: The relative distance to look in at most.

    Returns:
        The relative distance; None if there is no merging so close.
    """
    place = np.log([x, y])
    try:
        found = _line("merging", plane).boundary.beside(place, np.array([0.0, 1.0]), least, most)
    except NotDone:
        return None
    return float(abs(found - place)[0])
