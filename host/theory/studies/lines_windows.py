"""The lines of bifurcations of cycles in windows, in the study `lines`.

Windows are looked for at the middle of a band of y, and their edges are followed up and down to the
edges of the band.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from host.theory.analysis.continuation import Point
from host.theory.analysis.cycle_lines import CycleLine
from host.theory.analysis.windows import window_edges
from host.theory.model.wheel import Array
from host.theory.studies.lines_cycles import line_through, rows_of, traced_from
from host.theory.studies.lines_plane import Plane
from host.theory.studies.lines_rows import Measured

WINDOW_BANDS = 16
# Values of x that are tried.
VALUES = 320
# A line through this close (relative) to a cycle is the line through it.
_SAME = 1e-6


def window_rows(number: int, plane: Plane, rng: np.random.Generator) -> list[Measured]:
    """The lines of one band, the first at the top."""
    height = plane.window.y_to / WINDOW_BANDS
    y_to = plane.window.y_to - number * height
    y, y_from = y_to - height / 2, max(plane.window.y_from, y_to - height)
    window = plane.window._replace(y_from=y_from, y_to=y_to)
    axes, wheel = (plane.x, plane.y), plane.at(window.x_to, y)
    rows: list[Measured] = []
    seen: list[tuple[str, str, Array]] = []
    values = np.linspace(window.x_from, window.x_to, VALUES)
    for edge in window_edges(wheel, plane.x, values, rng):
        unknowns = np.append(edge.unknowns, y)
        own = (edge.family.name, edge.type)
        if any(own == other[:2] and _same(unknowns, other[2]) for other in seen):
            continue
        line = line_through(wheel, edge.family, edge.type, axes, unknowns)
        for direction in (1.0, -1.0):
            traced = traced_from(line, unknowns, direction, window)
            seen += [(*own, cycle) for cycle in _at(line, traced.points, y)]
            rows += rows_of(line, plane, traced, len(seen))
    return rows


def _same(one: Array, other: Array) -> bool:
    return bool(np.abs(one / other - 1.0)[3:].max() < _SAME)


def _at(line: CycleLine, points: list[Point], y: float) -> list[Array]:
    """The cycles, (6,), at which the points of a line cross y, the first among them."""

    def above(point: Point) -> float:
        return float(point.unknowns[5] / y - 1.0)

    return [points[0].unknowns] + [
        line.curve.locate(before, point, above).unknowns
        for before, point in pairwise(points[1:])
        if above(before) * above(point) < 0.0
    ]
