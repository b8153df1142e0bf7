"""What a robot sends to who subscribes, handed on to taps: everything once and in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import inf
from typing import Any

from host.client.conversation import Samples
from host.client.subscription import Subscription
from host.logs.tap import Event, Tap
from robot.record import Record

# How long a new subscription may take to show before it is asked for again.
RESUBSCRIBE_S = 1.0
# How long no records may come. The longest control period is 0.1 s.
STALL_S = 2.0
_RECENT_RECORDS = 400


class Feed:
    """A place in a robot's stream, and the taps that get everything from there on.

    Attributes:
        place: How far the taps have been fed.
        end: The tick before which this feed ends; it may never do so.
    """

    def __init__(self, end: float = inf) -> None:
        self.place = Subscription()
        self.end = end
        self._taps: list[Tap] = []

    @property
    def complete(self) -> bool:
        """Whether its taps have got everything before its end."""
        return (self.place.next_tick or 0) >= self.end

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

    def take(self, item: Event | Samples, failures: list[BaseException]) -> list[Record]:
        """Hand on what continues the stream here, if `item` does.

        Args:
            item: What has arrived.
            failures: What taps fail with is appended here.

        Returns:
            The records that were handed on.
        """
        if isinstance(item, Samples):
            fresh = self.place.take_samples(item)
            if fresh:
                self._hand_on(lambda tap: tap.take_records(fresh), failures)
            return fresh
        event = self.place.take_event(item)
        if event is not None:
            self._hand_on(lambda tap: tap.take_event(event), failures)
        return []

    def restart(self, event: Event, hello: dict[str, Any], failures: list[BaseException]) -> None:
        """The robot counts ticks from its own beginning; what it sent before is all there was."""
        self.place.begin(hello["oldest_tick"])
        if self.end < inf:
            self.end = hello["tick"]
        self._hand_on(lambda tap: tap.take_event(event), failures)

    def _hand_on(self, give: Callable[[Tap], None], failures: list[BaseException]) -> None:
        for tap in list(self._taps):
            try:
                give(tap)
            except BaseException as failure:  # noqa: BLE001 - also sys.exit(): the others go on
                self._taps.remove(tap)
                failures.append(failure)


class Stream:
    """The records and events of one robot as they arrive, without any I/O.

    The robot sends one stream; each feed takes from it what comes next at its own place. So the
    whole record can be pulled while others follow the present, and nobody gets anything twice.

    Attributes:
        recent: The latest records.
        after: Functions that are called by `call_after`.
        fed_s: When the latest records came, whether or not anybody needed them (s).
    """

    def __init__(self) -> None:
        self.recent: deque[Record] = deque(maxlen=_RECENT_RECORDS)
        self.after: list[Callable[[], None]] = []
        self.fed_s = -inf
        self._live = Feed()
        self._pulls: list[Feed] = []
        self._due = 0.0
        self._failures: list[BaseException] = []

    @property
    def wanted(self) -> bool:
        """Whether anybody has ever asked for records."""
        return self._live.place.next_tick is not None

    def begin(self, tick: int, now: float) -> None:
        """A subscription from `tick` on was asked for at the time `now` (s)."""
        self._live.place.begin(tick)
        self._due = now + RESUBSCRIBE_S
        self.fed_s = now

    def tick_to_ask_for(self, now: float) -> int | None:
        """The tick from which to subscribe again; None if the stream goes on or it is too early."""
        if not self.wanted or now < self._due:
            return None
        places = [feed.place for feed in self._feeds()]
        if all(place.following for place in places) and now - self.fed_s <= STALL_S:
            return None
        self._due = now + RESUBSCRIBE_S
        return min(place.next_tick or 0 for place in places)

    def interrupt(self) -> None:
        """The link broke here; what comes next has to be asked for at once."""
        for feed in self._feeds():
            feed.place.interrupt()
        self._due = 0.0

    def restart(self, hello: dict[str, Any], clock_zero_s: float) -> None:
        """The robot's program has started again and counts ticks from its own beginning."""
        event = {"event": "restart", "tick": 0, "boot": hello["boot"], "clock_zero_s": clock_zero_s}
        if self.wanted:
            for feed in self._feeds():
                feed.restart(event, hello, self._failures)

    def add(self, tap: Tap) -> None:
        """Hand everything that is still to come to a tap, beginning with what is in force."""
        self._live.add(tap)

    def remove(self, tap: Tap) -> None:
        """Hand nothing more to a tap."""
        self._live.remove(tap)

    def open(self, feed: Feed) -> None:
        """Feed from the beginning of the robot's black box on, until `close`."""
        feed.place.begin(0)
        self._pulls.append(feed)
        self._due = 0.0

    def close(self, feed: Feed) -> None:
        """End a feed. If it is not complete, the others need not wait until it would have been."""
        if feed in self._pulls:
            self._pulls.remove(feed)
            if not feed.complete:
                self.interrupt()

    def take(self, items: list[Event | Samples], now: float) -> None:
        """Take in what has arrived at the time `now` (s).

        Never raises for a tap that fails; see `raise_failure`.
        """
        for item in items:
            if isinstance(item, Samples):
                self.fed_s = now
            self.recent.extend(self._live.take(item, self._failures))
            for feed in self._pulls:
                feed.take(item, self._failures)

    def call_after(self) -> None:
        """Call what waits until all that had arrived has been handed on."""
        for call in list(self.after):
            call()

    def raise_failure(self) -> None:
        """Raise what a tap has failed with, once. A full disk is an example."""
        if self._failures:
            raise self._failures.pop(0)

    def _feeds(self) -> list[Feed]:
        return [self._live, *self._pulls]
