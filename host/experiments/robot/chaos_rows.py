"""The table of the experiment `chaos`: its cells, its rows, and the rows of each part.

A row in the table has its cell's columns and those that were measured. The columns `part` and
`condition` stand in most cells: `part` names the kind of the row, and `condition` is a key of
switching.CONDITIONS.
"""

from __future__ import annotations

from math import pi
from typing import Literal, TypedDict

import numpy as np

from host.experiments.robot.switching import SWITCHES, Array, switches


class SeriesCell(TypedDict):
    """One wheel, tick by tick; on a robot, both of its wheels.

    Attributes:
        condition: name of the condition.
    """

    part: Literal["series"]
    condition: str


class LivesCell(TypedDict):
    """Many wheels, each until it stops switching.

    Attributes:
        condition: name of the condition.
    """

    part: Literal["lives"]
    condition: str


class SpeedCell(TypedDict):
    """Some wheels in steady motion at k = 8, tau = 0.25 s.

    Attributes:
        condition: name of the condition.
    """

    part: Literal["speed"]
    condition: str


class TwinsCell(TypedDict):
    """Pairs of runs that differ by a jump of the potential x1.

    Attributes:
        condition: name of the condition.
        jump: how far x1 jumps (1).
    """

    part: Literal["twins"]
    condition: str
    jump: float


class MapCell(TypedDict):
    """Wheels on bodies with one lag of the rods and one voltage of the battery.

    Attributes:
        rod_lag_s: how much older the rods' positions are than the angle in F_tan (s).
        battery_v: open-circuit voltage of the battery (V).
    """

    part: Literal["map"]
    rod_lag_s: float
    battery_v: float


class ModelCell(TypedDict):
    """Runs of the paper's model of a wheel.

    Attributes:
        wheel: whose moment of inertia and friction: the paper's or this robot's.
        bounded: whether the torque M drives it; otherwise the force F_tan does.
    """

    part: Literal["model"]
    wheel: Literal["paper", "robot"]
    bounded: bool


class Sample(TypedDict):
    """One tick of one wheel.

    Attributes:
        side: left or right.
        t_s: time since the start (s).
        phi_rad: the wheel's angle (rad), forward positive.
        force: tangential force F_tan (1).
        torque: relative torque M (1).
    """

    side: str
    t_s: float
    phi_rad: float
    force: float
    torque: float


class Ending(TypedDict):
    """How one wheel ended.

    Attributes:
        until_s: time of its last switch (s); 0 if it never switched.
        end: what it did in the end: switches, rolls or rests.
    """

    until_s: float
    end: str


class Life(Ending):
    """One wheel from its start to the end of the run.

    Attributes:
        switches: how often it changed its direction.
    """

    switches: int


class Speed(TypedDict):
    """One wheel in steady motion.

    Attributes:
        turns_per_s: turns per second (Hz), without sign.
    """

    turns_per_s: float


class Distance(TypedDict):
    """How far apart two twins are at one time.

    Attributes:
        start: number of the pair.
        since_s: time since the jump (s).
        distance: distance of their potentials (x1, x2) (1).
    """

    start: int
    since_s: float
    distance: float


class MapWheel(TypedDict):
    """One wheel of the map.

    Attributes:
        end: what it did in the end, as in Ending.
        parted: whether its twin was far from it in the end.
    """

    end: str
    parted: bool


class ModelRun(Ending):
    """One run of the model.

    Attributes:
        moment: moment of inertia I (s^2).
        friction: friction f (s).
    """

    moment: float
    friction: float


class SeriesRow(SeriesCell, Sample):
    """A row of part `series`."""


class LifeRow(LivesCell, Life):
    """A row of part `lives`."""


class SpeedRow(SpeedCell, Speed):
    """A row of part `speed`."""


class TwinsRow(TwinsCell, Distance):
    """A row of part `twins`."""


class MapRow(MapCell, MapWheel):
    """A row of part `map`."""


class ModelRow(ModelCell, ModelRun):
    """A row of part `model`."""


ChaosCell = SeriesCell | LivesCell | SpeedCell | TwinsCell | MapCell | ModelCell
ChaosRow = SeriesRow | LifeRow | SpeedRow | TwinsRow | MapRow | ModelRow
CellRows = (
    list[Sample] | list[Life] | list[Speed] | list[Distance] | list[MapWheel] | list[ModelRun]
)


def series_of_wheels(rows: list[ChaosRow]) -> dict[tuple[str, str], list[SeriesRow]]:
    """The ticks of each wheel of the part `series`, by (condition, side)."""
    wheels: dict[tuple[str, str], list[SeriesRow]] = {}
    for row in rows:
        if row["part"] == "series":
            wheels.setdefault((row["condition"], row["side"]), []).append(row)
    return wheels


def lives_rows(rows: list[ChaosRow], condition: str) -> list[LifeRow]:
    """The rows of part `lives` under a condition."""
    return [row for row in rows if row["part"] == "lives" and row["condition"] == condition]


def speed_rows(rows: list[ChaosRow], condition: str) -> list[SpeedRow]:
    """The rows of part `speed` under a condition."""
    return [row for row in rows if row["part"] == "speed" and row["condition"] == condition]


def twins_rows(rows: list[ChaosRow]) -> dict[tuple[str, float], list[TwinsRow]]:
    """The rows of part `twins`, by (condition, jump)."""
    twins: dict[tuple[str, float], list[TwinsRow]] = {}
    for row in rows:
        if row["part"] == "twins":
            twins.setdefault((row["condition"], row["jump"]), []).append(row)
    return twins


def map_rows(rows: list[ChaosRow]) -> dict[tuple[float, float], list[MapRow]]:
    """The rows of part `map`, by (lag of the rods in s, voltage of the battery)."""
    places: dict[tuple[float, float], list[MapRow]] = {}
    for row in rows:
        if row["part"] == "map":
            places.setdefault((row["rod_lag_s"], row["battery_v"]), []).append(row)
    return places


def model_rows(rows: list[ChaosRow]) -> dict[tuple[str, bool], list[ModelRow]]:
    """The rows of part `model`, by (wheel, bounded)."""
    models: dict[tuple[str, bool], list[ModelRow]] = {}
    for row in rows:
        if row["part"] == "model":
            models.setdefault((row["wheel"], row["bounded"]), []).append(row)
    return models


def angles_rad(series: list[SeriesRow]) -> Array:
    """A wheel's angles (rad), (ticks,)."""
    return np.array([row["phi_rad"] for row in series])


def intervals_s(series: list[SeriesRow]) -> Array:
    """The times (s) between a wheel's switches."""
    times = np.array([row["t_s"] for row in series])
    return np.diff(times[switches(angles_rad(series))])


def turning_points_rad(series: list[SeriesRow]) -> Array:
    """The angles at which a wheel switched, modulo pi/2, after which the two rods pull alike."""
    phi = angles_rad(series)
    return phi[switches(phi)] % (pi / 2)


def is_chaotic(row: MapRow) -> bool:
    """Whether a wheel of the map is chaotic: it switches to the end, and its twin parts from it."""
    return row["end"] == SWITCHES and row["parted"]
