"""One robot as pages see it: its latest records, its state, and what happened to it.

This part does no I/O and knows no threads.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

from host.client.watching import Watcher
from host.errors import KickctlError, printable
from host.lab import derived
from host.lab.kicks import Kicks, stall
from host.lab.page_words import for_page, reason
from host.lab.ring import Ring
from host.lab.stopper import of_this_lab
from host.logs.tap import Event
from robot import __version__, params
from robot.record import STATES, Record
from robot.record import describe as describe_channels

# A robot whose records have not come for so long counts as lost (s).
LOST_S = 1.0
EVENTS_KEPT = 100
VERDICTS_KEPT = 40
# How soon after a page has asked for it a stop is of that page (s).
ASKED_S = 7.0
# A tick that begins later than this counts as late for people (s).
LATE_S = 0.005
_STATE_OF = {
    "start": "running",
    "resume": "running",
    "stop": "stopped",
    "clear": "stopped",
    "hold": "held",
    "fault": "fault",
}
_HINTS = {
    "idle": "start it: the wheels will turn",
    "stopped": "start it: the wheels will turn",
    "held": "the robot waits for its driver: take the baton, then kick it or set a parameter",
    "fault": "mend the cause, then clear the fault, then start",
}
# The states in which the motors may turn.
_MOVING = ("running", "held")
_REMEDIES = {"idle": "start", "stopped": "start", "fault": "clear"}


class Pages(Protocol):
    """Where a station's news goes. All of it may be called from any thread."""

    def hear(self, message: dict[str, Any]) -> None:
        """Give a message to all pages."""

    def wake(self) -> None:
        """There are new records, or the state has changed."""

    def call(self, function: Callable[[], object]) -> None:
        """Call a function where the session lives."""


class Observed:
    """A robot whose stream is followed for pages; a Tap of it.

    Args:
        name: What people call the robot.
        uri: Its address.
        label: 'simulated' or 'real'.
        walls_m: How far apart the walls are (m); None if there are none.

    Attributes:
        ring: The latest records, packed with the derived channels.
        pages: Where news goes.
        verdicts: The latest predictions and outcomes, for pages that join later.
        trouble: Why the robot is lost, in words; empty if that is not known, or it is not lost.
    """

    hand_possible = False

    def __init__(self, name: str, uri: str, label: str, walls_m: float | None = None) -> None:
        self.name = name
        self.uri = uri
        self.ring = Ring(derived.SIZE)
        self.pages: Pages | None = None
        self._label = label
        self._walls_m = walls_m
        self._follower = derived.Follower()
        self._hello: dict[str, Any] = {}
        self._status: dict[str, Any] = {}
        self._heard_at: float | None = None
        self._began_at = self.clock()
        self.trouble = ""
        self._asker: int | None = None
        self._asked_at = 0.0
        self._stopped_by: int | None = None
        self._known = False
        self._tick = 0
        self._events: deque[Event] = deque(maxlen=EVENTS_KEPT)
        self.verdicts: deque[dict[str, Any]] = deque(maxlen=VERDICTS_KEPT)
        self._kicks = Kicks()

    # What pages hear.

    def description(self) -> dict[str, Any]:
        """The robot's entry in the welcome."""
        place = derived.body()
        values = dict(self._follower.params)
        return {
            "name": self.name,
            "uri": self.uri,
            "label": self._label,
            "software": str(self._hello.get("software", __version__)),
            "motor": printable(str(self._hello.get("motor", ""))),
            "channels": describe_channels(),
            "derived": describe_channels(derived.CHANNELS),
            "params": params.describe(),
            "tick_s": values["tick_s"],
            "stall": stall(self._hello, values),
            "track_m": place.track_m,
            "wheel_radius_m": place.wheel_radius_m,
            "walls": self._walls_m,
            "hand": self.hand_possible,
            "events": [*self._events, self._follower.snapshot(self._tick)],
            "verdicts": list(self.verdicts),
            "history": self.ring.end - self.ring.recent,
        }

    def state(self) -> dict[str, Any]:
        """What a `state` message says of the robot now."""
        now = self.clock()
        heard_at = self._began_at if self._heard_at is None else self._heard_at
        lost = self._heard_at is None or now - heard_at > LOST_S
        message: dict[str, Any] = {
            "type": "state",
            "robot": self.name,
            "link": "lost" if lost else "up",
            "since_s": round(now - heard_at, 1) if lost else 0.0,
        }
        status = dict(self._status)
        if lost and self.trouble:
            message["hint"] = for_page(self.trouble)
        if not status:
            return message
        state = str(status["state"])
        edges, counts = status["lateness"]["edges_s"], status["lateness"]["counts"]
        hint = message.get("hint", _HINTS.get(state, ""))
        values = dict(self._follower.params)
        return message | {
            "state": state,
            "reason": reason(printable(str(status["reason"]))),
            "stopped_by": self._stopped_by if state == "stopped" else None,
            "remedy": _REMEDIES.get(state),
            "hint": hint,
            "params": values,
            "accepts": {
                name: params.accepted(name, values, at_rest=state not in _MOVING)
                for name in values
                if name in params.TABLE
            },
            "battery_v": status["battery_v"],
            "controller": _text(status["controller"]),
            "here": self.drives_here(),
            "late": sum(n for edge, n in zip([0.0, *edges], counts, strict=True) if edge >= LATE_S),
            "missed": status["missed"],
            "overrun": status["overruns"],
        }

    # What the robot says.

    def take_records(self, records: list[Record]) -> None:
        """Keep records for the pages."""
        for record in records:
            values = self._follower.derive(record)
            if values is not None:
                self.ring.append(derived.pack(record, values))
        outcome = self._kicks.take_records(records)
        if outcome is not None:
            self._hear({"type": "outcome", "robot": self.name, **outcome})
        if records:
            self._tick = records[-1].tick + 1
            self._take_state(STATES[records[-1].state])
        self._heard_at = self.clock()
        self._wake()

    def take_event(self, event: Event) -> None:
        """Follow what changes the robot's course, and tell the pages."""
        self._follower.take_event(event)
        if event["event"] == "restart":
            self._events.clear()
            self.verdicts.clear()
        self._events.append(event)
        self._kicks.take_event(event)
        if event["event"] == "snapshot" and not self._known:
            self._known = True
            self._hear({"type": "welcome"})  # pages that came before know only what is usual
        if event["event"] in _STATE_OF and self._status:
            self._status["state"] = _STATE_OF[event["event"]]
            self._status["reason"] = event.get("reason", "")
        if event["event"] == "stop":
            # Another program of this person may stop the robot, too, long after a page has.
            ours = self.clock() - self._asked_at < ASKED_S and of_this_lab(event["reason"])
            self._stopped_by = self._asker if ours else None
        self._hear({"type": "event", "robot": self.name, "event": event})
        self._wake()

    def _take_state(self, state: str) -> None:
        if self._status:
            self._status["state"] = state

    def _meet(self, robot: Watcher) -> None:
        """A connection to the robot has been opened."""
        self._hello = dict(robot.hello)
        self.trouble = ""
        self._status = robot.status()
        self._wake()

    def note_asker(self, page: int) -> None:
        """A page, or LAB, is about to stop the robot."""
        self._asker, self._asked_at = page, self.clock()

    def drives_here(self) -> bool:
        """Whether this lab drives the robot, and not another host."""
        raise NotImplementedError

    def clock(self) -> float:
        """Seconds on the clock of this station."""
        raise NotImplementedError

    def _say(self, message: str, hint: str = "", *, lasts: bool = False) -> None:
        """Tell the pages what to know of this robot, and whether it `lasts` once it is back."""
        words = {"message": for_page(message), "hint": for_page(hint)}
        self._hear({"type": "note", "robot": self.name, **words, "lasts": lasts})

    def _say_error(self, error: KickctlError) -> None:
        self._say(error.message, error.hint)

    def _hear(self, message: dict[str, Any]) -> None:
        pages = self.pages
        if pages is not None:
            pages.hear(message)

    def _wake(self) -> None:
        pages = self.pages
        if pages is not None:
            pages.wake()


def _text(value: object) -> str | None:
    return None if value is None else printable(str(value))
