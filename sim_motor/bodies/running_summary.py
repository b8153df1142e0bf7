"""The summary of a body that still runs: each row is looked at once, and then forgotten.

It has the same numbers as `sim_motor.bodies.measures.summary` of all rows so far, up to rounding.
Neither the time that a row takes nor the memory grows with the number of rows.
"""

from __future__ import annotations

from collections import deque
from dataclasses import asdict, dataclass, field
from typing import Any, NamedTuple

import numpy as np

from sim_motor.bodies.measures import (
    FALLEN_RAD,
    MOVING,
    STARTED,
    STILL_RAD_S,
    STUCK_M,
    STUCK_S,
    TRAVELS_RAD_S,
    Array,
    Summary,
    course,
    order,
)


class _Totals(NamedTuple):
    """Sums over rows: their number, mean |omega| (rad/s), order parameter, and path (m)."""

    rows: int
    omega: float
    order: float
    path_m: float


class RunningSummary:
    """Takes the rows of a Body in their order, and sums them up at any time."""

    def __init__(self, columns: tuple[str, ...]) -> None:
        self._columns = columns
        self._reversals = Reversals()
        self._totals = _Totals(0, 0.0, 0.0, 0.0)
        # (time s, mean |omega| rad/s, sums before the row) of the rows that were faster than all
        # before. In one of them start-up was over: the first that reaches STARTED of the greatest.
        self._fastest: deque[tuple[float, float, _Totals]] = deque()
        # (time s, centre m) of the rows of the last STUCK_S.
        self._latest: deque[tuple[float, Array]] = deque()
        self._peak = self._omega = 0.0
        self._flipped = False

    def add(self, rows: Array) -> None:
        """Take the next rows, (rows, columns); at least one."""
        moved = course(self._columns, rows)
        last = self._latest[-1][1] if self._latest else moved.centre_m[0]
        steps_m = np.linalg.norm(np.diff(moved.centre_m, axis=0, prepend=last[None]), axis=1)
        self._flipped |= bool((moved.lean_rad > FALLEN_RAD).any())
        # One by one from here on, and numbers of numpy would take three times as long.
        each = (moved.t_s, np.abs(moved.omega).mean(axis=1), moved.omega.mean(axis=1))
        numbers = (column.tolist() for column in (*each, order(moved.omega), steps_m))
        for centre, *row in zip(moved.centre_m, *numbers, strict=True):
            self._take(centre, *row)

    def _take(
        self, centre: Array, time_s: float, size: float, mean: float, ordered: float, step_m: float
    ) -> None:
        """Take a row: the centre (m), the time, the wheels' mean |omega| and mean omega (rad/s).

        Then come their order parameter, and how far the centre has moved since the last row.
        """
        last_s = self._latest[-1][0] if self._latest else time_s
        before = self._totals._replace(path_m=self._totals.path_m + step_m)
        self._omega = size
        self._totals = _Totals(
            before.rows + 1, before.omega + size, before.order + ordered, before.path_m
        )
        if not self._fastest or size > self._peak:
            self._peak = size
            self._fastest.append((time_s, size, before))
            while self._fastest[0][1] < STARTED * self._peak:
                self._fastest.popleft()
        self._reversals.add(mean, last_s)
        self._latest.append((time_s, centre))
        while self._latest[0][0] < time_s - STUCK_S:
            self._latest.popleft()

    def summary(self) -> Summary:
        """The summary of all rows so far. There must be one."""
        time_s, centre = self._latest[-1]
        moves, totals = self._peak >= STILL_RAD_S, self._totals
        started_s, _, before = self._fastest[0]
        rows, seconds = totals.rows - before.rows, time_s - started_s
        away = np.linalg.norm(np.array([at for _, at in self._latest]) - centre, axis=1)
        return {
            "time_s": time_s,
            "started_s": started_s if moves else None,
            "reversals": self._reversals.times_s(),
            "mean_speed": (totals.path_m - before.path_m) / seconds
            if moves and seconds > 0.0
            else 0.0,
            "mean_abs_omega": (totals.omega - before.omega) / rows if moves else self._omega,
            "peak_omega": self._peak,
            "order_parameter": (totals.order - before.order) / rows if moves else 0.0,
            "path_length": totals.path_m,
            "end": centre.tolist(),
            "flipped": self._flipped,
            "stuck": bool(time_s >= STUCK_S and away.max() < STUCK_M),
        }


@dataclass
class _Turn:
    """Rows one after the other with the same sign of the wheels' mean omega.

    before_s: the time of the last row before them. peak: the greatest |mean omega| (rad/s).
    """

    sign: float
    before_s: float
    peak: float = 0.0


@dataclass
class Reversals:
    """When the body as a whole took the other direction, as `measures.reversals_s` has it.

    A turn counts if its peak reaches a part of the greatest of all. That only grows, so turns that
    are too small are forgotten.
    """

    _most: float = 0.0
    _now: _Turn = field(default_factory=lambda: _Turn(0.0, 0.0))
    _turns: list[_Turn] = field(default_factory=list)
    _times_s: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, state: dict[str, Any]) -> Reversals:
        """Go on from a `state`."""
        turns = [_Turn(**turn) for turn in state["_turns"]]
        return cls(state["_most"], _Turn(**state["_now"]), turns, list(state["_times_s"]))

    @property
    def state(self) -> dict[str, Any]:
        """All of it, as plain data."""
        return asdict(self)

    def add(self, mean: float, before_s: float) -> None:
        """Take the wheels' mean omega (rad/s) in the next row, and the time of the last row (s)."""
        sign, size = float(mean > 0.0) - float(mean < 0.0), abs(mean)
        if sign != self._now.sign:
            self._now = _Turn(sign, before_s)
        self._now.peak = max(self._now.peak, size)
        if size > self._most:
            self._most = size
            turns, self._turns, self._times_s = self._turns, [], []
            for turn in turns:
                self._count(turn)
        self._count(self._now)

    def _count(self, turn: _Turn) -> None:
        """Keep a turn that is large enough, if it is another than the last one."""
        last = self._turns[-1] if self._turns else turn
        if turn.peak < MOVING * max(self._most, TRAVELS_RAD_S):
            return
        if last.sign != turn.sign:
            self._times_s.append(turn.before_s)
        elif self._turns and last.peak >= turn.peak:
            return  # it can only ever count where the last one does
        self._turns.append(turn)

    def times_s(self) -> list[float]:
        """The times of all reversals so far (s)."""
        return self._times_s.copy() if self._most > TRAVELS_RAD_S else []
