"""The cells and rows of the study `lines`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.bifurcations import BifurcationType
from host.theory.analysis.chaos_edges import Side
from host.theory.analysis.cycle_lines import LineEnd, Mark
from host.theory.analysis.phases import Phase

CyclePart = Literal["FB", "LLM"]
BoundaryPart = Literal["Hopf", "merging"]
Part = BoundaryPart | CyclePart | Literal["windows"]
PARTS: tuple[BoundaryPart | CyclePart, ...] = ("Hopf", "merging", "FB", "LLM")
LineType = BoundaryPart | BifurcationType
SpecialType = Literal["Bautin", "neutral saddle"] | Mark


class PhasesCell(TypedDict):
    """Phases at some values of y.

    Attributes:
        first: number of the first of these values.
    """

    part: Literal["phases"]
    first: int


class BandCell(TypedDict):
    """The lines of one kind in a band of the plane.

    Attributes:
        part: Hopf; merging; FB and LLM, bifurcations of forth-and-back cycles and of rotations;
            windows, those of attracting cycles of several crossings.
        band: number of the band, from the top. Bands of windows are equally high, those of the
            other lines have equal ratios of y.
    """

    part: Part
    band: int


class ChaosCell(TypedDict):
    """The crises at one y.

    Attributes:
        number: number of this y, from the bottom.
    """

    part: Literal["chaos"]
    number: int


class ChaosEdgePoint(TypedDict):
    """A crisis, by bisection (see host.theory.analysis.chaos_edges).

    Attributes:
        side: lower if chaos lasts at greater x, upper if at less.
        x: the constant on the axis x, halfway between the other two (in its unit).
        y: the constant on the axis y (in its unit).
        leaves: the closest x at which a wheel leaves chaos (in its unit).
        stays: the closest x at which none does (in its unit).
    """

    kind: Literal["chaos"]
    side: Side
    x: float
    y: float
    leaves: float
    stays: float


class PhasePoint(TypedDict):
    """What a wheel does that starts beside rest.

    Attributes:
        x: the constant on the axis x (in its unit).
        y: the constant on the axis y (in its unit).
        phase: S, FB, LLM or C (see host.theory.analysis.phases).
    """

    kind: Literal["phase"]
    x: float
    y: float
    phase: Phase


class LinePoint(TypedDict):
    """A point of a line.

    Attributes:
        type: of the line.
        piece: number of the piece of a line within its band; its points are in order.
        x: the constant on the axis x (in its unit).
        y: the constant on the axis y (in its unit).
        period: of the cycles (s); None at a merging, where it is infinite.
    """

    kind: Literal["point"]
    type: LineType
    piece: int
    x: float
    y: float
    period: float | None


class CycleLinePoint(LinePoint):
    """A point of a line of cycles, with a state of its cycle.

    Attributes:
        x1: potential at phi = 0 (1).
        x2: potential at phi = 0 (1).
        omega: angular velocity at phi = 0 (rad/s).
        crossings: how often it comes to a multiple of a quarter turn until it repeats itself, up to
            the symmetries.
        quarters: the quarter turns that it has then made.
    """

    x1: float
    x2: float
    omega: float
    crossings: int
    quarters: int


class SpecialPoint(TypedDict):
    """A special point of a line.

    Attributes:
        type: Bautin, cycles are born stable on one side of it and unstable on the other; neutral
            saddle, the saddle quantity vanishes at the merging; or what is special on a line of
            cycles (see host.theory.analysis.cycle_lines).
        on: type of the line.
        x: the constant on the axis x (in its unit).
        y: the constant on the axis y (in its unit).
        off_by: greatest relative difference of x and y if located with shorter time steps; None
            where no time steps are taken.
    """

    kind: Literal["special"]
    type: SpecialType
    on: LineType
    x: float
    y: float
    off_by: float | None


class EndPoint(TypedDict):
    """The end of a piece.

    Attributes:
        type: why it ends (see host.theory.analysis.cycle_lines).
        on: type of the line.
        x: the constant on the axis x (in its unit).
        y: the constant on the axis y (in its unit).
        gap: relative distance to the line where the piece ends: to the merging line in x, to the
            Hopf line in k; None where it ends on neither.
    """

    kind: Literal["end"]
    type: LineEnd
    on: LineType
    x: float
    y: float
    gap: float | None


class PhaseRow(PhasesCell, PhasePoint):
    """A row for a phase."""


class ChaosEdgeRow(ChaosCell, ChaosEdgePoint):
    """A row for a crisis."""


class PointRow(BandCell, LinePoint):
    """A row for a point of a line."""


class CyclePointRow(BandCell, CycleLinePoint):
    """A row for a point of a line of cycles."""


class SpecialRow(BandCell, SpecialPoint):
    """A row for a special point."""


class EndRow(BandCell, EndPoint):
    """A row for the end of a piece."""


LinesCell = PhasesCell | ChaosCell | BandCell
Measured = LinePoint | CycleLinePoint | SpecialPoint | EndPoint
LinesRow = PhaseRow | ChaosEdgeRow | PointRow | CyclePointRow | SpecialRow | EndRow


def phases_of(rows: Iterable[LinesRow]) -> list[PhaseRow]:
    """The phases."""
    return [row for row in rows if row["kind"] == "phase"]


def chaos_edges_of(rows: Iterable[LinesRow]) -> list[ChaosEdgeRow]:
    """The crises."""
    return [row for row in rows if row["kind"] == "chaos"]


def points_of(rows: Iterable[LinesRow]) -> list[PointRow | CyclePointRow]:
    """The points of all lines."""
    return [row for row in rows if row["kind"] == "point"]


def specials_of(rows: Iterable[LinesRow]) -> list[SpecialRow]:
    """The special points."""
    return [row for row in rows if row["kind"] == "special"]


def ends_of(rows: Iterable[LinesRow]) -> list[EndRow]:
    """The ends of pieces that are no mere edges of a band."""
    return [row for row in rows if row["kind"] == "end"]
