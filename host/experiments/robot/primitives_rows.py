"""The table of the experiment `primitives`: its cells, its rows, and the rows of each kind."""

from __future__ import annotations

from typing import Literal, TypedDict


class RoundCell(TypedDict):
    """One round of all transitions.

    Attributes:
        trial: number of the round, from 0.
    """

    part: Literal["round"]
    trial: int


class StartCell(TypedDict):
    """One start from random potentials.

    Attributes:
        trial: number of the start, from 0.
    """

    part: Literal["start"]
    trial: int


class RestCell(TypedDict):
    """One try to rest at one spring constant.

    Attributes:
        k: spring constant (1).
        trial: number of the try, from 0.
    """

    part: Literal["rest"]
    k: float
    trial: int


class Transition(TypedDict):
    """One transition between motion primitives.

    Attributes:
        begin: the primitive from which it goes.
        end: the primitive to which it goes.
        reached: whether the robot reached it.
        kicks: how many kicks were given.
        seconds: how long it took (s).
        k_before: spring constant before the transition (1).
        k: spring constant after it (1).
    """

    kind: Literal["transition"]
    begin: str
    end: str
    reached: bool
    kicks: int
    seconds: float
    k_before: float
    k: float


class Sample(TypedDict):
    """A moment of the first round.

    Attributes:
        t_s: time since the round began (s).
        k: spring constant (1).
        left_hz: speed of the left wheel (turns per second), forward positive.
        right_hz: speed of the right wheel (turns per second), forward positive.
    """

    kind: Literal["sample"]
    t_s: float
    k: float
    left_hz: float
    right_hz: float


class Start(TypedDict):
    """Steady motion of one wheel after a start.

    Attributes:
        side: left or right.
        hz: speed (turns per second), forward positive.
        duty_pct: mean duty cycle without its sign (%).
        ripple: standard deviation of the torque M, as a share of mean |M| (1).
    """

    kind: Literal["start"]
    side: str
    hz: float
    duty_pct: float
    ripple: float


class Rest(TypedDict):
    """One try to rest.

    Attributes:
        runs: whether the robot ran forward at this k before the pulse of k to 0.
        stays: whether it rested after the pulse.
    """

    kind: Literal["rest"]
    runs: bool
    stays: bool


class TransitionRow(RoundCell, Transition):
    """A row of kind `transition`."""


class SampleRow(RoundCell, Sample):
    """A row of kind `sample`."""


class StartRow(StartCell, Start):
    """A row of kind `start`."""


class RestRow(RestCell, Rest):
    """A row of kind `rest`."""


PrimitivesCell = RoundCell | StartCell | RestCell
PrimitivesRow = TransitionRow | SampleRow | StartRow | RestRow
CellRows = list[Transition | Sample] | list[Start] | list[Rest]


def transitions(
    rows: list[PrimitivesRow], begin: str | None = None, end: str | None = None
) -> list[TransitionRow]:
    """The tries of the transitions from a primitive, or to one, or of all."""
    tries = [row for row in rows if row["kind"] == "transition"]
    return [row for row in tries if begin in (None, row["begin"]) and end in (None, row["end"])]


def samples(rows: list[PrimitivesRow]) -> list[SampleRow]:
    """The moments of the first round."""
    return [row for row in rows if row["kind"] == "sample"]


def start_rows(rows: list[PrimitivesRow]) -> list[StartRow]:
    """The wheels after random starts."""
    return [row for row in rows if row["kind"] == "start"]


def rests(rows: list[PrimitivesRow], k: float, what: Literal["runs", "stays"]) -> tuple[int, int]:
    """(how often the robot runs or stays at rest at this k, how many tries)."""
    tries = [row for row in rows if row["kind"] == "rest" and row["k"] == k]
    return sum(row[what] for row in tries), len(tries)
