"""How a wheel moves, from its angles: its direction, and whether and when it has settled."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.logs.log import Log
from robot.kicks import DIRECTION_TICKS, REST_TRAVEL_RAD, direction
from sim_motor.settling import BAND, COUNT_RAD, ROUNDING, WINDOW_S
from sim_motor.settling import settling_s as rule

HEADINGS = {1: "forward", -1: "backward", 0: "stopped"}

PAUSE = 0.5


def heading_of(phi: Sequence[float]) -> str:
    """The heading after the last of some angles, by the robot's own rule.

    The travel over DIRECTION_TICKS ticks decides, or over fewer if there are not that many.

    Args:
        phi: angles (rad) of successive ticks.

    Returns:
        'forward', 'backward' or 'stopped'.

    Raises:
        ValueError: There is no angle.
    """
    if not len(phi):
        raise ValueError("a wheel's heading needs at least one angle")
    return HEADINGS[direction(phi[-1] - phi[max(0, len(phi) - 1 - DIRECTION_TICKS)])]


def travels(phi: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far (rad) wheels came in the DIRECTION_TICKS ticks up to each tick.

    Args:
        phi: angles (rad), (ticks, ...).

    Returns:
        Travels (rad), as many as angles; 0 in the first DIRECTION_TICKS ticks.
    """
    found = np.zeros_like(phi)
    found[DIRECTION_TICKS:] = phi[DIRECTION_TICKS:] - phi[:-DIRECTION_TICKS]
    return found


def directions(phi: NDArray[np.float64]) -> NDArray[np.int64]:
    """The directions after each tick, by the robot's own rule: 1 forward, -1 backward, 0 at rest.

    Args:
        phi: angles (rad), (ticks, ...).
    """
    way = travels(phi)
    return np.where(np.abs(way) > REST_TRAVEL_RAD, np.sign(way), 0).astype(np.int64)


def heading(log: Log, side: str, tick: int) -> str:
    """The heading of a wheel after a tick, as the robot finds it for a kick in the next tick.

    Args:
        log: the log.
        side: 'left' or 'right'.
        tick: number of the tick. If the robot restarted and the log has this number twice, the
            later one counts.

    Raises:
        ValueError: The tick is not in the log.
    """
    ticks, _, phi, row = _around(log, side, tick)
    return heading_of(phi[: row + 1][ticks[: row + 1] >= tick - DIRECTION_TICKS].tolist())


def _around(log: Log, side: str, tick: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], int]:
    """Ticks, times (s) and angles (rad) between the restarts around `tick`, and its row in them."""
    ticks = log.column("tick")
    rows = np.flatnonzero(ticks == tick)
    if not len(rows):
        raise ValueError(f"tick {tick} is not in the log")
    row = int(rows[-1])
    edges = [0, *log.restarts(), len(log)]
    run = slice(
        max(edge for edge in edges if edge <= row), min(edge for edge in edges if edge > row)
    )
    return ticks[run], log.column("t_s")[run], log.column(side + "_phi_rad")[run], row - run.start


def settled(phi: Sequence[float], t: Sequence[float]) -> bool:
    """Whether a wheel moves steadily, or rests, at the end of its angles.

    The last two windows of WINDOW_S are compared. Less than two windows of data are never settled:
    given the angles since a kick, the answer depends on these alone. A wheel rests if it travels by
    no more than one count of the encoder in the two windows. It moves steadily if

    - the travels of both windows have the same sign and agree to BAND of the greater, or to two
      counts, by which the encoder's steps may change equal travels;
    - it never turned back by more than a count;
    - in no quarter of the time did it pause or hurry, so that its travel there differs from the
      mean by more than PAUSE of it. Irregular motion may agree in two windows by chance, but not in
      this.

    Args:
        phi: angles (rad), (ticks,).
        t: times (s), (ticks,).
    """
    times, angles = np.asarray(t, dtype=float), np.asarray(phi, dtype=float)
    if len(times) < 2 or times[-1] - times[0] < 2 * WINDOW_S - ROUNDING:
        return False
    begin = times[-1] - 2 * WINDOW_S
    start, middle, end = np.interp([begin, begin + WINDOW_S, times[-1]], times, angles)
    inner = np.concatenate([[start], angles[times > begin]])
    if np.ptp(inner) <= COUNT_RAD + ROUNDING:
        return True
    before, last = middle - start, end - middle
    turned_back = (np.abs(np.diff(inner)).sum() - abs(end - start)) / 2
    if before * last <= 0 or turned_back > COUNT_RAD + ROUNDING:
        return False
    quarters = np.diff(np.interp(np.linspace(begin, times[-1], 5), times, angles))
    if np.abs(quarters - quarters.mean()).max() > PAUSE * abs(quarters.mean()) + COUNT_RAD:
        return False
    allowed = max(BAND * max(abs(before), abs(last)), 2 * COUNT_RAD)
    return bool(abs(last - before) <= allowed + ROUNDING)


def settling_s(log: Log, side: str, begin_tick: int) -> float | None:
    """How long after the begin of a kick a wheel had settled.

    Args:
        log: the log.
        side: 'left' or 'right'.
        begin_tick: the kick's first tick.

    Returns:
        The time (s), or None if the wheel has not settled by the end of the log or by a restart.

    Raises:
        ValueError: The tick is not in the log.
    """
    _, times, angles, row = _around(log, side, begin_tick)
    return settling_of(angles, times, float(times[row]))


def settling_of(
    phi: Sequence[float] | NDArray[Any], t: Sequence[float] | NDArray[Any], begin_s: float
) -> float | None:
    """How long after a moment a wheel had settled, by the rule of sim_motor.settling.

    Args:
        phi: angles (rad), (ticks,).
        t: times (s), (ticks,).
        begin_s: the moment (s).

    Returns:
        The time (s), or None if the wheel has not settled by the end of the data.
    """
    found = rule(
        np.asarray(phi, dtype=float).tolist(), np.asarray(t, dtype=float).tolist(), begin_s
    )
    return None if isnan(found) else found
