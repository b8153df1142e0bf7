"""What this robot's motors are like: a drive, and a motor for sim:// that behaves as they do.

The drive pushes the robot forth and back by steps of duty, from rest to rest. Now and then a duty
that rises slowly shows where friction lets go. At the end the robot runs as in the paper: that
stretch is not fitted, but predicted.
"""

from __future__ import annotations

from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.experiments.robot.calibrate_drive import (
    BATTERY_S,
    PLAIN,
    REST_S,
    STIFF,
    Marks,
    drive_about,
)
from host.experiments.robot.calibrate_rows import (
    CHECK,
    RAMP,
    STEPS,
    Cell,
    Row,
    Tick,
    base,
    drive_of,
    kinds,
    voltage,
)
from host.experiments.robot.identification import Drive, break_away, follow, identify, middle
from host.experiments.robot.motor_traits import constants_of
from host.experiments.robot.motors_entry import Check, entry
from host.kicking.robot_motor import model_of
from host.logs.log import Log
from host.runs.contract import Findings, Options, Setting
from robot.kicks import PHASE, WHEELS
from sim_motor.constants import Constants, load

simulate = None

RUN_S = 3.0


class Numbers(TypedDict):
    """What was found, by wheel.

    Attributes:
        battery_v: voltage of the battery at rest (V).
        traits: the motor's traits, as in motor_traits.Traits.
        intervals: where each trait lies with a confidence of 95 %.
        rms_deg: rms error of the fitted angles (degrees).
        check: how well the run as in the paper is predicted.
    """

    battery_v: float
    traits: dict[str, dict[str, float]]
    intervals: dict[str, dict[str, list[float]]]
    rms_deg: dict[str, float]
    check: dict[str, Check]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """One drive: all of it is of the same robot, with the same battery."""
    return [{"drive": 1}]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor, with a metre to go forward and as much backward."""
    return {}


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Tick]:
    """Do the drive, and leave the robot stopped with its own parameters."""
    before = robot.status()["params"]
    try:
        robot.set(max_duty_pct=0.0, **STIFF, **PLAIN)
        robot.wait(REST_S)
        first = len(log)
        seconds = setting.options["seconds"] - BATTERY_S - 2 * RUN_S
        top_pct = int(before["max_duty_pct"])
        marks = drive_about(robot, log, seconds, setting.seed_of(cell), top_pct)
        robot.wait(BATTERY_S)
        battery_v = robot.status()["battery_v"]
        marks.append((len(log), CHECK))
        robot.stop()
        robot.set(**{**before, **PLAIN})
        robot.start()
        robot.wait(RUN_S)
        robot.kick(PHASE)
        robot.wait(RUN_S)
        end = len(log)
    finally:
        robot.stop()
        robot.set(**before)
    return _ticks(log, marks, before, battery_v, model_of(robot))[first:end]


def _ticks(
    log: Log, marks: Marks, params: dict[str, Any], battery_v: float | None, motor: str
) -> list[Tick]:
    """All ticks of the log; their angles are the middles of what the readings stand for."""
    log = log.until_now()
    starts = np.array([place for place, _ in marks])
    stretches = np.maximum(np.searchsorted(starts, np.arange(len(log)), side="right") - 1, 0)
    left_deg, right_deg = (
        np.degrees(middle(log.column(side + "_phi_rad"), params["polarity_" + side])).round(3)
        for side in WHEELS
    )
    date = str(log.info["started_utc"])[:10]
    return [
        {
            "stretch": stretch,
            "kind": marks[stretch][1],
            "t_s": record.t_s,
            "left_deg": left,
            "left_duty_pct": record.left_duty_pct,
            "right_deg": right,
            "right_duty_pct": record.right_duty_pct,
            "battery_v": battery_v,
            "motor": motor,
            "date": date,
        }
        for stretch, record, left, right in zip(
            stretches.tolist(), log.records, left_deg.tolist(), right_deg.tolist(), strict=True
        )
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """Each wheel's traits, how well they predict the run as in the paper, and a motors file."""
    published, battery_v, kind = load(base(rows)), voltage(rows), kinds(rows)
    found, check = {}, {}
    for side in WHEELS:
        drive = drive_of(rows, side)
        static = break_away(drive, np.unique(drive.stretches[kind == RAMP]).tolist())
        found[side] = identify(drive, kind == STEPS, static, published, battery_v)
        constants = constants_of(found[side].traits, published, battery_v)
        check[side] = _check(drive, kind == CHECK, constants)
    numbers: Numbers = {
        "battery_v": battery_v,
        "traits": {side: one.traits._asdict() for side, one in found.items()},
        "intervals": {
            side: {name: list(bounds) for name, bounds in one.intervals.items()}
            for side, one in found.items()
        },
        "rms_deg": {side: one.rms_deg for side, one in found.items()},
        "check": check,
    }
    motors = entry(found, check, rows, battery_v)
    return Findings([], numbers, {"motors.toml": motors})


def _check(drive: Drive, run: NDArray[np.bool_], constants: Constants) -> Check:
    """Compare the model with a run that was not fitted."""
    angles, truth = follow(drive, constants)[run], drive.angles[run]
    way, true_way = (float(np.abs(np.diff(phi)).sum()) for phi in (angles, truth))
    rms_rad = np.sqrt(np.mean((angles - truth) ** 2))
    return {"rms_deg": float(np.degrees(rms_rad)), "way": way / true_way - 1.0}
