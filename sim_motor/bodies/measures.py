"""What a body did, from the rows that it wrote down.

Direction, order, reversals and speed, and whether it got stuck or fell over.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Start-up is over when the wheels' mean |omega| first reaches this part of the greatest; a body has
# a direction from the second part on.
STARTED, MOVING = 0.9, 0.25
# A wheel that turns more slowly (rad/s) has no direction, and a body whose wheels all do is at
# rest. One whose wheels' mean never exceeds the second rocks to and fro, which is no reversal.
STILL_RAD_S, TRAVELS_RAD_S = 0.5, 3.0
# A body is stuck if it stays within STUCK_M (m) for the last STUCK_S (s); it has fallen over if a
# car leans by more than FALLEN_RAD.
STUCK_S, STUCK_M, FALLEN_RAD = 5.0, 0.25, np.pi / 2


class Course(NamedTuple):
    """A body's rows by quantity, with the times first.

    omega (rad/s): (times, wheels). centre_m: of all cars, (times, 3). lean_rad: the most that any
    car leans, (times,).
    """

    t_s: Array
    omega: Array
    centre_m: Array
    lean_rad: Array


@cache
def _ending(columns: tuple[str, ...], ending: str) -> NDArray[np.intp]:
    """The numbers of the columns whose names end so."""
    return np.flatnonzero([column.endswith(ending) for column in columns])


def course(columns: tuple[str, ...], rows: Array) -> Course:
    """Take what is needed from the rows of a Body."""

    def of(ending: str) -> Array:
        return rows[:, _ending(columns, ending)]

    centre = np.stack([of(f"_{axis}_m").mean(axis=1) for axis in "xyz"], axis=1)
    lean = np.arccos(np.clip(np.cos(of("_roll_rad")) * np.cos(of("_pitch_rad")), -1.0, 1.0)).max(
        axis=1
    )
    return Course(rows[:, 0], of("_omega_rad_s"), centre, lean)


def order(omega: Array) -> Array:
    """The order parameter at each time: the absolute mean of the signs of all wheels' omega.

    0 at rest, 1 if all turn one way.
    """
    return np.asarray(
        np.abs(np.where(np.abs(omega) < STILL_RAD_S, 0.0, np.sign(omega)).mean(axis=-1))
    )


def directions(moved: Course) -> NDArray[np.int64]:
    """1 forward, -1 backward, at each time.

    While the wheels' mean is small it stays as it was, and is 0 in the beginning.
    """
    mean = moved.omega.mean(axis=1)
    most = float(np.abs(mean).max())
    least = MOVING * most if most > TRAVELS_RAD_S else np.inf
    signs = np.where(np.abs(mean) < least, 0, np.sign(mean)).astype(np.int64)
    latest = np.maximum.accumulate(np.where(signs != 0, np.arange(len(signs)), 0))
    return np.asarray(signs[latest])


def reversals_s(moved: Course) -> list[float]:
    """When the body as a whole took the other direction.

    It did when the wheels' mean omega changed its sign for the last time before it was large
    again.
    """
    signs, mean = directions(moved), moved.omega.mean(axis=1)
    found = []
    for change in np.flatnonzero((signs[1:] != signs[:-1]) & (signs[:-1] != 0)) + 1:
        before = np.flatnonzero(np.sign(mean[:change]) != np.sign(mean[change]))
        found.append(float(moved.t_s[before[-1]]))
    return found


def started_s(moved: Course) -> float | None:
    """When start-up was over; None if the body never moved."""
    speed = np.abs(moved.omega).mean(axis=1)
    if speed.max() < STILL_RAD_S:
        return None
    return float(moved.t_s[np.argmax(speed >= STARTED * speed.max())])


class Summary(TypedDict):
    """A run in plain data. Means are over the time after start-up.

    Attributes:
        time_s: How long it was, s.
        started_s: When start-up was over, s, or None.
        reversals: When it reversed, s.
        mean_speed: That of the centre, m/s.
        mean_abs_omega: That of all wheels, rad/s.
        peak_omega: The greatest mean |omega| of all wheels, rad/s.
        order_parameter: Its mean, 0 to 1.
        path_length: That of the centre, m.
        end: Where the centre is in the end, m.
        flipped: Whether a car fell over.
        stuck: Whether it stayed where it was in the end.
    """

    time_s: float
    started_s: float | None
    reversals: list[float]
    mean_speed: float
    mean_abs_omega: float
    peak_omega: float
    order_parameter: float
    path_length: float
    end: list[float]
    flipped: bool
    stuck: bool


def summary(columns: tuple[str, ...], rows: Array) -> Summary:
    """Summarise a run, from the rows of a Body, (times, columns)."""
    moved = course(columns, rows)
    started = started_s(moved)
    after = moved.t_s >= (moved.t_s[-1] if started is None else started)
    steps = np.linalg.norm(np.diff(moved.centre_m, axis=0), axis=1)
    late, seconds = after[:-1], float(moved.t_s[-1] - moved.t_s[after][0])
    end = moved.t_s >= moved.t_s[-1] - STUCK_S
    away = np.linalg.norm(moved.centre_m[end] - moved.centre_m[-1], axis=1).max()
    return {
        "time_s": float(moved.t_s[-1]),
        "started_s": started,
        "reversals": reversals_s(moved),
        "mean_speed": float(steps[late].sum() / seconds) if seconds > 0.0 else 0.0,
        "mean_abs_omega": float(np.abs(moved.omega[after]).mean()),
        "peak_omega": float(np.abs(moved.omega).mean(axis=1).max()),
        "order_parameter": float(order(moved.omega[after]).mean()) if started is not None else 0.0,
        "path_length": float(steps.sum()),
        "end": moved.centre_m[-1].tolist(),
        "flipped": bool((moved.lean_rad > FALLEN_RAD).any()),
        "stuck": bool(moved.t_s[-1] >= STUCK_S and away < STUCK_M),
    }
