"""How far a client has followed a robot's stream.

Every record and event passes once and in order, also when the link repeats or loses some.
"""

from __future__ import annotations

from typing import Any

from host.client.conversation import Samples
from robot.blackbox import Snapshot
from robot.record import Record

Event = dict[str, Any]


class Subscription:
    """The place in the stream up to which everything has been taken.

    next_tick: the tick that is due, None before the first subscription. following: whether what
    arrives now continues the stream; if not, only a new subscription from `next_tick` helps.
    """

    def __init__(self) -> None:
        self.next_tick: int | None = None
        self.following = False
        self._next_event = 0
        self._state: Snapshot | None = None

    def begin(self, tick: int | None) -> None:
        """Forget everything: a stream that begins with a snapshot is to come, from `tick` on."""
        self.next_tick = tick
        self.following = False
        self._state = None

    def interrupt(self) -> None:
        """The link broke here."""
        self.following = False

    def snapshot(self) -> Event | None:
        """What is in force at this place, as an event; None if that is still to come."""
        return (
            None
            if self._state is None or self.next_tick is None
            else self._state.as_event(self.next_tick)
        )

    def take_event(self, event: Event) -> Event | None:
        """The event if it is the next one of the stream, else None."""
        if event["event"] == "snapshot":
            return self._take_snapshot(event)
        if event["event"] == "lost":
            return self._take_loss(event)
        if not self.following or self._state is None or event["number"] < self._next_event:
            return None
        if event["number"] > self._next_event or event["tick"] != self.next_tick:
            self.following = False
            return None
        self._next_event += 1
        self._state.take(event)
        return event

    def take_samples(self, samples: Samples) -> list[Record]:
        """Those of the records that are the next ones of the stream."""
        records = samples.records
        if (
            not self.following
            or self.next_tick is None
            or not records
            or records[-1].tick < self.next_tick
        ):
            return []
        if records[0].tick > self.next_tick or samples.next_event != self._next_event:
            self.following = False
            return []
        fresh = records[self.next_tick - records[0].tick :]
        self.next_tick += len(fresh)
        return fresh

    def _take_snapshot(self, event: Event) -> Event | None:
        if self._state is not None:
            # Known already. The stream goes on from here, or has begun too late.
            self.following = self.next_tick is not None and event["tick"] <= self.next_tick
            return None
        if self.next_tick not in (None, event["tick"]):
            return None
        self._state = Snapshot(event["params"], event["kick"])
        self._next_event = event["number"]
        self.next_tick = event["tick"]
        self.following = True
        return event

    def _take_loss(self, event: Event) -> Event | None:
        due = self.next_tick
        if due is None:
            due = event["from"]
        if not event["from"] <= due < event["tick"]:
            return None
        self.begin(event["tick"])
        return event | {"from": due}
