"""What a robot sends to who subscribes, handed on to taps: everything once and in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from host.client.conversation import Samples
from host.client.subscription import Subscription
from host.logs.tap import Event, Tap
from robot.record import Record

# How long a new subscription may take to show before it is asked for again.
RESUBSCRIBE_S = 1.0
_RECENT_RECORDS = 400


class Stream:
    """The records and events of one robot as they arrive, without any I/O.

    `after` is called whenever all that had arrived has been handed on.
    """

    def __init__(self) -> None:
        self.place = Subscription()
        self.recent: deque[Record] = deque(maxlen=_RECENT_RECORDS)
        self.after: list[Callable[[], None]] = []
        self._taps: list[Tap] = []
        self._due = 0.0
        self._failure: Exception | None = None

    @property
    def wanted(self) -> bool:
        """Whether anybody has ever asked for records."""
        return self.place.next_tick is not None

    def begin(self, tick: int, now: float) -> None:
        """A subscription from `tick` on was asked for at the time `now` (s)."""
        self.place.begin(tick)
        self._due = now + RESUBSCRIBE_S

    def tick_to_ask_for(self, now: float) -> int | None:
        """The tick from which to subscribe again; None if the stream goes on or it is too early."""
        if self.place.next_tick is None or self.place.following or now < self._due:
            return None
        self._due = now + RESUBSCRIBE_S
        return self.place.next_tick

    def interrupt(self) -> None:
        """The link broke here; what comes next has to be asked for at once."""
        self.place.interrupt()
        self._due = 0.0

    def restart(self, hello: dict[str, Any], clock_zero_s: float) -> None:
        """The robot's program has started again and counts ticks from its own beginning."""
        if self.wanted:
            self.place.begin(hello["oldest_tick"])
        boot = hello["boot"]
        event = {"event": "restart", "tick": 0, "boot": boot, "clock_zero_s": clock_zero_s}
        self._hand_on(lambda tap: tap.take_event(event))

    def add(self, tap: Tap) -> None:
        """Hand everything that is still to come to a tap, beginning with what is in force."""
        snapshot = self.place.snapshot()
        if snapshot is not None:
            tap.take_event(snapshot)
        self._taps.append(tap)

    def remove(self, tap: Tap) -> None:
        """Hand nothing more to a tap."""
        if tap in self._taps:
            self._taps.remove(tap)

    def take(self, items: list[Event | Samples]) -> None:
        """Take in what has arrived. Never raises for a tap that fails; see `raise_failure`."""
        for item in items:
            if isinstance(item, Samples):
                self._take_samples(item)
            else:
                event = self.place.take_event(item)
                if event is not None:
                    self._take_event(event)
        for call in list(self.after):
            call()

    def raise_failure(self) -> None:
        """Raise what a tap has failed with, once. A full disk is an example."""
        if self._failure is not None:
            failure, self._failure = self._failure, None
            raise failure

    def _take_samples(self, samples: Samples) -> None:
        fresh = self.place.take_samples(samples)
        if fresh:
            self.recent.extend(fresh)
            self._hand_on(lambda tap: tap.take_records(fresh))

    def _take_event(self, event: Event) -> None:
        self._hand_on(lambda tap: tap.take_event(event))

    def _hand_on(self, give: Callable[[Tap], None]) -> None:
        for tap in list(self._taps):
            try:
                give(tap)
            except Exception as failure:  # noqa: BLE001 - a tap may fail in any way; others go on
                self._taps.remove(tap)
                self._failure = failure
