"""The table of the study `branch`: rows with their cell's columns, and the rows of each kind."""

from __future__ import annotations

from collections.abc import Iterable

from host.theory.studies.branch_rows import (
    BranchCell,
    BranchEnd,
    Cycle,
    CyclePart,
    CyclePoint,
    FormulaEdge,
    HopfPoint,
    LinePoint,
    MergingPoint,
    NeutralPoint,
    NoBranch,
    Part,
    Rest,
    SteppedCycle,
    Turned,
    Way,
)

# A multiplier this close to the unit circle is on it.
_ON_CIRCLE = 1e-6


class RestRow(BranchCell, Rest):
    """A row of kind `fixpoint`."""


class HopfRow(BranchCell, HopfPoint):
    """A row of kind `special`, type `hopf`."""


class MergingRow(BranchCell, MergingPoint):
    """A row of kind `special`, type `merging`."""


class CycleRow(BranchCell, Cycle):
    """A row of kind `cycle`."""


class CyclePointRow(BranchCell, CyclePoint):
    """A row of kind `special`, of a cycle."""


class EndRow(BranchCell, BranchEnd):
    """A row of kind `end`."""


class FormulaEdgeRow(BranchCell, FormulaEdge):
    """A row of kind `edge`."""


class NoBranchRow(BranchCell, NoBranch):
    """A row of kind `end`, type `none`."""


class SteppedCycleRow(BranchCell, SteppedCycle):
    """A row of kind `check`."""


class LineRow(BranchCell, LinePoint):
    """A row of kind `line`."""


class NeutralRow(BranchCell, NeutralPoint):
    """A row of kind `neutral`."""


class TurnedRow(BranchCell, Turned):
    """A row of kind `turning`."""


SpecialRow = HopfRow | MergingRow | CyclePointRow
BranchRow = (
    RestRow
    | HopfRow
    | MergingRow
    | CycleRow
    | CyclePointRow
    | EndRow
    | FormulaEdgeRow
    | NoBranchRow
    | SteppedCycleRow
    | LineRow
    | NeutralRow
    | TurnedRow
)


def rests(rows: Iterable[BranchRow]) -> list[RestRow]:
    """The fixpoints, ascending in value."""
    return [row for row in rows if row["kind"] == "fixpoint"]


def special_points(rows: Iterable[BranchRow]) -> list[SpecialRow]:
    """All bifurcations."""
    return [row for row in rows if row["kind"] == "special"]


def hopfs(rows: Iterable[BranchRow]) -> list[HopfRow]:
    """The Hopf bifurcations, ascending in value."""
    return [row for row in special_points(rows) if row["type"] == "hopf"]


def mergings(rows: Iterable[BranchRow], part: Part) -> list[MergingRow]:
    """The mergings of a part, ascending in value."""
    return [row for row in special_points(rows) if row["type"] == "merging" and row["part"] == part]


def cycle_points(rows: Iterable[BranchRow]) -> list[CyclePointRow]:
    """The bifurcations of cycles."""
    return [
        row for row in special_points(rows) if row["type"] != "hopf" and row["type"] != "merging"
    ]


def folds(rows: Iterable[BranchRow], part: CyclePart) -> list[CyclePointRow]:
    """The folds of a part's branches."""
    return [row for row in cycle_points(rows) if row["part"] == part and row["type"] == "fold"]


def formula_edges(rows: Iterable[BranchRow]) -> list[float]:
    """The values at which the constant-velocity formula begins and ceases to fit, ascending."""
    return sorted(row["value"] for row in rows if row["kind"] == "edge")


def stable_of(rows: Iterable[BranchRow], part: CyclePart) -> list[CycleRow | CyclePointRow]:
    """The stable cycles of a part, with the bifurcations at which their stretches end.

    Ascending in value.
    """
    own = list(rows)
    found: list[CycleRow | CyclePointRow] = [row for row in cycles_of(own, part) if row["stable"]]
    found += [
        row
        for row in cycle_points(own)
        if row["part"] == part and abs(complex(*row["reduced_multipliers"][0])) < 1 + _ON_CIRCLE
    ]
    return sorted(found, key=lambda row: row["value"])


def cycles(rows: Iterable[BranchRow]) -> list[CycleRow]:
    """The cycles of all branches."""
    return [row for row in rows if row["kind"] == "cycle"]


def cycles_of(rows: Iterable[BranchRow], part: CyclePart) -> list[CycleRow]:
    """The cycles of a part's branches."""
    return [row for row in cycles(rows) if row["part"] == part]


def cycles_along(rows: Iterable[BranchRow], part: CyclePart, way: Way) -> list[CycleRow]:
    """The cycles of a part's branches that are followed this way, in their order."""
    return [row for row in cycles_of(rows, part) if row["way"] == way]


def ends(rows: Iterable[BranchRow]) -> list[EndRow | NoBranchRow]:
    """The ends of all branches."""
    return [row for row in rows if row["kind"] == "end"]


def stepped_cycles(rows: Iterable[BranchRow]) -> list[SteppedCycleRow]:
    """The cycles that are compared with time stepping."""
    return [row for row in rows if row["kind"] == "check"]


def merging_line(rows: Iterable[BranchRow]) -> list[LineRow]:
    """The merging over tau, ascending in tau."""
    return [row for row in rows if row["kind"] == "line"]


def neutral_points(rows: Iterable[BranchRow]) -> list[NeutralRow]:
    """Where the saddle quantity at the merging changes its sign."""
    return [row for row in rows if row["kind"] == "neutral"]


def turned_at(rows: Iterable[BranchRow]) -> dict[float, list[TurnedRow]]:
    """The potentials of turning wheels, by k."""
    found: dict[float, list[TurnedRow]] = {}
    for row in rows:
        if row["kind"] == "turning":
            found.setdefault(row["k"], []).append(row)
    return found
