"""The lines of bifurcations of cycles in the study `lines`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from itertools import count
from typing import NamedTuple

import numpy as np

from host.errors import NotDone, WrongUse
from host.theory.analysis.bifurcations import BifurcationType
from host.theory.analysis.branches import rotations, swings
from host.theory.analysis.continuation import Point
from host.theory.analysis.cycle_lines import CycleLine, Traced, Window, joined, trace
from host.theory.analysis.cycles import FORTH_AND_BACK, ROTATION, Family
from host.theory.analysis.hopf import above_hopf
from host.theory.analysis.merging import passes
from host.theory.model.wheel import Array, Wheel
from host.theory.studies.lines_boundaries import relative_gap
from host.theory.studies.lines_plane import Plane
from host.theory.studies.lines_rows import CyclePart, Measured

# A line that comes back to a crossing of an edge is the same as the one that begins there.
_SAME = 1e-4
# Values of x with which a branch may begin.
_BEGINNINGS = 16
# How far (relative) from a line the merging is looked for.
_NEAREST, _FARTHEST = 1e-8, 1e-2


class _Crossing(NamedTuple):
    """Where a line of cycles crosses an edge: the type of bifurcation, and the cycle, (6,)."""

    type: BifurcationType
    unknowns: Array


@cache
def _crossings(
    part: CyclePart, wheel: Wheel, axes: tuple[str, str], x_from: float, x_to: float
) -> list[_Crossing]:
    """The bifurcations of one family along x; y is that of the wheel.

    Neighbouring bands share them.
    """
    find = swings if part == "FB" else rotations
    for least in np.geomspace(x_from, x_to, _BEGINNINGS, endpoint=False).tolist():
        with suppress(WrongUse):  # wheels are too slow there to be followed
            passes(wheel._replace(**{axes[0]: least}))
            break
    try:
        branches = find(wheel, axes[0], least, x_to)
    except (NotDone, WrongUse):  # no wheel goes on rolling, or none can be followed
        return []
    y = getattr(wheel, axes[1])
    return [
        _Crossing(found.type, np.append(found.point.unknowns, y))
        for branch in branches
        for way in branch.ways
        for found in way.bifurcations
    ]


def cycle_rows(part: CyclePart, plane: Plane) -> list[Measured]:
    """The lines of one family of cycles in a plane, from its edges."""
    family = FORTH_AND_BACK if part == "FB" else ROTATION
    axes, window = (plane.x, plane.y), plane.window
    rows: list[Measured] = []
    reached: list[_Crossing] = []
    pieces = count()
    for y, direction in ((window.y_to, -1.0), (window.y_from, 1.0)):
        wheel = plane.at(window.x_to, y)
        for crossing in _crossings(part, wheel, axes, window.x_from, window.x_to):
            line = line_through(wheel, family, crossing.type, axes, crossing.unknowns)
            if any(_same(crossing, one) for one in reached):
                continue
            if joined(line, crossing.unknowns):
                x = float(crossing.unknowns[4])
                gap = relative_gap(plane, x, y, _NEAREST, _FARTHEST)
                rows.append(
                    {"kind": "end", "type": "beside", "on": line.type, "x": x, "y": y, "gap": gap}
                )
                continue
            traced = traced_from(line, crossing.unknowns, direction, window)
            reached.append(_Crossing(crossing.type, traced.points[-1].unknowns))
            rows += rows_of(line, plane, traced, next(pieces))
    return rows


def line_through(
    wheel: Wheel, family: Family, type_: BifurcationType, axes: tuple[str, str], unknowns: Array
) -> CycleLine:
    """The line through a cycle, (6,), that bifurcates."""
    scales = np.maximum(np.abs(unknowns), [1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    return CycleLine(wheel, family, type_, axes, scales)


def traced_from(line: CycleLine, unknowns: Array, direction: float, window: Window) -> Traced:
    """The line from a cycle, (6,), on, up or down."""
    try:
        first = line.at(unknowns)
    except NotDone:
        return Traced([Point(unknowns, np.zeros(6))], [], "lost")
    tangent = first.tangent * np.sign(direction * first.tangent[-1])
    return trace(line, first._replace(tangent=tangent), window)


def _same(one: _Crossing, other: _Crossing) -> bool:
    close = np.abs(one.unknowns / other.unknowns - 1)[3:].max() < _SAME
    return one.type == other.type and bool(close)


def rows_of(line: CycleLine, plane: Plane, traced: Traced, piece: int) -> Iterator[Measured]:
    """The rows of a piece of a line."""
    type_, x, y = line.type, 0.0, 0.0
    for point in traced.points:
        x1, x2, omega, seconds, x, y = point.unknowns.tolist()
        yield {
            "kind": "point",
            "type": type_,
            "piece": piece,
            "x": x,
            "y": y,
            "period": line.family.power * seconds,
            "x1": x1,
            "x2": x2,
            "omega": omega,
            "crossings": line.family.crossings,
            "quarters": round(line.family.turn / ROTATION.turn),
        }
    if traced.end != "range":
        gap = None
        if traced.end == "merging":
            gap = relative_gap(plane, x, y, _NEAREST, _FARTHEST)
        elif traced.end == "Hopf line":
            gap = abs(above_hopf(plane.at(x, y)))
        yield {"kind": "end", "type": traced.end, "on": type_, "x": x, "y": y, "gap": gap}
    for special, there, off_by in traced.specials:
        x, y = there.unknowns[4:].tolist()
        yield {"kind": "special", "type": special, "on": type_, "x": x, "y": y, "off_by": off_by}
