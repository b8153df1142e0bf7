"""The cell and rows of the study `portrait`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.fixpoints import Kind
from host.theory.analysis.phases import Phase

LinePart = Literal["unstable manifold", "limit cycle", "stable manifold", "trajectory"]


class PortraitCell(TypedDict):
    """One portrait.

    Attributes:
        k: spring constant of the rods.
    """

    k: float


class Point(TypedDict):
    """A point of a portrait.

    Attributes:
        part: the line that the point belongs to; for a fixpoint its kind.
        line: number of the line among those of its part, or of the fixpoint.
        phi: angle (rad).
        omega: angular velocity (rad/s).
    """

    part: Kind | LinePart
    line: int
    phi: float
    omega: float


class Summary(TypedDict):
    """What a portrait shows.

    Attributes:
        kind: what the wheel does in the end: S it rests, FB it rolls forth and back, LLM it rolls
            one way, C it is chaotic.
        fastest: greatest speed shown (rad/s).
        manifold_off_by: by how much the unstable manifolds change with half the step (rad).
        crosses: whether the forward one passes the next saddle.
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
