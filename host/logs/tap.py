"""The stream of a robot's subscription, and the interface of what receives it."""

from __future__ import annotations

from typing import Any, Protocol

from robot.record import Record

Event = dict[str, Any]


class Tap(Protocol):
    """Receives the stream of a subscription in order: an event before the record it concerns."""

    def take_records(self, records: list[Record]) -> None:
        """Receive the next records, oldest first."""

    def take_event(self, event: Event) -> None:
        """Receive the next event: `event` (its name), `tick`, and its other fields."""


class Span:
    """A tap that hands the beginning of a stream on to other taps, and nothing after it.

    A stream arrives in portions of several ticks. Counted here, a log of one second has the ticks
    of one second, no matter how they arrive.

    Args:
        seconds: How much to hand on (s of the robot's time), counted from the first record, and
            anew from where the robot's program starts again.
        taps: Get it.

    Attributes:
        complete: Whether a record has come that lies behind the end.
    """

    def __init__(self, seconds: float, *taps: Tap) -> None:
        self.complete = False
        self._seconds = seconds
        self._taps = taps
        self._first_s: float | None = None

    def take_records(self, records: list[Record]) -> None:
        """Hand on those before the end."""
        if self.complete or not records:
            return
        if self._first_s is None:
            self._first_s = records[0].t_s
        end_s = self._first_s + self._seconds
        within = [record for record in records if record.t_s < end_s]
        self.complete = len(within) < len(records)
        if within:
            for tap in self._taps:
                tap.take_records(within)

    def take_event(self, event: Event) -> None:
        """Hand on an event before the end."""
        if self.complete:
            return
        if event["event"] == "restart":
            self._first_s = None
        for tap in self._taps:
            tap.take_event(event)
