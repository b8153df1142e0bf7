"""Torque and speed against the spring constant k (R5, R6).

The locomotion that ends at k_c, the rest beside it, what lies between.

Four kinds of pieces, told apart by `part`:

- sweep: from locomotion at k = 8, k goes down and up again in small steps, each held until the
  wheels are steady. What differs between
  down and up at the same k is the hysteresis.
- fold: from locomotion at k = 1, k goes down in steps of STEP until both wheels rest. Where each
  falls is one measurement of k_c.
- branch: the limit cycles themselves, stable or not, by control-based continuation. Feedback on k
  holds one wheel at a given speed
  (proportional and integral); once k stays, the wheel is on a limit cycle that exists without the
  feedback at this k. Speed, unlike k,
  goes through the saddle-node without a jump, so both branches come out in one piece, and the least
  k is k_c. Then k is frozen at its
  mean: from a stable cycle nothing follows, an unstable one the wheel leaves, to rest or up. Slow
  cycles pause at each quarter of a
  turn; below some 0.2 Hz friction holds the wheel there, and the branch ends: what parts rest from
  motion beyond is no limit cycle.
- ramp: on a robot at rest, the torque rises until the wheels move (R5).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any

import numpy as np

from host.client.robot import Robot
from host.errors import NotDone
from host.kicking.manoeuvres import ramp
from host.kicking.outcome import require_running
from host.kicking.primitives import drive
from host.kicking.robot_claims import break_away
from host.logs.log import Log
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import spread
from robot.kicks import WHEELS
from robot.record import STATES, Record
from sim_motor.settling import COUNT_RAD

simulate = None

RUNNING = STATES.index("running")

SIGN = {"forward": 1, "backward": -1}
FOLLOWED = {"forward": "left", "backward": "right"}
START_K, MIDDLE_K, LEAST_K = 8.0, 1.0, 0.1
STALL_TORQUE, LEAST_JUMP = 0.1, 0.15
ROUNDS, RAMPS = 3, 5
STEP = 0.985
SPEEDS_HZ = (0.2, 0.22, 0.24, 0.26, 0.28, 0.3, 0.33, 0.36, 0.4, 0.45, 0.5, 0.6, 0.8)
# Steady: the speeds of two successive windows agree to STEADY_WITHIN; k is held for STEADY_PATIENCE
# of them at most.
WINDOW_S, STEADY_WITHIN, STEADY_PATIENCE = 1.0, 0.03, 12
# The feedback on k for each Hz of missing speed; the integral's for each second, too.
PROPORTIONAL, INTEGRAL = 0.5, 0.3
APPROACH_S, LOCK_S, MEASURE_S, RELEASE_S = 8.0, 8.0, 8.0, 10.0
HELD_WITHIN = 0.04
# Speed is measured over a quarter of a turn, after which the rods' pull repeats, so that its ripple
# does not reach k.
QUARTER_RAD, LONGEST_QUARTER_S = pi / 2, 1.5


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Sweeps, descents to the fold and branches, in both directions, and ramps."""
    rounds = [(trial, motion) for trial in range(ROUNDS) for motion in SIGN]
    sweeps: list[Cell] = [
        {"part": "sweep", "motion": motion, "trial": trial} for trial, motion in rounds
    ]
    folds: list[Cell] = [
        {"part": "fold", "motion": motion, "trial": trial} for trial, motion in rounds
    ]
    branch: list[Cell] = [
        {"part": "branch", "motion": motion, "held_hz": hertz}
        for motion in SIGN
        for hertz in SPEEDS_HZ
    ]
    return [*sweeps, *folds, *branch, *({"part": "ramp", "trial": trial} for trial in range(RAMPS))]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def ladder(points: int) -> list[float]:
    """The values of k of a sweep, upwards.

    Half of them (the denser ones) up to MIDDLE_K, half above.
    """
    below = points // 2
    upper = np.geomspace(MIDDLE_K, START_K, points - below)
    return [
        float(k)
        for k in np.round([*np.linspace(LEAST_K, MIDDLE_K, below, endpoint=False), *upper], 4)
    ]


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """One of the pieces. k is at START_K before and after it."""
    if cell["part"] == "ramp":
        span = ramp(robot, log)
        if any(record.state != RUNNING for record in log.records[span.first : span.end]):
            raise NotDone(
                "something stopped the robot while its torque was raised",
                "see its screen and its log, and run the same again",
            )
        found = break_away(log, span)
        return [{"torque": found.measured, "holds": found.holds, "note": found.note}]
    robot.set(k=START_K)
    robot.wait(WINDOW_S)
    drive(robot, log, cell["motion"])
    if cell["part"] == "sweep":
        rows = _sweep(robot, ladder(setting.options["points"]))
    elif cell["part"] == "fold":
        rows = _fold(robot)
    else:
        rows = [_hold(robot, FOLLOWED[cell["motion"]], SIGN[cell["motion"]], cell["held_hz"])]
    require_running(robot)
    robot.set(k=START_K)
    return rows


def held(rows: list[Row]) -> list[Row]:
    """Points of the branch of limit cycles.

    Where the feedback did hold the wheel at its speed, with k at rest.
    """
    branch = [
        row for row in rows if row["part"] == "branch" and row["k_sd"] <= HELD_WITHIN * row["k"]
    ]
    return [
        row
        for row in branch
        if abs(abs(row["hz"]) - row["held_hz"]) <= HELD_WITHIN * row["held_hz"]
    ]


def least_k(rows: list[Row]) -> Row | None:
    """The held point of least k: the saddle-node. Slower ones are unstable.

    None if no point was held.
    """
    return min(held(rows), key=lambda row: float(row["k"]), default=None)


def report(rows: list[Row], setting: Setting) -> Findings:
    """R5 and R6."""
    folds = [row for row in rows if row["part"] == "fold"]
    critical = [(row["k"] + row["k_after"]) / 2 for row in folds]
    node = least_k(rows)
    slowest = [row for row in held(rows) if node and row["held_hz"] < node["held_hz"]]
    numbers = {
        "k_c": {
            "by descent": _mean(critical),
            "interval": spread(critical),
            "step": 1 - STEP,
            "by continuation": node["k"] if node else None,
        },
        "falls_from": {
            "torque": _mean([abs(row["torque"]) for row in folds]),
            "hz": _mean([abs(row["hz"]) for row in folds]),
        },
        "starts_again_at_k": restarts(rows),
        "unstable": [
            {name: row[name] for name in ("k", "hz", "torque", "free_hz")} for row in slowest
        ],
        "not_held_hz": sorted(
            {row["held_hz"] for row in rows if row["part"] == "branch"}
            - {row["held_hz"] for row in held(rows)}
        ),
    }
    foreign = setting.elsewhere()
    stall = _stall(rows).doubted(foreign)
    jump = _jump(folds, critical, restarts(rows)).doubted(foreign, setting.short_of(points=33))
    return Findings([stall, jump], numbers)


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else 0.0


def restarts(rows: list[Row]) -> list[float]:
    """The least k at which each wheel ran again in each upward sweep."""
    moving = [
        row for row in rows if row["part"] == "sweep" and row["way"] == "up" and not row["rests"]
    ]
    wheels = sorted({_wheel(row) for row in moving})
    return [min(row["k"] for row in moving if _wheel(row) == wheel) for wheel in wheels]


def _wheel(row: Row) -> tuple[int, str, str]:
    return row["trial"], row["motion"], row["side"]


def _stall(rows: list[Row]) -> Claim:
    ramps = [row for row in rows if row["part"] == "ramp"]
    torques = [row["torque"] for row in ramps]
    return Claim(
        "R5",
        "the motor stalls for |M| <= 0.1",
        "no motion from rest below, motion above",
        _mean(torques),
        "1",
        spread(torques),
        bool(ramps) and all(row["holds"] for row in ramps),
        (
            f"slow ramps from rest: {len(ramps)}, in all of which both wheels rest below 0.1 and"
            " move at 0.11 at most"
            if all(row["holds"] for row in ramps)
            else "; ".join(row["note"] for row in ramps if not row["holds"])
        ),
    )


def _jump(folds: list[Row], critical: list[float], again: list[float]) -> Claim:
    before = [abs(row["torque"]) for row in folds]
    after = max((abs(row["torque_after"]) for row in folds), default=1.0)
    interval = spread(before)
    jumps = interval is not None and interval[0] > LEAST_JUMP and after < STALL_TORQUE
    hysteresis = bool(again and critical) and float(np.median(again)) > max(critical)
    low, high = spread(critical) or (0.0, 0.0)
    return Claim(
        "R6",
        "lowering k, M falls discontinuously to zero at k_c, with a stopped state coexisting",
        "a jump from |M| > 0.15 to |M| < 0.1; hysteresis",
        _mean(before),
        "1",
        interval,
        jumps and hysteresis,
        f"|M| before it falls, of {len(before)} wheels; at most {after:.2f} after; k_c ="
        f" {_mean(critical):.3f} ({low:.3f} to {high:.3f}); going up, {len(again)} wheels run again"
        f" from k = {min(again, default=0.0):.2f} to {max(again, default=0.0):.2f} on, in the"
        f" median from {float(np.median(again)) if again else 0.0:.2f}",
    )


def _measure(records: Sequence[Record], side: str) -> dict[str, Any]:
    """A wheel over some ticks: speed and torque with their signs, how much the torque varies, duty, and whether it rested."""
    phi, torque, duty = (
        np.array([getattr(record, f"{side}_{name}") for record in records])
        for name in ("phi_rad", "torque", "duty_pct")
    )
    return {
        "side": side,
        "hz": float(phi[-1] - phi[0]) / (records[-1].t_s - records[0].t_s) / (2 * pi),
        "torque": float(torque.mean()),
        "torque_sd": float(torque.std()),
        "duty_pct": float(duty.mean()),
        "rests": bool(np.ptp(phi) < 2 * COUNT_RAD),
    }


def _last(robot: Robot, seconds: float) -> list[Record]:
    records = robot.recent()
    return [record for record in records if record.t_s >= records[-1].t_s - seconds]


def _steady(robot: Robot) -> list[Row]:
    """Both wheels, measured once they are steady, or as they are after STEADY_PATIENCE windows."""
    robot.wait(WINDOW_S)
    for _ in range(STEADY_PATIENCE):
        before = {side: _measure(_last(robot, WINDOW_S), side) for side in WHEELS}
        robot.wait(WINDOW_S)
        after = {side: _measure(_last(robot, WINDOW_S), side) for side in WHEELS}
        steady = {side: _agree(before[side]["hz"], after[side]["hz"]) for side in WHEELS}
        if all(steady.values()):
            break
    return [
        {**_measure(_last(robot, 2 * WINDOW_S), side), "steady": steady[side]} for side in WHEELS
    ]


def _agree(hertz: float, other: float) -> bool:
    return abs(other - hertz) <= max(
        STEADY_WITHIN * abs(other), 2 * COUNT_RAD / (2 * pi) / WINDOW_S
    )


def _sweep(robot: Robot, steps: list[float]) -> list[Row]:
    rows = []
    for way, values in (("down", steps[::-1]), ("up", steps)):
        for k in values:
            robot.set(k=k)
            rows += [{"way": way, "k": k, **wheel} for wheel in _steady(robot)]
    return rows


def _fold(robot: Robot) -> list[Row]:
    """For each wheel the last step at which it turned steadily.

    k_after is the next step, at which it fell.
    """
    last: dict[str, Row] = {}
    fallen: list[Row] = []
    k = MIDDLE_K
    while len(fallen) < len(WHEELS) and k > LEAST_K:
        robot.set(k=k)
        for wheel in _steady(robot):
            side = wheel["side"]
            if wheel["rests"] and side in last:
                before = last.pop(side)
                fallen.append(
                    {**before, "k_after": before["k"] * STEP, "torque_after": wheel["torque"]}
                )
            elif wheel["steady"] and not wheel["rests"]:
                last[side] = {**wheel, "k": k}
        k *= STEP
    return fallen


def _hold(robot: Robot, side: str, sign: int, hertz: float) -> Row:
    """Bring a wheel to this speed by feedback on k, measure the limit cycle there, freeze k and see what becomes of it."""
    robot.set(k=MIDDLE_K)
    robot.wait(APPROACH_S)
    tick_s = float(robot.status()["params"]["tick_s"])
    begin_hz, begin_s, base = _speed_hz(robot, side, sign), robot.recent()[-1].t_s, MIDDLE_K
    elapsed, used = 0.0, []
    while elapsed < APPROACH_S + LOCK_S + MEASURE_S:
        robot.wait(tick_s)
        before, elapsed = elapsed, robot.recent()[-1].t_s - begin_s
        wanted = hertz + (begin_hz - hertz) * max(0.0, 1.0 - elapsed / APPROACH_S)
        missing = wanted - _speed_hz(robot, side, sign)
        base += INTEGRAL * missing * (elapsed - before)
        k = max(0.0, base + PROPORTIONAL * missing)
        robot.set(k=k)
        if elapsed >= APPROACH_S + LOCK_S:
            used.append(k)
    cycle = _measure(_last(robot, MEASURE_S), side)
    k = float(np.mean(used))
    robot.set(k=k)
    robot.wait(RELEASE_S)
    free = _measure(_last(robot, WINDOW_S), side)
    return {
        **cycle,
        "k": k,
        "k_sd": float(np.std(used)),
        "free_hz": free["hz"],
        "free_torque": free["torque"],
    }


def _speed_hz(robot: Robot, side: str, sign: int) -> float:
    """Of the last quarter of a turn, positive in the direction `sign`."""
    records = _last(robot, LONGEST_QUARTER_S)
    t, phi = (
        np.array([getattr(record, name) for record in records])
        for name in ("t_s", side + "_phi_rad")
    )
    left = np.flatnonzero(np.abs(phi[-1] - phi) >= QUARTER_RAD)
    first = int(left[-1]) if len(left) else 0
    return sign * float((phi[-1] - phi[first]) / (t[-1] - t[first]) / (2 * pi))
