"""Both wheels and their rods over time, as a log has them, for a film of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import NotDone
from host.films.rod_course import ROUNDING_S, actual_of, seen_in_kick, targets_of
from host.logs.curves import STOPS, ActingKick, Curves
from robot.kicks import WHEELS

Array = NDArray[np.float64]

# How long a film says that a motion has ended (s).
STOP_SHOWN_S = 1.0


class Moment(NamedTuple):
    """A wheel at one time.

    Attributes:
        phi: Its angle, rad.
        actual: The rods' actual positions, (2,).
        targets: Their target positions, (2,).
        seen: The positions that a kick shows to the neurons, (2,); NaN if none does.
    """

    phi: float
    actual: Array
    targets: Array
    seen: Array


class Frame(NamedTuple):
    """Both wheels at one time.

    Attributes:
        t_s: The time since the log began, s.
        wheels: 'left' and 'right'.
        kick: The kick that acts, as in the log's event; None if none does.
        word: What else there is to say: 'stop', 'fault', 'not running' or nothing.
    """

    t_s: float
    wheels: dict[str, Moment]
    kick: dict[str, object] | None
    word: str


def times(log: Curves, begin_s: float, seconds: float | None, step_s: float) -> Array:
    """The times of a film's pictures (s since the log began).

    Args:
        log: The log's columns.
        begin_s: When the film begins.
        seconds: How long it lasts in the log's time; None to the log's end.
        step_s: The time between two pictures.

    Raises:
        NotDone: The log has nothing then.
    """
    last_s = float(log.t_s[-1]) if len(log.t_s) else 0.0
    end_s = last_s if seconds is None else min(last_s, begin_s + seconds)
    if not begin_s < end_s:
        raise NotDone(
            f"there is nothing to film: the log lasts {last_s:.2f} s, and the film would begin at"
            f" {begin_s:g} s",
            "choose another time with --begin",
        )
    return np.arange(begin_s, end_s, step_s)


def frames(log: Curves, t_s: Array) -> Iterator[Frame]:
    """What both wheels do. Angles are joined by straight lines from tick to tick; all else holds.

    Args:
        log: The log's columns.
        t_s: The times (s since the log began), (times,).

    Yields:
        A frame for each time.
    """
    held = np.searchsorted(log.t_s, t_s + ROUNDING_S, side="right") - 1
    angles = {side: np.interp(t_s, log.t_s, log.values[side + "_phi_rad"]) for side in WHEELS}
    for number, (now_s, row) in enumerate(zip(t_s.tolist(), held.tolist(), strict=True)):
        kick = next((one for one in log.kicks if one.begin_s <= now_s < one.end_s), None)
        wheels = {
            side: _moment(log, side, float(angles[side][number]), row, kick) for side in WHEELS
        }
        stops = [name for at_s, name in log.stops if 0.0 <= now_s - at_s < STOP_SHOWN_S]
        word = STOPS[stops[-1]] if stops else "" if log.running[row] else "not running"
        yield Frame(now_s, wheels, kick and kick.kick, word)


def _moment(log: Curves, side: str, phi: float, row: int, kick: ActingKick | None) -> Moment:
    x = [float(log.values[f"{side}_x{number}"][row]) for number in (1, 2)]
    nothing = np.full(2, np.nan)
    seen = nothing if kick is None else seen_in_kick(kick.kick, side, int(log.tick[row]), phi)
    return Moment(phi, actual_of(phi), targets_of(x, float(log.a[row])), seen)
