"""Basins of attraction of a robot: where its wheel ends from each start of a grid.

The grid lies in the plane of lag and speed that the lab's page shows. A wheel has four dimensions,
its angle, its speed and two membrane potentials, so this is a slice: the angle is PHI_RAD, and the
potentials lie on a circle, at the lag's angle behind the wheel. The circle's radius is that on
which they lie once wheels of these parameters have settled.

A start is what a record of the robot shows: the potentials after a tick's step, and the duty cycle
that follows from them until the next tick. From there on sim_motor.batch runs the wheel, by itself:
a body that slips or meets a wall is not in it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import nan, pi
from typing import Any

import numpy as np

from host.errors import KickctlError, NotDone
from host.kicking.prediction import watch_s
from host.lab.basin_question import ENDS, Question
from host.logs.motion import directions
from robot.params import Params
from sim_motor.arrays import Array
from sim_motor.batch import CHANNELS, Start, control, kick_numbers, param_numbers, run
from sim_motor.compiled import on_one_core
from sim_motor.constants import Constants
from sim_motor.motor import ANGLE, LAST_ANGLE, SPEED, WHEEL_SPEED

PHI_RAD = 0.0
FASTEST_TURNS_S = 3.0
FORWARD, BACKWARD, REST, NEITHER = ENDS
_BY_DIRECTION = {1: FORWARD, -1: BACKWARD, 0: REST}

# Cells of the grid from which the circle's radius is found.
_PILOT_SIDE = 8
# How many records are kept at once, which bounds the memory.
_RECORDS = 200_000
# A wheel has found its end if its direction was the same in this last part of the time. One that
# has not is run once more, for this many times the time.
_SAME_PART, _LONGER = 0.5, 3
# Gives the records of starts, (wheels, ticks, CHANNELS), in this many ticks.
_Simulate = Callable[[Start, int], Array]
_PHI, _X1, _X2 = (CHANNELS.index(name) for name in ("phi_rad", "x1", "x2"))


def compute(question: Question) -> dict[str, Any] | KickctlError:
    """Compute basins, or some rows of them.

    64 x 64 starts take about 0.3 s of a core with the usual parameters, and 10 s with the slowest
    neurons.

    Returns:
        `ends`, `phi_rad`, `radius` and `fastest` of a `basins` message (MESSAGES.md); or why there
        are none.
    """
    params = Params()
    params.apply(params.check(dict(question.params)))
    motor = question.motor
    volts = question.battery_v or motor.battery_v
    simulate = partial(_run, params=params, motor=motor, battery_v=volts)
    first, last = (question.side * row for row in question.rows)
    try:
        with on_one_core():
            radius = question.radius or _settled_radius(simulate, params)
            start = starts(question.side, radius, params).of(slice(first, last))
            ends = _ends(simulate, start, ticks_to_end(params))
    except ValueError as error:
        return NotDone(f"this robot's basins cannot be computed: {error}", "take a longer tick_s")
    letters = "".join(end[0] for end in ends)
    return {"ends": letters, "phi_rad": PHI_RAD, "radius": radius, "fastest": FASTEST_TURNS_S}


def starts(side: int, radius: float, params: Params) -> Start:
    """The starts of a grid, row by row from the slowest speed, each row from the least lag.

    Args:
        side: How many starts there are along lag and along speed.
        radius: Of the circle of the membrane potentials, 1.
        params: The robot's parameters.
    """
    centres = (2.0 * np.arange(side) + 1.0) / side - 1.0
    speed, lag = np.meshgrid(2.0 * pi * FASTEST_TURNS_S * centres, pi * centres, indexing="ij")
    return start_at(lag.ravel(), speed.ravel(), radius, params)


def start_at(lag_rad: Array, speed_rad_s: Array, radius: float, params: Params) -> Start:
    """Wheels in the slice.

    Args:
        lag_rad: How far the remembered angle lies behind PHI_RAD, rad, (wheels,).
        speed_rad_s: The wheels' speeds, rad/s, (wheels,).
        radius: Of the circle of the membrane potentials, 1.
        params: The robot's parameters.

    Returns:
        Where they are after a tick, with the duty cycles (%) that follow from it.
    """
    states = np.zeros((len(lag_rad), 6))
    states[:, (ANGLE, LAST_ANGLE)] = PHI_RAD
    states[:, (SPEED, WHEEL_SPEED)] = speed_rad_s[:, None]
    remembered = PHI_RAD - lag_rad
    potentials = radius * np.stack((np.cos(remembered), np.sin(remembered)), axis=1)
    in_force, kick = param_numbers(params), kick_numbers(None)
    # A step of no time leaves the potentials as they are, and gives their duty cycle.
    duties = [control(0, PHI_RAD, nan, 0.0, x1, x2, kick, in_force)[-1] for x1, x2 in potentials]
    return Start(states, potentials, np.array(duties, dtype=np.int64))


def ends_of(phi_rad: Array) -> list[str]:
    """Where wheels have ended, one of ENDS for each.

    Args:
        phi_rad: Their angles in successive ticks, rad, (wheels, ticks).
    """
    ways = directions(phi_rad.T)
    late = ways[-round(_SAME_PART * len(ways)) :]
    same = (late == late[-1]).all(axis=0)
    return [
        _BY_DIRECTION[way] if stays else NEITHER
        for way, stays in zip(late[-1].tolist(), same.tolist(), strict=True)
    ]


def ticks_to_end(params: Params) -> int:
    """In how many ticks nearly all wheels have ended, and then were seen to stay there."""
    return round(watch_s(params) / _SAME_PART / float(params.tick_s))


def _settled_radius(simulate: _Simulate, params: Params) -> float:
    """The radius on which the potentials lie when wheels have settled; moving ones count first."""
    records = simulate(starts(_PILOT_SIDE, 1.0, params), ticks_to_end(params))
    moving = [end != REST for end in ends_of(records[:, :, _PHI])]
    late = records[moving if any(moving) else slice(None), records.shape[1] // 2 :]
    return float(np.hypot(late[:, :, _X1], late[:, :, _X2]).mean())


def _ends(simulate: _Simulate, start: Start, ticks: int) -> list[str]:
    """The end of each start."""
    assert start.duties is not None
    ends = _ends_after(simulate, start, ticks)
    late = np.flatnonzero([end == NEITHER for end in ends])
    again = Start(start.states[late], start.potentials[late], start.duties[late])
    for row, end in zip(late, _ends_after(simulate, again, _LONGER * ticks), strict=True):
        ends[row] = end
    return ends


def _ends_after(simulate: _Simulate, start: Start, ticks: int) -> list[str]:
    """The end of each start, as far as these ticks show it."""
    ends: list[str] = []
    part = max(1, _RECORDS // ticks)
    for first in range(0, len(start.states), part):
        ends += ends_of(simulate(start.of(slice(first, first + part)), ticks)[:, :, _PHI])
    return ends


def _run(start: Start, ticks: int, *, params: Params, motor: Constants, battery_v: float) -> Array:
    """The records of wheels whose next tick is due a control period after their start."""
    wheels = len(start.states)
    result = run(
        wheels,
        ticks,
        0,
        params=params,
        motors=(motor,),
        battery_v=battery_v,
        start=start,
        times=params.tick_s * np.arange(1, ticks + 1),
        record=wheels,
    )
    return result.records
