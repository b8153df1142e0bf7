"""What happens to a robot that is watched: every tick and every event counts, not only the newest.

Without any I/O: it is fed as a tap, and with the robot's answers to `status`.
"""

from __future__ import annotations

import threading
from collections import deque
from math import pi
from typing import Any

from host.errors import printable
from host.logs.tap import Event
from robot.kicks import WHEELS
from robot.record import KICK_NAMES, STATES, Record

# How long a kick stays visible after its last tick, and how often the robot is asked for what no
# record says (s of the robot's time).
VISIBLE_S = 1.0
ASK_S = 1.0
_SPEED_TICKS = 10
# Events that name the reason of the state that they begin.
_WITH_REASON = ("stop", "hold", "fault")
_CHANGING = (*_WITH_REASON, "start", "resume", "clear", "link_loss", "take_over", "restart")


class Watched:
    """A tap that sums up what happens, from one line to the next.

    Attributes:
        elapsed_s: How much of the robot's time has been watched (s).
        lost: How many records were lost since the watch began.
        restarts: How often the robot's program has started again.
    """

    def __init__(self) -> None:
        self.elapsed_s = 0.0
        self.lost = 0
        self.restarts = 0
        self._latest: deque[Record] = deque(maxlen=1 + _SPEED_TICKS)
        self._last_kick: Record | None = None
        self._status: dict[str, Any] = {}
        self._ask_at_s: float | None = 0.0
        self._lock = threading.Lock()  # records come from the link's thread
        self._ticks = 0
        self._late_s = 0.0
        self._kicks: list[str] = []
        self._events: list[Event] = []

    def take_records(self, records: list[Record]) -> None:
        """Count each of them."""
        with self._lock:
            for record in records:
                if self._latest:
                    self.elapsed_s += record.t_s - self._latest[-1].t_s
                self._latest.append(record)
                self._ticks += 1
                self._late_s = max(self._late_s, record.late_s)
                if record.kick:
                    self._last_kick = record
                    if KICK_NAMES[record.kick] not in self._kicks:
                        self._kicks.append(KICK_NAMES[record.kick])

    def take_event(self, event: Event) -> None:
        """Keep it for the next line."""
        if event["event"] == "snapshot":
            return
        with self._lock:
            self._events.append(event)
            if event["event"] in _CHANGING:
                self._ask_at_s = None
            if event["event"] in _WITH_REASON:
                self._status["reason"] = event["reason"]
            if event["event"] == "lost":
                self.lost += event["tick"] - event["from"]
            if event["event"] == "restart":
                self.restarts += 1
                self._latest.clear()
                self._last_kick = None

    def take_status(self, status: dict[str, Any]) -> None:
        """Keep what only the robot's status says."""
        with self._lock:
            self._status = dict(status)
            self._ask_at_s = self._latest[-1].t_s + ASK_S if self._latest else None

    @property
    def status_due(self) -> bool:
        """Whether it is time to ask the robot for its status."""
        with self._lock:
            return (
                self._ask_at_s is None or not self._latest or self._latest[-1].t_s >= self._ask_at_s
            )

    def line(self) -> dict[str, Any] | None:
        """What there is to say now, and what has happened since the line before.

        Returns:
            tick, t_s, state, kick and the wheels' values, of the newest tick; since the line
            before: ticks (how many), late_s (the latest beginning of one), kicks (the modes that
            acted), events; recent_kick, the mode that acted within the last second; reason,
            controller, controller_held_s, missed and overruns, as the robot's status says; lost
            and restarts, since the watch began. None before the first record.
        """
        with self._lock:
            if not self._latest:
                return None
            now, before = self._latest[-1], self._latest[0]
            line = {
                "tick": now.tick,
                "t_s": now.t_s,
                "state": STATES[now.state],
                "kick": KICK_NAMES[now.kick],
                **{side: _wheel(side, now, before) for side in WHEELS},
                "ticks": self._ticks,
                "late_s": self._late_s,
                "kicks": self._kicks,
                "recent_kick": self._recent_kick(now),
                "events": self._events,
                "reason": printable(str(self._status.get("reason", ""))),
                "controller": self._controller(),
                "controller_held_s": self._status.get("controller_held_s"),
                "missed": self._status.get("missed"),
                "overruns": self._status.get("overruns"),
                "lost": self.lost,
                "restarts": self.restarts,
            }
            self._begin_line()
            return line

    def _begin_line(self) -> None:
        self._ticks = 0
        self._late_s = 0.0
        self._kicks = []
        self._events = []

    def _recent_kick(self, now: Record) -> str:
        kick = self._last_kick
        return KICK_NAMES[kick.kick] if kick and now.t_s - kick.t_s <= VISIBLE_S else ""

    def _controller(self) -> str | None:
        name = self._status.get("controller")
        return None if name is None else printable(str(name))


def _wheel(side: str, now: Record, before: Record) -> dict[str, float]:
    values = {
        name: getattr(now, f"{side}_{name}")
        for name in ("phi_rad", "x1", "x2", "force", "torque", "duty_pct")
    }
    turn_rad = values["phi_rad"] - getattr(before, side + "_phi_rad")
    speed = turn_rad / (2 * pi) / (now.t_s - before.t_s) if now is not before else 0.0
    return {**values, "turns_per_s": speed}


def event_words(event: Event) -> str:
    """An event of the robot in a few words."""
    name = event["event"]
    if name == "lost":
        return f"ticks {event['from']} to {event['tick'] - 1}: their records are lost"
    if name == "kick":
        kick = event["kick"]
        ticks = "1 tick" if kick["ticks"] == 1 else f"{kick['ticks']} ticks"
        side = f", {kick['wheels'][0]} wheel" if len(kick["wheels"]) == 1 else ""
        words = f"kick {kick['mode']}, {ticks}{side}"
    elif name == "params":
        words = ", ".join(f"{key} = {value}" for key, value in event["set"].items())
    else:
        words = _EVENT_WORDS.get(name, str(name))
        words += f": {event['reason']}" if event.get("reason") else ""
    return printable(f"tick {event['tick']}: {words}")


_EVENT_WORDS = {
    "start": "started",
    "stop": "stopped",
    "hold": "held, the motors brake",
    "resume": "goes on",
    "clear": "fault cleared",
    "link_loss": "lost the host that drove it",
    "take_over": "control taken over",
    "restart": "the robot's program has started again",
}
