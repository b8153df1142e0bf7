"""The cells and rows of the study `escape`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict


class TimesCell(TypedDict):
    """Wheels with one strength of noise.

    Attributes:
        level: number of the strength, from 0, the greatest.
        batch: number of the batch of wheels.
    """

    part: Literal["times"]
    level: int
    batch: int


class CheckCell(TypedDict):
    """Wheels with the greatest noise, in steps half as long."""

    part: Literal["check"]


class Stayed(TypedDict):
    """How long one wheel stayed.

    Attributes:
        noise: white noise of the torque, D_M (sqrt(s)).
        angle_noise: white noise of the angle, D_phi (rad/sqrt(s)).
        time_s: when the wheel escaped, or how long it was followed (s).
        ended: whether it escaped.
    """

    noise: float
    angle_noise: float
    time_s: float
    ended: bool


class TimesRow(TimesCell, Stayed):
    """A row for a wheel."""


class CheckRow(CheckCell, Stayed):
    """A row for a wheel with shorter steps."""


EscapeCell = TimesCell | CheckCell
EscapeRow = TimesRow | CheckRow


def by_level(rows: Iterable[EscapeRow]) -> list[list[TimesRow]]:
    """The wheels of each strength, in the order of the levels."""
    groups: dict[int, list[TimesRow]] = {}
    for row in rows:
        if row["part"] == "times":
            groups.setdefault(row["level"], []).append(row)
    return [groups[level] for level in sorted(groups)]


def checks(rows: Iterable[EscapeRow]) -> list[CheckRow]:
    """The wheels with shorter steps."""
    return [row for row in rows if row["part"] == "check"]
