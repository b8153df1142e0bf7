"""The pieces of the experiment `bifurcation`: how k is moved on a robot, and what is measured."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from host.client.robot import Robot
from host.experiments.robot.bifurcation_rows import (
    Fall,
    HeldCycle,
    LastStep,
    SettledMotion,
    Step,
    WheelMotion,
)
from robot.kicks import WHEELS
from robot.record import Record
from sim_motor.settling import COUNT_RAD

# A descent goes from MIDDLE_K to LEAST_K at most, k times STEP at each step.
MIDDLE_K, LEAST_K = 1.0, 0.1
STEP = 0.985
# A wheel is steady if its speeds in two successive windows agree to STEADY_WITHIN. k is held for
# STEADY_PATIENCE windows at most.
WINDOW_S, STEADY_WITHIN, STEADY_PATIENCE = 1.0, 0.03, 12
# Feedback on k for each Hz of missing speed, and for each Hz that has been missing for a second.
PROPORTIONAL, INTEGRAL = 0.5, 0.3
APPROACH_S, LOCK_S, MEASURE_S, RELEASE_S = 8.0, 8.0, 8.0, 10.0
# Speed is measured over a quarter of a turn, after which the rods' pull repeats, so that its ripple
# does not reach k.
QUARTER_RAD, LONGEST_QUARTER_S = pi / 2, 1.5


def _measure(records: Sequence[Record], side: str) -> WheelMotion:
    """One wheel over some ticks. It rests if it moves by less than two counts of the encoder."""
    phi = np.array([getattr(record, side + "_phi_rad") for record in records])
    torque = np.array([getattr(record, side + "_torque") for record in records])
    duty = np.array([getattr(record, side + "_duty_pct") for record in records])
    return {
        "side": side,
        "hz": float(phi[-1] - phi[0]) / (records[-1].t_s - records[0].t_s) / (2 * pi),
        "torque": float(torque.mean()),
        "torque_sd": float(torque.std()),
        "duty_pct": float(duty.mean()),
        "rests": bool(np.ptp(phi) < 2 * COUNT_RAD),
    }


def _last(robot: Robot, seconds: float) -> list[Record]:
    """The robot's records of the last seconds."""
    records = robot.recent()
    return [record for record in records if record.t_s >= records[-1].t_s - seconds]


def _steady(robot: Robot) -> list[SettledMotion]:
    """Measure both wheels once they are steady, or after STEADY_PATIENCE windows as they are."""
    robot.wait(WINDOW_S)
    for _ in range(STEADY_PATIENCE):
        before = {side: _measure(_last(robot, WINDOW_S), side) for side in WHEELS}
        robot.wait(WINDOW_S)
        after = {side: _measure(_last(robot, WINDOW_S), side) for side in WHEELS}
        steady = {side: _agree(before[side]["hz"], after[side]["hz"]) for side in WHEELS}
        if all(steady.values()):
            break
    records = _last(robot, 2 * WINDOW_S)
    return [{**_measure(records, side), "steady": steady[side]} for side in WHEELS]


def _agree(hertz: float, other: float) -> bool:
    """Whether two speeds are equal, as far as the encoder can tell."""
    two_counts_hz = 2 * COUNT_RAD / (2 * pi) / WINDOW_S
    return abs(other - hertz) <= max(STEADY_WITHIN * abs(other), two_counts_hz)


def sweep(robot: Robot, steps: list[float]) -> list[Step]:
    """Move k down through its values and up again, and measure both wheels at each."""
    rows: list[Step] = []
    for k in steps[::-1]:
        robot.set(k=k)
        rows += [{"way": "down", "k": k, **wheel} for wheel in _steady(robot)]
    for k in steps:
        robot.set(k=k)
        rows += [{"way": "up", "k": k, **wheel} for wheel in _steady(robot)]
    return rows


def fold(robot: Robot) -> list[Fall]:
    """Lower k until both wheels rest; for each, its last steady step and the step after it."""
    last: dict[str, LastStep] = {}
    fallen: list[Fall] = []
    k = MIDDLE_K
    while len(fallen) < len(WHEELS) and k > LEAST_K:
        robot.set(k=k)
        for wheel in _steady(robot):
            side = wheel["side"]
            if wheel["rests"] and side in last:
                before = last.pop(side)
                k_after, torque_after = before["k"] * STEP, wheel["torque"]
                fallen.append({**before, "k_after": k_after, "torque_after": torque_after})
            elif wheel["steady"] and not wheel["rests"]:
                last[side] = {**wheel, "k": k}
        k *= STEP
    return fallen


def hold(robot: Robot, side: str, sign: int, hertz: float) -> HeldCycle:
    """Hold a wheel at a speed, measure its limit cycle, then freeze k and measure again.

    Args:
        robot: a robot that runs in the direction `sign`.
        side: left or right, the wheel that the feedback follows.
        sign: 1 for forward, -1 for backward.
        hertz: the speed to hold (turns per second), without sign.
    """
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
    """Speed over the last quarter of a turn, positive in the direction `sign`."""
    records = _last(robot, LONGEST_QUARTER_S)
    t = np.array([record.t_s for record in records])
    phi = np.array([getattr(record, side + "_phi_rad") for record in records])
    left = np.flatnonzero(np.abs(phi[-1] - phi) >= QUARTER_RAD)
    first = int(left[-1]) if len(left) else 0
    return sign * float((phi[-1] - phi[first]) / (t[-1] - t[first]) / (2 * pi))
