"""The transmission rods of a wheel over time, as a robot's log has them.

Angle, target and actual positions, potentials and torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import NotDone
from host.logs.log import Log
from robot.controller import actual_positions, target_position
from robot.kicks import WHEELS, Kick, apply_kick, seen_positions
from sim_motor.mathematics import with_mathematics

Array = NDArray[np.float64]

# What a film shows around a kick (s of the robot's time), and how much slower: a wheel turns twice
# a second.
WINDOW_S, SLOWER = (-0.4, 1.0), 4.0
# Far less than any tick, far more than what rounding does to a time.
ROUNDING_S = 1e-9
_NUMPY = {"cos": np.cos, "sin": np.sin, "exp": np.exp}
_actual: Any = with_mathematics(actual_positions, _NUMPY)
_target: Any = with_mathematics(target_position, _NUMPY)


class Course(NamedTuple):
    """A wheel over time.

    The angle is the log's, joined by straight lines from tick to tick. Neurons step once a tick;
    between ticks potentials, targets and torque hold.

    Attributes:
        t_s: Times, s, (times,); 0 where the kick begins.
        phi: The wheel's angle, rad, (times,).
        potentials: Membrane potentials, (2, times).
        actual: The rods' actual positions, (2, times).
        targets: Their target positions, (2, times).
        seen: The positions that the kick shows to the neurons, (2, times); NaN where they see the
            actual ones.
        torque: M, (times,).
        kick_s: How long the kick acts, s.
        kick: Its mode.
    """

    t_s: Array
    phi: Array
    potentials: Array
    actual: Array
    targets: Array
    seen: Array
    torque: Array
    kick_s: float
    kick: str


def actual_of(phi: float | Array) -> Array:
    """The rods' actual positions at an angle (rad), or at several: (2,) or (2, times)."""
    return np.array(_actual(phi))


def targets_of(potentials: Sequence[Any] | Array, a: float) -> Array:
    """The rods' target positions for the neurons' potentials, (2,) or (2, times), and the gain."""
    return np.array([_target(x, a) for x in potentials])


def seen_in_kick(kick: dict[str, Any], side: str, tick: int, phi: float) -> Array:
    """The positions that a kick shows to the neurons of a wheel.

    Args:
        kick: The kick, as in a log's event.
        side: 'left' or 'right'.
        tick: A tick in which it acts.
        phi: The wheel's angle, rad.

    Returns:
        The positions, (2,); NaN if the neurons see the actual ones.
    """
    numbers = Kick(**kick).numbers(WHEELS.index(side))
    *_, beta, shift_rad = apply_kick(numbers, tick, 0.0, 0.0, 0.0, 0.0, 0.0)
    if side not in kick["wheels"] or not (beta or shift_rad):
        return np.full(2, nan)
    return np.array(seen_positions(phi, beta, shift_rad))


def course(log: Log, side: str, window_s: tuple[float, float], step_s: float) -> Course:
    """A wheel around the log's first kick.

    Args:
        log: The robot's.
        side: 'left' or 'right'.
        window_s: From when to when, s; 0 is where the kick begins.
        step_s: The time between two values, s.

    Raises:
        NotDone: The log does not hold that.
    """
    kicks = log.kicks()
    if not kicks:
        raise NotDone(
            "there is no kick in the log to show the rods around",
            "kick the robot while it is recorded",
        )
    row, kick = kicks[0]
    zero_s = log.records[row].t_s
    t_log = log.column("t_s") - zero_s
    if (
        t_log[0] > window_s[0]
        or t_log[-1] < window_s[1]
        or log.records[-1].tick < kick["begin"] + kick["ticks"]
    ):
        raise NotDone(
            f"the log holds {t_log[0]:.2f} to {t_log[-1]:.2f} s around the kick, too little to"
            " show",
            "record for longer",
        )
    t_s = np.arange(window_s[0], window_s[1] - step_s / 2, step_s)
    phi = np.interp(t_s, t_log, log.column(side + "_phi_rad"))
    held = np.searchsorted(t_log, t_s + ROUNDING_S, side="right") - 1
    potentials = np.array([log.column(f"{side}_x{number}")[held] for number in (1, 2)])
    acting = [(place, log.records[place].tick - kick["begin"]) for place in range(row, len(log))]
    acting = [(place, age) for place, age in acting if 0 <= age < kick["ticks"]]
    seen = np.full((2, len(t_s)), nan)
    for place, age in acting:
        for number in np.flatnonzero(held == place):
            seen[:, number] = seen_in_kick(kick, side, kick["begin"] + age, float(phi[number]))
    return Course(
        t_s=t_s,
        phi=phi,
        potentials=potentials,
        actual=actual_of(phi),
        targets=targets_of(potentials, float(log.info["params"]["a"])),
        seen=seen,
        torque=log.column(side + "_torque")[held],
        kick_s=float(t_log[acting[-1][0] + 1]),
        kick=str(kick["mode"]),
    )
