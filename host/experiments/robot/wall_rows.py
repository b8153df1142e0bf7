"""The table of the experiment `wall`: conditions, cells, rows, and the hits under a condition."""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict, final

from host.runs import presets
from host.runs.presets import PRESETS
from sim_motor.constants import data

ROBOT = {name: float(entry[0]) for name, entry in data()["robot"].items()}


class Condition(TypedDict):
    """The circumstances of a hit.

    Attributes:
        grip: friction coefficient of the tyres on the floor (1).
        bumper: width of the body's front and rear (m).
        axle: stiffness of the axle of a wheel, at its rim (N/m); None for a rigid one.
        battery_v: open-circuit voltage of the battery (V); None for the run's own.
    """

    grip: float
    bumper: float
    axle: float | None
    battery_v: float | None


class HitsCell(Condition):
    """All hits of the simulated robot under one condition.

    Attributes:
        part: `claim` for the conditions that R13 names, `map` for all others.
        k: spring constant (1).
        hits: how many hits.
    """

    k: float
    part: Literal["claim", "map"]
    hits: int


class OneHit(HitsCell):
    """One of these hits, numbered from 0."""

    hit: int


class SeriesCell(Condition):
    """A simulated robot that bounces to and fro for a while.

    Attributes:
        k: spring constant (1).
    """

    k: float
    part: Literal["series"]


class SeriesRun(SeriesCell):
    """One run of it, numbered from 0."""

    run: int


class TrialCell(TypedDict):
    """One hit of a robot, whose floor and body are as they are.

    Attributes:
        k: spring constant (1).
        hit: number of the hit, from 0.
    """

    k: float
    hit: int


class Hit(TypedDict):
    """How one hit went. None stands for what did not happen.

    Attributes:
        ended: bounced, or how else the hit ended, in words.
        reversed: whether the robot reversed.
        before: mean torque M of both wheels just before the wall (1).
        after: mean torque M of both wheels at the end (1).
        took_s: time from the wall to the reversal (s).
        apart_rad: how far the right wheel's phase was ahead at the wall (rad), from -pi to pi.
    """

    ended: str
    reversed: bool
    before: float | None
    after: float | None
    took_s: float | None
    apart_rad: float | None


class NumberedHit(Hit):
    """A hit with its number.

    Attributes:
        hit: number of the hit, from 0.
    """

    hit: int


class Tick(TypedDict):
    """One tick of a series.

    Attributes:
        t_s: time since the start (s).
        left_torque: relative torque M of the left wheel (1).
        right_torque: relative torque M of the right wheel (1).
        bounce: whether the robot has reversed in this tick.
    """

    t_s: float
    left_torque: float
    right_torque: float
    bounce: bool


class RunTick(Tick):
    """One tick of a series, with the number of its run.

    Attributes:
        run: number of the run, from 0; the first one in which a wall reverses the robot is kept.
    """

    run: int


@final
class HitRow(NumberedHit):
    """A hit with its cell's columns; of those, a real robot's cell has only k.

    Attributes:
        k: spring constant (1).
        grip: friction of the wheels' tyres on the floor (1).
        bumper: width of the robot's front (m).
        axle: stiffness of the wheels' axles at the rim (N/m); None for rigid ones.
        battery_v: open-circuit voltage of the battery (V); None for its nominal one.
        part: claim, the condition of the claim; map, others.
        hits: how many hits its cell has.
    """

    k: float
    grip: NotRequired[float]
    bumper: NotRequired[float]
    axle: NotRequired[float | None]
    battery_v: NotRequired[float | None]
    part: NotRequired[Literal["claim", "map"]]
    hits: NotRequired[int]


@final
class SeriesRow(SeriesCell, RunTick):
    """A row of part `series`."""


WallCell = HitsCell | SeriesCell | TrialCell
WallRow = HitRow | SeriesRow

# The ordinary condition: a rough floor, and wheels that sit on the motors rigidly.
CARPET, SMOOTH = ROBOT["grip_on_carpet"], ROBOT["grip"]
PAPER: Condition = {
    "grip": CARPET,
    "bumper": ROBOT["body_width"],
    "axle": None,
    "battery_v": None,
}
ON_SMOOTH: Condition = {**PAPER, "grip": SMOOTH}
# Among the conditions under which the robot always reverses: a long axle, the roughest carpet in
# the source of `grip_on_carpet`, and a front wider than the body.
_SCENE = PRESETS[presets.PAPER].scene
ON_AXLES: Condition = {
    **PAPER,
    "grip": float(_SCENE["grip"]),
    "bumper": float(_SCENE["bumper"]),
    "axle": float(_SCENE["axle"]),
}


def condition_of(row: WallRow) -> Condition:
    """The condition of a row; what a real robot's row does not say is taken to be the paper's."""
    return {
        "grip": row.get("grip", PAPER["grip"]),
        "bumper": row.get("bumper", PAPER["bumper"]),
        "axle": row.get("axle", PAPER["axle"]),
        "battery_v": row.get("battery_v", PAPER["battery_v"]),
    }


def hits_under(rows: list[WallRow], condition: Condition) -> list[HitRow]:
    """The hits under a condition, in their order."""
    return [row for row in rows if "t_s" not in row and condition_of(row) == condition]


def series_under(rows: list[WallRow], condition: Condition) -> list[SeriesRow]:
    """The ticks of the series under a condition; none if a real robot made the rows."""
    return [row for row in rows if "t_s" in row and condition_of(row) == condition]


def count_bounces(rows: list[HitRow]) -> tuple[int, int]:
    """(reversals, hits)."""
    return sum(row["reversed"] for row in rows), len(rows)
