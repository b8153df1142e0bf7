"""What the log of a robot at a wall says about a hit: where the wall is, and how the hit ended.

The wall is where the wheels slow down. A bounce is a lasting reversal: the torque M of both wheels
has changed its sign, and both wheels run the other way. Functions take times (s), (ticks,), and
angles (rad) and torques M of the left and the right wheel, (ticks, 2).
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.experiments.robot.wall_rows import Hit, Tick
from host.logs.log import Log
from host.logs.motion import directions, travels
from robot.kicks import WHEELS

Array = NDArray[Any]

SETTLE_S, MEAN_S, LASTS_S = 0.5, 0.5, 0.6
# A wheel is slowed if it has less than this share of its usual speed.
SLOWED = 0.85

BOUNCED, NO_WALL = "bounced", "met no wall"
SPUN = "tyres spin"
TURNED = "turns on the spot"
ROUNDED = "turns around one wheel"
RESTED = "rests at the wall"
UNSURE = "undecided"


class Motion(NamedTuple):
    """Times (s), (ticks,), and both wheels' angles (rad) and torques M, (ticks, 2)."""

    t: Array
    phi: Array
    torque: Array


def motion_since(log: Log, begin: int = 0) -> Motion:
    """The motion of both wheels since a tick."""
    log = log.until_now()
    rows = log.column("tick") >= begin
    phi = np.stack([log.column(side + "_phi_rad") for side in WHEELS], axis=1)
    torque = np.stack([log.column(side + "_torque") for side in WHEELS], axis=1)
    return Motion(log.column("t_s")[rows], phi[rows], torque[rows])


def _lasting(t: Array, phi: Array, torque: Array) -> list[tuple[int, int]]:
    """Find where both wheels run, and are driven, one way for at least LASTS_S.

    Returns:
        (first tick, 1 or -1) of each stretch.
    """
    both = np.concatenate([directions(phi), np.sign(torque)], axis=1)
    way = np.where((both == both[:, :1]).all(axis=1), both[:, 0], 0).astype(int)
    edges = [0, *(np.flatnonzero(np.diff(way)) + 1).tolist(), len(way)]
    return [
        (first, int(way[first]))
        for first, end in pairwise(edges)
        if way[first:end].any() and t[end - 1] - t[first] >= LASTS_S
    ]


def bounces(t: Array, phi: Array, torque: Array) -> list[int]:
    """The ticks from which on both wheels run the other way than before, for at least LASTS_S."""
    stretches = _lasting(t, phi, torque)
    return [first for (_, before), (first, after) in pairwise(stretches) if after == -before]


def read_hit(t: Array, phi: Array, torque: Array) -> Hit:
    """Read from the motion how one hit went."""
    stretches, turned = _lasting(t, phi, torque), bounces(t, phi, torque)
    wall = _wall(t, phi, stretches[0][0]) if stretches else None
    if wall is None:
        return {
            "ended": NO_WALL,
            "reversed": False,
            "before": None,
            "after": None,
            "took_s": None,
            "apart_rad": None,
        }
    apart = float(phi[wall, 1] - phi[wall, 0])
    return {
        "ended": BOUNCED if turned else _stuck(directions(phi)[-1].tolist()),
        "reversed": bool(turned),
        "before": float(torque[(t < t[wall]) & (t >= t[wall] - MEAN_S)].mean()),
        "after": float(torque[t >= t[-1] - MEAN_S].mean()),
        "took_s": float(t[turned[0]] - t[wall]) if turned else None,
        "apart_rad": (apart + pi) % (2 * pi) - pi,
    }


def read_series(t: Array, phi: Array, torque: Array) -> list[Tick]:
    """Every tick of the motion, and whether the robot reversed in it."""
    turned = set(bounces(t, phi, torque))
    rows = zip((t - t[0]).tolist(), torque.tolist(), strict=True)
    return [
        {"t_s": t_s, "left_torque": left, "right_torque": right, "bounce": tick in turned}
        for tick, (t_s, (left, right)) in enumerate(rows)
    ]


def _wall(t: Array, phi: Array, first: int) -> int | None:
    """The last tick before the wall slows a wheel that has run steadily since tick `first`."""
    speed = np.abs(travels(phi))
    steady = t >= t[first] + SETTLE_S
    cruising = steady & (t < t[first] + 2 * SETTLE_S)
    if not cruising.any():
        return None
    slowed = (speed < SLOWED * np.median(speed[cruising], axis=0)).any(axis=1)
    late = np.flatnonzero(slowed & steady)
    return int(late[0]) - 1 if len(late) else None


def _stuck(ways: list[int]) -> str:
    """What a robot does that has not bounced, from the directions of its wheels."""
    left, right = ways
    if left == right:
        return {1: SPUN, 0: RESTED}.get(left, UNSURE)
    return TURNED if left == -right else ROUNDED
