"""The cell and rows of the study `portrait`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.fixpoints import Kind
from host.theory.analysis.phases import Phase

LinePart = Literal["unstable manifold", "limit cycle", "stable manifold", "trajectory"]


class PortraitCell(TypedDict):
    """One portrait.

    k: spring constant of the rods.
    """

    k: float


class Point(TypedDict):
    """A point of a portrait.

    part: what the point is part of; a fixpoint has its kind here. line: which line of that part, or
    which fixpoint. phi: angle, rad. omega: angular velocity, rad/s.
    """

    part: Kind | LinePart
    line: int
    phi: float
    omega: float


class Summary(TypedDict):
    """What a portrait shows.

    kind: what the wheel does in the end: S it rests, FB it rolls forth and back, LLM it rolls one
    way, C it is chaotic. fastest: the greatest speed shown, rad/s. manifold_off_by: by how much
    (rad) the unstable manifolds change with half the step. crosses: whether the forward one passes
    the next saddle.
    """

    part: Literal["found"]
    kind: Phase
    fastest: float
    manifold_off_by: float
    crosses: bool


class PointRow(PortraitCell, Point):
    """A point, with the k of its portrait."""


class SummaryRow(PortraitCell, Summary):
    """A summary, with the k of its portrait."""


PortraitRow = PointRow | SummaryRow


def summaries(rows: Iterable[PortraitRow]) -> list[SummaryRow]:
    """One row for each portrait."""
    return [row for row in rows if row["part"] == "found"]


def points(rows: Iterable[PortraitRow], k: float) -> list[PointRow]:
    """The points of the portrait with this k."""
    return [row for row in rows if row["part"] != "found" and row["k"] == k]
