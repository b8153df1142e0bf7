"""What this robot's motors are like, from a drive made for it.

An entry of a motors file with which sim:// behaves as this robot does.

The robot takes no duty cycles, but can be made to: while a pulse of the phase shift holds stiff
rods a quarter turn off centre, the torque is full, its sign is the shift's, and the duty is
max_duty_pct, whatever it is set to. So it is pushed forth and back by steps of duty, from rest to
rest, and now and then a duty that rises slowly shows where friction lets go. At last it runs as in
the paper: that stretch is not fitted, but predicted.
"""

from __future__ import annotations

from math import degrees, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.errors import NotDone
from host.experiments.robot.identification import (
    Drive,
    Found,
    Traits,
    break_away,
    constants_of,
    follow,
    identify,
    middle,
)
from host.logs.log import Log
from host.runs.contract import Cell, Findings, Options, Row, Setting
from robot.kicks import MAX_TICKS, PHASE, PULSE, WHEELS
from robot.loop import BATTERY_TICKS
from sim_motor.motor import Constants, load

simulate = None

WARM_UP, STEPS, RAMP, CHECK = "warm-up", "steps", "ramp", "check"
# Which published motor says what a log does not.
BASE = "pybricks"
NAME = "mine"
ADOPT = "install -D -m 644 motors.toml ~/.config/kickctl/motors.toml"
STIFF: dict[str, Any] = {"k": 100.0, "a": 4.0, "tau_s": 0.06, "tick_s": 0.02, "rods": 2}
PLAIN: dict[str, Any] = {
    "duty_scale": 1.0,
    "battery_compensation": "off",
}  # the duty is what the torque makes it
AIM_S = 0.3  # five of these tau: the potentials have followed the shift
STEP_S = 0.25  # two of the motor's time constants
STEPS_EACH = 3
REST_S = 0.5
RAMP_S = 0.2
RAMP_TOP_PCT = 40
CLEARLY_PCT = 3  # so far above where friction lets go, it surely does
RAMP_EVERY = 3
BATTERY_S = (
    BATTERY_TICKS * STIFF["tick_s"]
)  # after this long at rest there is a reading of a battery at rest
RUN_S = 3.0


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """One drive: all of it is of the same robot, with the same battery."""
    return [{"drive": 1}]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor, with a metre to go forward and as much backward."""
    return {}


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """The drive, one row a tick."""
    before = robot.status()["params"]
    try:
        robot.set(max_duty_pct=0.0, **STIFF, **PLAIN)
        robot.wait(REST_S)
        first = len(log)
        seconds = setting.options["seconds"] - BATTERY_S - 2 * RUN_S
        marks = _drive_about(
            robot, log, seconds, setting.seed_of(cell), int(before["max_duty_pct"])
        )
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
    return _rows(log, marks, before, battery_v)[first:end]


def _drive_about(
    robot: Robot, log: Log, seconds: float, seed: int, top_pct: int
) -> list[tuple[int, str]]:
    """Push forth and back with random steps, for so long.

    Returns where in the log each stretch begins, and of what kind it is.
    """
    rng = np.random.default_rng(seed)
    until_s = log.records[-1].t_s + seconds
    marks = [(len(log), WARM_UP)]
    least_pct = _ramp(robot, 1) + CLEARLY_PCT
    leg = 0
    while log.records[-1].t_s < until_s:
        sign = 1 if leg % 2 == 0 else -1
        if sign > 0:
            there = rng.integers(least_pct, top_pct, (2, STEPS_EACH), endpoint=True).tolist()
        for duties in there:
            marks.append((len(log), STEPS))
            _push(robot, sign, duties)
        leg += 1
        if leg % RAMP_EVERY == 0:
            marks.append((len(log), RAMP))
            _ramp(robot, -sign)
    return marks


def _aim(robot: Robot, sign: int) -> None:
    """From now on the torque is full and of this sign."""
    robot.kick(PULSE, param="shift_rad", value=-sign * pi / 2, ticks=MAX_TICKS)
    robot.wait(AIM_S)


def _release(robot: Robot) -> None:
    """Come to rest, and end the pulse."""
    robot.set(max_duty_pct=0.0)
    robot.wait(REST_S)
    robot.stop()
    robot.start()


def _push(robot: Robot, sign: int, duties: list[int]) -> None:
    _aim(robot, sign)
    for duty in duties:
        robot.set(max_duty_pct=float(duty))
        robot.wait(STEP_S)
    _release(robot)


def _ramp(robot: Robot, sign: int) -> int:
    """Raise the duty until both wheels move. Away from where the wheels came from.

    Then the motor touches its wheel from the start.
    """
    _aim(robot, sign)
    rest = _readings(robot)
    for duty in range(1, RAMP_TOP_PCT + 1):
        robot.set(max_duty_pct=float(duty))
        robot.wait(RAMP_S)
        if all(now != then for now, then in zip(_readings(robot), rest, strict=True)):
            _release(robot)
            return duty
    raise NotDone(
        f"a wheel does not move at {RAMP_TOP_PCT} % duty",
        "are both free and on the floor, and is the battery charged?",
    )


def _readings(robot: Robot) -> list[float]:
    return [getattr(robot.newest, side + "_phi_rad") for side in WHEELS]


def _rows(
    log: Log, marks: list[tuple[int, str]], params: dict[str, Any], battery_v: float | None
) -> list[Row]:
    """One row a tick; angles are the middles of what the readings stand for."""
    starts = np.array([place for place, _ in marks])
    stretches = np.maximum(np.searchsorted(starts, np.arange(len(log)), side="right") - 1, 0)
    columns: dict[str, list[Any]] = {
        "stretch": stretches.tolist(),
        "kind": [marks[stretch][1] for stretch in stretches],
        "t_s": log.column("t_s").tolist(),
    }
    for side in WHEELS:
        columns[side + "_deg"] = (
            np.degrees(middle(log.column(side + "_phi_rad"), params["polarity_" + side]))
            .round(3)
            .tolist()
        )
        columns[side + "_duty_pct"] = log.column(side + "_duty_pct").tolist()
    about = {"battery_v": battery_v, "date": str(log.info["started_utc"])[:10]}
    return [
        {**dict(zip(columns, values, strict=True)), **about}
        for values in zip(*columns.values(), strict=True)
    ]


def voltage(rows: list[Row]) -> float:
    """The battery's voltage (V) at rest, or the nominal one if the robot cannot tell."""
    measured = rows[0]["battery_v"]
    return load(BASE).battery_v if measured is None else float(measured)


def drive_of(rows: list[Row], side: str) -> Drive:
    """A wheel's drive."""
    return Drive(
        np.array([row["t_s"] for row in rows]),
        np.radians([row[side + "_deg"] for row in rows]),
        np.array([row[side + "_duty_pct"] for row in rows]),
        np.array([row["stretch"] for row in rows]),
    )


def kinds(rows: list[Row]) -> NDArray[np.str_]:
    """Each row's kind of stretch."""
    return np.array([row["kind"] for row in rows])


def report(rows: list[Row], setting: Setting) -> Findings:
    """Each wheel's traits and how well they predict the wheel's run as in the paper.

    The entry for both.
    """
    published, battery_v, kind = load(BASE), voltage(rows), kinds(rows)
    found, check = {}, {}
    for side in WHEELS:
        drive = drive_of(rows, side)
        static = break_away(drive, np.unique(drive.stretches[kind == RAMP]).tolist())
        found[side] = identify(drive, kind == STEPS, static, published, battery_v)
        check[side] = _check(
            drive, kind == CHECK, constants_of(found[side].traits, published, battery_v)
        )
    numbers = {
        "battery_v": battery_v,
        "traits": {side: found[side].traits._asdict() for side in WHEELS},
        "intervals": {
            side: {name: list(bounds) for name, bounds in found[side].intervals.items()}
            for side in WHEELS
        },
        "rms_deg": {side: found[side].rms_deg for side in WHEELS},
        "check": check,
    }
    return Findings(
        [], numbers, {"motors.toml": entry(found, check, published, battery_v, rows[0]["date"])}
    )


def _check(drive: Drive, run: NDArray[np.bool_], constants: Constants) -> dict[str, float]:
    """How far (rms, degrees) and by what part of the travelled way the model's angle is off in a run that was not fitted."""
    angles, truth = follow(drive, constants)[run], drive.angles[run]
    ways = [float(np.abs(np.diff(phi)).sum()) for phi in (angles, truth)]
    return {
        "rms_deg": float(np.degrees(np.sqrt(np.mean((angles - truth) ** 2)))),
        "way": ways[0] / ways[1] - 1.0,
    }


def entry(
    found: dict[str, Found],
    check: dict[str, dict[str, float]],
    published: Constants,
    battery_v: float,
    date: str,
) -> str:
    """The table of a motors file for a robot with these wheels: their mean."""
    mean = Traits(*np.mean([one.traits for one in found.values()], axis=0).tolist())
    c = constants_of(mean, published, battery_v)

    def seen(trait: str, unit: str) -> str:
        each = [
            f"{side} {one.intervals[trait][0]:.4g} to {one.intervals[trait][1]:.4g}"
            for side, one in found.items()
        ]
        return (
            f"identified {date} by kickctl experiment calibrate from {trait}: {', '.join(each)}"
            f" {unit}, 95 %"
        )

    unseen = f"as of {BASE}: a log of duties and angles does not show it by itself"
    rows = {
        "torque_constant": (c.torque_constant, "N m/A", unseen),
        "emf_constant": (c.emf_constant, "V s/rad", seen("speed_per_v", "rad/s/V")),
        "resistance": (c.resistance, "ohm", unseen),
        "inductance": (c.inductance, "H", unseen),
        "inertia": (c.motor_inertia, "kg m2", seen("time_constant_s", "s")),
        "viscous_friction": (c.viscous, "N m s/rad", seen("viscous_part", "of the damping")),
        "coulomb_friction": (c.kinetic, "N m", seen("kinetic_pct", "% duty")),
        "break_away_duty": (mean.static_pct, "%", seen("static_pct", "% duty")),
        "backlash": (degrees(c.backlash), "deg", seen("backlash_deg", "deg")),
        "latency": (c.latency_s, "s", seen("delay_ms", "ms with the coil's L/R")),
        "source_resistance": (c.source_resistance, "ohm", seen("sag", "of half the resistance")),
        "battery_voltage": (battery_v, "V", f"the battery at rest, {date}"),
    }
    lines = [
        f'{key} = [{value:.6g}, "{unit}", "{source}"]'
        for key, (value, unit, source) in rows.items()
    ]
    worst, ahead = (
        max(one.rms_deg for one in found.values()),
        max(one["rms_deg"] for one in check.values()),
    )
    head = [
        f"# sim://?motor={NAME} is this robot, once you have said, in this folder: {ADOPT}",
        (
            f"# Off by {worst:.2f} degrees (rms; one count of the encoder makes 0.29) where it was"
            f" fitted, by {ahead:.2f} where it was not."
        ),
    ]
    return "\n".join([*head, f"[{NAME}]", *lines, ""])
