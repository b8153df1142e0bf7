"""The cells and rows of the study `orbit`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby
from typing import Literal, TypedDict

from host.theory.studies.section_rows import MotionColumns

# The constant rises or falls.
Way = Literal["up", "down"]
WAYS: tuple[Way, ...] = ("up", "down")


class OrbitCell(TypedDict):
    """Some values of the constant, one after the other.

    Attributes:
        way: up, the constant rises; down, it falls.
        first: number of the first value on this way.
    """

    way: Way
    first: int


class OrbitPoint(MotionColumns):
    """A point on the section at a value of the constant; one row for a wheel that has none.

    Attributes:
        value: of the constant that is varied, in its unit.
        number: number of the point.
        section_x2: x2 of the point (1).
        section_phi: phi of the point (rad).
        section_omega: omega of the point (rad/s).
    """

    value: float
    number: int
    section_x2: float | None
    section_phi: float | None
    section_omega: float | None


class OrbitRow(OrbitCell, OrbitPoint):
    """A row of the table."""


def motions_along(rows: Iterable[OrbitRow], way: Way) -> list[OrbitRow]:
    """The first row of each value on a way, in the order of the values, ascending."""
    own = sorted((row for row in rows if row["way"] == way), key=lambda row: row["value"])
    return [next(group) for _, group in groupby(own, key=lambda row: row["value"])]
