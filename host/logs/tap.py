"""What a robot's subscription is made of, and what takes it in."""

from __future__ import annotations

from typing import Any, Protocol

from robot.record import Record

Event = dict[str, Any]


class Tap(Protocol):
    """What a client feeds with the stream of a subscription, in the stream's order: an event stands before the record it concerns."""

    def take_records(self, records: list[Record]) -> None:
        """The next records, oldest first."""

    def take_event(self, event: Event) -> None:
        """The next event: `event` (its name), `tick`, and what belongs to it."""
