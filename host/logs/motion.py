"""How a wheel moves, from its angles: its direction, and whether and when it has settled."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from math import isnan
from typing import TYPE_CHECKING

from host.logs.log import Log
from robot.kicks import DIRECTION_TICKS, REST_TRAVEL_RAD, direction
from robot.record import Record
from sim_motor.settling import BAND, COUNT_RAD, HALF_SPAN, ROUNDING, WINDOW_S
from sim_motor.settling import settling_s as rule

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

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
    import numpy as np

    found = np.zeros_like(phi)
    found[DIRECTION_TICKS:] = phi[DIRECTION_TICKS:] - phi[:-DIRECTION_TICKS]
    return found


def directions(phi: NDArray[np.float64]) -> NDArray[np.int64]:
    """The directions after each tick, by the robot's own rule: 1 forward, -1 backward, 0 at rest.

    Args:
        phi: angles (rad), (ticks, ...).
    """
    import numpy as np

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
    first, row, _ = _around(log, tick)
    recent = log.records[max(first, row - DIRECTION_TICKS) : row + 1]
    return heading_of(
        [_phi(record, side) for record in recent if record.tick >= tick - DIRECTION_TICKS]
    )


def _around(log: Log, tick: int) -> tuple[int, int, int]:
    """The row of a tick between those of the restarts around it: (first, row, end)."""
    records = log.records
    row = next((row for row in reversed(range(len(records))) if records[row].tick == tick), None)
    if row is None:
        raise ValueError(f"tick {tick} is not in the log")
    edges = [0, *log.restarts(), len(records)]
    first = max(edge for edge in edges if edge <= row)
    return first, row, min(edge for edge in edges if edge > row)


def _phi(record: Record, side: str) -> float:
    return float(getattr(record, side + "_phi_rad"))


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
    if len(t) < 2 or t[-1] - t[0] < 2 * WINDOW_S - ROUNDING:
        return False
    begin = t[-1] - 2 * WINDOW_S
    start, first, middle, third, end = (
        _angle_at(begin + quarter * WINDOW_S / 2, phi, t) for quarter in range(5)
    )
    inner = [start, *phi[bisect_right(t, begin) :]]
    if max(inner) - min(inner) <= COUNT_RAD + ROUNDING:
        return True
    before, last = middle - start, end - middle
    turned_back = (sum(abs(b - a) for a, b in pairwise(inner)) - abs(end - start)) / 2
    if before * last <= 0 or turned_back > COUNT_RAD + ROUNDING:
        return False
    mean = (end - start) / 4
    quarters = first - start, middle - first, third - middle, end - third
    if max(abs(quarter - mean) for quarter in quarters) > PAUSE * abs(mean) + COUNT_RAD:
        return False
    allowed = max(BAND * max(abs(before), abs(last)), 2 * COUNT_RAD)
    return abs(last - before) <= allowed + ROUNDING


def _angle_at(time: float, phi: Sequence[float], t: Sequence[float]) -> float:
    """The angle (rad) at a time (s), on a line between the ticks around it."""
    after = bisect_right(t, time)
    if after in (0, len(t)):
        return phi[max(0, after - 1)]
    share = (time - t[after - 1]) / (t[after] - t[after - 1])
    return phi[after - 1] + share * (phi[after] - phi[after - 1])


def settling_s(log: Log, side: str, begin_tick: int) -> float | None:
    """How long after the beginning of a kick a wheel had settled.

    Args:
        log: the log.
        side: 'left' or 'right'.
        begin_tick: the kick's first tick.

    Returns:
        The time (s), or None if the wheel has not settled by the end of the log or by a restart.

    Raises:
        ValueError: The tick is not in the log.
    """
    first, row, end = _around(log, begin_tick)
    run = log.records[max(first, row - HALF_SPAN) : end]
    phi, times = [_phi(record, side) for record in run], [record.t_s for record in run]
    return settling_of(phi, times, log.records[row].t_s)


def settling_of(phi: Sequence[float], t: Sequence[float], begin_s: float) -> float | None:
    """How long after a moment a wheel had settled, by the rule of sim_motor.settling.

    Args:
        phi: angles (rad), (ticks,).
        t: times (s), (ticks,).
        begin_s: the moment (s).

    Returns:
        The time (s), or None if the wheel has not settled by the end of the data.
    """
    found = rule(phi, t, begin_s)
    return None if isnan(found) else found
