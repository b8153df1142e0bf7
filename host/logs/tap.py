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
