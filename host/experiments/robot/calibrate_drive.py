"""How the experiment `calibrate` drives a robot about: steps and slow ramps of the duty cycle.

The robot takes no duty cycles. But while a pulse of the phase shift holds stiff rods a quarter turn
off centre, the torque is full, its sign is the shift's, and the duty is max_duty_pct.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from host.client.robot import Robot
from host.errors import NotDone
from host.experiments.robot.calibrate_rows import RAMP, STEPS, WARM_UP, Kind
from host.logs.log import Log
from robot.kicks import MAX_TICKS, PULSE, WHEELS
from robot.loop import BATTERY_TICKS

TICK_S = 0.02
STIFF: dict[str, Any] = {"k": 100.0, "a": 4.0, "tau_s": 0.06, "tick_s": TICK_S, "rods": 2}
# With these the torque alone makes the duty.
PLAIN: dict[str, Any] = {"duty_scale": 1.0, "battery_compensation": "off"}
AIM_S = 0.3  # five of these tau: the potentials have followed the shift
STEP_S = 0.25  # two of the motor's time constants
STEPS_EACH = 3
REST_S = 0.5
RAMP_S = 0.2
RAMP_TOP_PCT = 40
CLEARLY_PCT = 3  # this far above the duty at which friction lets go, it surely does
RAMP_EVERY = 3
BATTERY_S = BATTERY_TICKS * TICK_S  # this long at rest, and the battery is measured at rest

# Where in the log each stretch begins, and its kind.
Marks = list[tuple[int, Kind]]


def drive_about(robot: Robot, log: Log, seconds: float, seed: int, top_pct: int) -> Marks:
    """Push forth and back by random steps of duty, and raise the duty slowly now and then.

    Args:
        robot: a robot that runs with the parameters STIFF and PLAIN, at rest.
        log: taps the robot.
        seconds: how long (s).
        seed: seed of the random steps.
        top_pct: the highest duty (%).

    Raises:
        NotDone: A wheel does not move.
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
    """Make the torque full and of this sign from now on."""
    robot.kick(PULSE, param="shift_rad", value=-sign * pi / 2, ticks=MAX_TICKS)
    robot.wait(AIM_S)


def _release(robot: Robot) -> None:
    """Come to rest, and end the pulse."""
    robot.set(max_duty_pct=0.0)
    robot.wait(REST_S)
    robot.stop()
    robot.start()


def _push(robot: Robot, sign: int, duties: list[int]) -> None:
    """Drive with one duty after another, and come to rest."""
    _aim(robot, sign)
    for duty in duties:
        robot.set(max_duty_pct=float(duty))
        robot.wait(STEP_S)
    _release(robot)


def _ramp(robot: Robot, sign: int) -> int:
    """Raise the duty until both wheels move, and return that duty (%).

    Its sign is against the direction in which the wheels last ran. A motor that has braked them
    touches them on this side already, so that no backlash comes first.
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
