"""Manoeuvres of the demo. The paper's claims are measured in their log."""

from __future__ import annotations

from host.client.robot import Robot
from host.kicking.outcome import wait_settled
from host.kicking.robot_claims import Span
from host.logs.log import Log
from robot.kicks import DEFAULT_SHIFT_RAD, WHEELS

STEADY_S = 2.0
REST_S = 3.0
RAMP_SHIFT_TICKS = 5000
# While the rods are held off centre, the torque is about k. This step of k is small beside the
# torque in question, 0.1.
RAMP_STEP_K = 0.004
RAMP_TOP_K = 1.0
RAMP_STEP_S = 0.3


def steady(robot: Robot, log: Log) -> Span:
    """Wait until the wheels have settled, and let them run on. Returns that stretch of the log."""
    wait_settled(robot)
    first = len(log)
    robot.wait(STEADY_S)
    return Span(first, len(log))


def starts(robot: Robot, log: Log, count: int) -> list[Span]:
    """Stop the robot and start it from random potentials, `count` times.

    Returns the stretch of settled motion after each start.
    """
    spans = []
    for _ in range(count):
        robot.stop()
        robot.wait(REST_S)
        robot.start()
        robot.wait(REST_S)
        spans.append(steady(robot, log))
    return spans


def ramp(robot: Robot, log: Log) -> Span:
    """Raise the torque of a robot at rest in small steps of k until both wheels have moved.

    A long pulse of the phase shift holds the rods off centre, so that the torque of a resting wheel
    grows with k alone. Afterwards the robot is stopped and k is as before.

    Returns the stretch of the log from rest on.
    """
    k_before = robot.status()["params"]["k"]
    robot.set(k=0.0)
    robot.wait(REST_S)
    robot.kick("pulse", param="shift_rad", value=-DEFAULT_SHIFT_RAD, ticks=RAMP_SHIFT_TICKS)
    robot.wait(REST_S)
    first = len(log)
    at_rest = log.records[-1]
    k = 0.0
    while k < RAMP_TOP_K and any(
        _angle(log.records[-1], side) == _angle(at_rest, side) for side in WHEELS
    ):
        k += RAMP_STEP_K
        robot.set(k=k)
        robot.wait(RAMP_STEP_S)
    span = Span(first, len(log))
    robot.stop()
    robot.set(k=k_before)
    return span


def _angle(record: object, side: str) -> float:
    return float(getattr(record, side + "_phi_rad"))
