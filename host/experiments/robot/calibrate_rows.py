"""The table of the experiment `calibrate`: its rows, and what a wheel's drive is in them."""

from __future__ import annotations

from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from host.experiments.robot.identification import Drive
from host.kicking.robot_motor import EV3_ENTRY, known_entry
from sim_motor.constants import load

Kind = Literal["warm-up", "steps", "ramp", "check"]
WARM_UP: Kind = "warm-up"
STEPS: Kind = "steps"
RAMP: Kind = "ramp"
CHECK: Kind = "check"


class Cell(TypedDict):
    """The one drive.

    Attributes:
        drive: 1.
    """

    drive: int


class Tick(TypedDict):
    """One tick of the drive.

    Attributes:
        stretch: number of the stretch from rest to rest, from 0.
        kind: what happens in the stretch.
        t_s: the robot's clock (s).
        left_deg: angle of the left wheel (degrees), the middle of what its reading stands for.
        left_duty_pct: duty cycle of the left motor (%).
        right_deg: angle of the right wheel (degrees).
        right_duty_pct: duty cycle of the right motor (%).
        battery_v: voltage of the battery at rest (V); None if the robot cannot measure it.
        motor: the model of its motors; empty if the robot does not say it.
        date: when the drive was done (UTC).
    """

    stretch: int
    kind: Kind
    t_s: float
    left_deg: float
    left_duty_pct: int
    right_deg: float
    right_duty_pct: int
    battery_v: float | None
    motor: str
    date: str


class Row(Cell, Tick):
    """A tick with its cell's column."""


def voltage(rows: list[Row]) -> float:
    """The battery's voltage at rest (V), or the nominal one if the robot cannot measure it."""
    measured = rows[0]["battery_v"]
    return load(base(rows)).battery_v if measured is None else measured


def base(rows: list[Row]) -> str:
    """The entry that says what a log does not: the motor's own, or the EV3's if it has none."""
    return known_entry(rows[0]["motor"]) or EV3_ENTRY


def drive_of(rows: list[Row], side: str) -> Drive:
    """The drive of the left or the right wheel."""
    left = side == "left"
    angles = [row["left_deg"] if left else row["right_deg"] for row in rows]
    duties = [row["left_duty_pct"] if left else row["right_duty_pct"] for row in rows]
    return Drive(
        np.array([row["t_s"] for row in rows]),
        np.radians(angles),
        np.array(duties),
        np.array([row["stretch"] for row in rows]),
    )


def kinds(rows: list[Row]) -> NDArray[np.str_]:
    """Each row's kind of stretch."""
    return np.array([row["kind"] for row in rows])
