"""The cells and rows of the study `phase-diagram`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.phases import Phase

Panel = Literal["plane", "inset"]
Way = Literal["up", "down", "rest", "roll"]
PANELS: tuple[Panel, ...] = ("plane", "inset")


class BandCell(TypedDict):
    """A band of a panel.

    Attributes:
        panel: the diagram or its inset.
        first: number of the band's first time constant on the panel's axis.
        end: number of its last time constant, plus 1.
    """

    panel: Panel
    first: int
    end: int


class AccuracyCell(TypedDict):
    """A sample of points, each computed with two step sizes."""

    panel: Literal["accuracy"]


class Point(TypedDict):
    """A wheel at one point of the diagram.

    Attributes:
        way: direction of the sweep in k, or the start if k is not swept.
        tau: time constant of the membrane potentials (s).
        k: spring constant.
        omega_mean: mean of omega (rad/s).
        omega_std: standard deviation of omega (rad/s).
        chaotic: 1 in phase C, else 0.
        phase: S, FB, LLM, C or undecided.
    """

    way: Way
    tau: float
    k: float
    omega_mean: float
    omega_std: float
    chaotic: float
    phase: Phase


class StepCheck(TypedDict):
    """A wheel anywhere in the diagram, from rest.

    Attributes:
        tau: time constant of the membrane potentials (s).
        k: spring constant.
        omega_mean: mean of omega (rad/s).
        omega_std: standard deviation of omega (rad/s).
        phase: S, FB, LLM, C or undecided.
        mean_off_by: by how much |omega_mean| changes with finer steps (rad/s).
        std_off_by: by how much omega_std changes with finer steps (rad/s).
    """

    tau: float
    k: float
    omega_mean: float
    omega_std: float
    phase: Phase
    mean_off_by: float
    std_off_by: float


class PointRow(BandCell, Point):
    """A row of the diagram."""


class StepCheckRow(AccuracyCell, StepCheck):
    """A row of the sample."""


PhaseDiagramCell = BandCell | AccuracyCell
PhaseDiagramRow = PointRow | StepCheckRow


def points(rows: Iterable[PhaseDiagramRow]) -> list[PointRow]:
    """The rows of the diagram and its inset."""
    return [row for row in rows if row["panel"] != "accuracy"]


def step_checks(rows: Iterable[PhaseDiagramRow]) -> list[StepCheckRow]:
    """The rows of the sample."""
    return [row for row in rows if row["panel"] == "accuracy"]


def of_panel(rows: Iterable[PointRow], panel: Panel, way: Way | None = None) -> list[PointRow]:
    """The points of a panel, of one way or of all."""
    return [row for row in rows if row["panel"] == panel and way in (None, row["way"])]
