"""The cells and rows of the study `edge`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.least_push import PushKind

Role = Literal["least", "edge", "forward", "backward"]
LEAST: Role = "least"
EDGE: Role = "edge"
FORWARD: Role = "forward"
BACKWARD: Role = "backward"


class MapCell(TypedDict):
    """The least pushes of one kind, in all directions, at some phases of rolling.

    Attributes:
        push: what is pushed: potentials or speed.
        band: the number of the first moment, of 1024 in a quarter turn.
    """

    part: Literal["map"]
    push: PushKind
    band: int


class LeastCell(TypedDict):
    """The least push of one kind, and where the edge leads from there.

    Attributes:
        push: what is pushed: potentials or speed.
    """

    part: Literal["least"]
    push: PushKind


class Threshold(TypedDict):
    """The least push in one direction at one phase.

    Attributes:
        phase_deg: phase of rolling, the angle within a quarter turn (degrees).
        direction_deg: direction of the push in the plane of x1 and x2 (degrees); for the speed 0 is
            forward and 180 backward.
        amplitude: the least that reverses, to 0.1 % of the greatest that is tried: without unit,
            or in rad/s; None if none does that was tried.
        x1: the first potential before the push (1).
        x2: the second (1).
        omega: the speed before the push (rad/s).
    """

    phase_deg: float
    direction_deg: float
    amplitude: float | None
    x1: float
    x2: float
    omega: float


class Course(TypedDict):
    """A state at or after the least push.

    Attributes:
        role: least, just after the least push; edge, on the edge; forward and backward, on either
            side of it after a wheel has left it.
        t_s: time since the push (s).
        x1: first membrane potential (1).
        x2: second membrane potential (1).
        phi: angle (rad).
        omega: angular velocity (rad/s).
        amplitude: of the least push (1, or rad/s); None on a course.
        error: how far the amplitude may be off (1, or rad/s); None on a course.
        phase_deg: the phase of the push (degrees); None on a course.
        direction_deg: its direction, as in a map (degrees); None on a course.
    """

    role: Role
    t_s: float
    x1: float
    x2: float
    phi: float
    omega: float
    amplitude: float | None
    error: float | None
    phase_deg: float | None
    direction_deg: float | None


class MapRow(MapCell, Threshold):
    """A row of a map."""


class CourseRow(LeastCell, Course):
    """A row of a least push, or of a course after it."""


EdgeCell = MapCell | LeastCell
EdgeRow = MapRow | CourseRow
Measured = list[Threshold] | list[Course]


def map_of(rows: Iterable[EdgeRow], push: PushKind) -> list[MapRow]:
    """The map of a push, by phase and direction."""
    return [row for row in rows if row["part"] == "map" and row["push"] == push]


def course_of(rows: Iterable[EdgeRow], push: PushKind, role: Role) -> list[CourseRow]:
    """A course after the least push, by time."""
    return [
        row for row in rows if row["part"] == "least" and (row["push"], row["role"]) == (push, role)
    ]


def least_of(rows: Iterable[EdgeRow], push: PushKind) -> CourseRow | None:
    """The least push; None if none reverses."""
    return next(iter(course_of(rows, push, LEAST)), None)
