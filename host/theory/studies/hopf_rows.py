"""The cells and rows of the study `hopf`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict


class PointCell(TypedDict):
    """The wheel itself."""

    part: Literal["point"]


class LineCell(TypedDict):
    """The wheel with other time constants.

    Attributes:
        part: line, around the wheel's own; limit, where the paper's estimate is meant to hold.
    """

    part: Literal["line", "limit"]


class Bifurcation(TypedDict):
    """The Hopf bifurcation of a resting wheel in k.

    Attributes:
        tau: time constant of the membrane potentials (s).
        k_hopf: spring constant above which rest is unstable.
        omega_hopf: angular frequency of the cycles that are born there (rad/s).
        l1: first Lyapunov coefficient; negative if the cycles are born stable.
        k_estimate: the paper's estimate of k_hopf, 2 f / (a tau).
    """

    tau: float
    k_hopf: float
    omega_hopf: float
    l1: float
    k_estimate: float


class CheckedBifurcation(Bifurcation):
    """The bifurcation, and the same by another method.

    Attributes:
        k_by_eigenvalues: k_hopf by searching where eigenvalues cross the imaginary axis.
    """

    k_by_eigenvalues: float


class PointRow(PointCell, CheckedBifurcation):
    """The row for the wheel itself."""


class LineRow(LineCell, Bifurcation):
    """A row for another time constant."""


HopfCell = PointCell | LineCell
HopfRow = PointRow | LineRow


def point_of(rows: Iterable[HopfRow]) -> PointRow:
    """The row for the wheel itself."""
    return next(row for row in rows if row["part"] == "point")


def line_of(rows: Iterable[HopfRow]) -> list[LineRow]:
    """The rows of the line, in the order of tau."""
    return [row for row in rows if row["part"] == "line"]


def limit_of(rows: Iterable[HopfRow]) -> LineRow:
    """The row where the paper's estimate is meant to hold."""
    return next(row for row in rows if row["part"] == "limit")
