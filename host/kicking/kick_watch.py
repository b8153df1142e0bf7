"""Watches a kick in the robot's records until its outcome is clear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from host.kicking.outcome import JUDGED_S, WATCH_S, Outcome, is_settled, judge
from host.logs.motion import heading_of, settling_of
from robot.kicks import DIRECTION_TICKS, WHEELS
from robot.record import STATES, Record

_RUNNING = STATES.index("running")


class KickWatch:
    """One kick from its event to its outcome.

    It is decided when both wheels have settled, and it is known how long the kicked ones took, by
    the rules of host.logs.motion; WATCH_S after the first moment at which that is possible it gives
    up waiting, and takes the headings of then.

    Args:
        kick: The kick as the robot's event gives it.
        records: The newest records; those of DIRECTION_TICKS before the kick, if they are there,
            tell the headings before it.

    Attributes:
        outcome: What the kick did; None as long as that is not known. Its settling_s is None if a
            kicked wheel has not settled.
        gave_up: Why there will be no outcome, in words; empty if there is or may be one.
    """

    def __init__(self, kick: Mapping[str, Any], records: Sequence[Record] = ()) -> None:
        self.outcome: Outcome | None = None
        self.gave_up = ""
        self._kick = kick
        self._records: list[Record] = []
        self.take_records(records)

    @property
    def done(self) -> bool:
        """Whether nothing will change any more."""
        return self.outcome is not None or bool(self.gave_up)

    def take_records(self, records: Sequence[Record]) -> None:
        """Take records, oldest first, each of them once. Once this is `done` it takes no more."""
        begin = int(self._kick["begin"])
        for record in records:
            if self.done:
                return
            if record.tick < begin - DIRECTION_TICKS - 1:
                continue
            if self._records and record.tick != self._records[-1].tick + 1:
                self.gave_up = "records are missing, or the robot's program was started again"
            elif record.tick >= begin and record.state != _RUNNING:
                self.gave_up = "the robot was stopped before its wheels had settled"
            elif not self._records and record.tick >= begin:
                self.gave_up = "there are no records from before the kick"
            else:
                self._records.append(record)
                self._decide(begin)

    def _decide(self, begin: int) -> None:
        """Find the outcome if the wheels have settled, or if they take too long."""
        first = begin - self._records[0].tick
        over = first + self._kick["ticks"]
        if over >= len(self._records):
            return
        waited_s = self._records[-1].t_s - self._records[over].t_s - JUDGED_S
        in_time = waited_s < WATCH_S
        if waited_s < 0.0 or (in_time and not self._settled()):
            return
        times = [record.t_s for record in self._records]
        phis = {
            side: [getattr(record, side + "_phi_rad") for record in self._records]
            for side in WHEELS
        }
        settling = [settling_of(phis[side], times, times[first]) for side in self._kick["wheels"]]
        if in_time and None in settling:
            return
        self.outcome = judge(
            self._kick,
            before={side: heading_of(phis[side][:first]) for side in WHEELS},
            after={side: heading_of(phis[side]) for side in WHEELS},
            settling_s=settling,
        )

    def _settled(self) -> bool:
        begin_s = self._records[-1].t_s - JUDGED_S
        recent = [record for record in self._records if record.t_s >= begin_s]
        return all(is_settled(recent, side) for side in WHEELS)
