"""One robot as the lab knows it: its latest records for the pages, its state, and its commands.

This part does no I/O and knows no threads. `LiveStation` connects it to a robot in real time,
`SteppedStation` to an embedded one whose time passes only when a test says so.
"""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

from host.client.robot import Robot
from host.client.stop import Stopped
from host.client.watching import Watcher
from host.errors import KickctlError, NotDone, WrongUse, printable
from host.kicking.modes import leave
from host.kicking.outcome import require_running
from host.kicking.primitives import drive
from host.kicking.robot_motor import MEASURE
from host.lab import basin_question, derived
from host.lab.forecasts import Forecasts, Question
from host.lab.kicks import Kicks, motor_known, stall
from host.lab.recording import Recording
from host.lab.ring import Ring
from host.lab.stopper import of_this_lab, plain
from host.lab.worker import Worker
from host.logs.tap import Event
from robot import __version__, params
from robot.record import STATES, STRUCT, Record
from robot.record import describe as describe_channels

STOP, CONTINUE = "stop", "continue"
# A robot whose records have not come for so long counts as lost (s).
LOST_S = 1.0
# How many records a page gets of what was before it came.
HISTORY = 600
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
_REMEDIES = {"idle": "start", "stopped": "start", "fault": "clear"}
_DERIVED = struct.Struct(f"<{len(derived.CHANNELS)}f")

Answer = Callable[[dict[str, Any] | KickctlError], None]


class Pages(Protocol):
    """Where a station's news goes. All of it may be called from any thread."""

    def hear(self, message: dict[str, Any]) -> None:
        """Give a message to all pages."""

    def wake(self) -> None:
        """There are new records, or the state has changed."""

    def call(self, function: Callable[[], object]) -> None:
        """Call a function where the session lives."""


class Station:
    """The part of a station that is the same for all robots; also a Tap of its stream.

    Args:
        name: What people call the robot.
        uri: Its address.
        rule: What happens when nobody drives it any more: STOP or CONTINUE.
        label: 'simulated' or 'real'.
        walls_m: How far apart the walls are (m); None if there are none.

    Attributes:
        ring: The latest records, packed with the derived channels.
        pages: Where news goes.
        recording: The log that is being written, or None.
        logs: The logs that this lab has recorded, by the names of their files.
        forecasts: Where kicks are predicted; None if nowhere.
        basins: Where basins are computed; None if nowhere.
        verdicts: The latest predictions and outcomes, for pages that join later.
        trouble: Why the robot is lost, in words; empty if that is not known, or it is not lost.
    """

    hand_possible = False

    def __init__(
        self, name: str, uri: str, rule: str, label: str, walls_m: float | None = None
    ) -> None:
        self.name = name
        self.uri = uri
        self.rule = rule
        self.ring = Ring(STRUCT.size + _DERIVED.size)
        self.pages: Pages | None = None
        self.forecasts: Forecasts | None = None
        self.basins: Worker | None = None
        self.recording: Recording | None = None
        self.logs: dict[str, Recording] = {}
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

    # What pages are told.

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
            "history": self.ring.end - self.ring.latest(HISTORY),
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
            "recording": self.recording.name if self.recording else None,
        }
        status = dict(self._status)
        if lost and self.trouble:
            message["hint"] = self.trouble
        if not status:
            return message
        state = str(status["state"])
        edges, counts = status["lateness"]["edges_s"], status["lateness"]["counts"]
        hint = message.get("hint", _HINTS.get(state, ""))
        return message | {
            "state": state,
            "reason": plain(printable(str(status["reason"]))),
            "stopped_by": self._stopped_by if state == "stopped" else None,
            "remedy": _REMEDIES.get(state),
            "hint": hint,
            "params": dict(self._follower.params),
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
                self.ring.append(STRUCT.pack(*record) + _DERIVED.pack(*values))
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

    # What pages want.

    def do(self, command: str, arguments: dict[str, Any], answer: Answer) -> None:
        """Carry out a command of the driver.

        Args:
            command: One of the commands of MESSAGES.md.
            arguments: What belongs to it, checked.
            answer: Gets the result or the error, where the session lives.
        """
        raise NotImplementedError

    def predict(self, kick: dict[str, Any], answer: Answer) -> None:
        """Predict what a kick would do now.

        Args:
            kick: The request, as robot.kick_requests.parse takes it.
            answer: Gets {shares, of} or the error, where the session lives.
        """
        pages, question = self.pages, self._question(kick)
        if self.forecasts is None or pages is None:
            answer(NotDone("this lab does not predict kicks", "kick, and see what happens"))
        elif question is None:
            answer(NotDone("nobody here knows the motors of this robot", MEASURE))
        else:
            self.forecasts.ask(question, lambda result: pages.call(lambda: answer(result)))

    def _question(self, kick: dict[str, Any]) -> Question | None:
        """What is to be predicted of a kick that begins now; None if the motors are not known."""
        motor = motor_known(self._hello)
        if motor is None:
            return None
        values = dict(self._follower.params)
        return Question(self._kicks.recent(), values, kick, motor, self._status.get("battery_v"))

    def _forecast(self, question: Question | None, kick_id: str) -> None:
        """Tell the pages what the simulation expected of a kick, from the records before it."""

        def done(result: dict[str, Any] | KickctlError) -> None:
            if not isinstance(result, KickctlError):
                message = {"type": "prediction", "robot": self.name, "kick_id": kick_id}
                told = message | result
                self.verdicts.append(told)
                self._hear(told)

        if self.forecasts is not None and question is not None:
            self.forecasts.ask(question, done)

    def basin_question(self, side: int) -> basin_question.Question:
        """Whose basins are to be computed, `side` starts along each axis. Raises NotDone."""
        motor = motor_known(self._hello)
        if not self._known:
            raise NotDone("the robot has not been found yet", "")
        if self._walls_m is not None:
            raise NotDone("basins are of a wheel by itself, and this robot has walls", "")
        if motor is None:
            raise NotDone("nobody here knows the motors of this robot", MEASURE)
        values = self._follower.params
        decisive = {name: values[name] for name in basin_question.DECISIVE}
        battery_v = self._status.get("battery_v")
        return basin_question.Question(decisive, motor, battery_v, side, (0, side))

    def note_asker(self, page: int) -> None:
        """A page, or LAB, is about to stop the robot."""
        self._asker, self._asked_at = page, self.clock()

    def stop(self) -> None:
        """Stop the motors. It returns at once and waits for nothing."""
        raise NotImplementedError

    def attend(self) -> None:
        """Somebody drives and is there; said several times a second."""

    def abandon(self) -> None:
        """Nobody drives any more.

        By the rule the robot stops, or goes on as it is. One that nobody here has driven is let be.
        """
        raise NotImplementedError

    def hand(self, wheel: str, angle_rad: float | None) -> None:
        """Pull a wheel of a simulated robot to an angle (rad); None lets go."""

    def close(self) -> None:
        """Hang up."""

    def drives_here(self) -> bool:
        """Whether this lab drives the robot, and not another host."""
        raise NotImplementedError

    def clock(self) -> float:
        """Seconds on the clock of this station."""
        raise NotImplementedError

    def _carry_out(self, robot: Robot, command: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """Have a robot that may be driven do a command. Raises KickctlError."""
        if command == "take_over":
            robot.take_over()
            return {}
        if not robot.drives:
            robot.lease()  # a person has asked for it, so also after somebody's take-over
        if command in ("start", "clear"):
            return {"tick": robot.command(command)}
        if command in ("set", "preset"):
            return {"tick": robot.command("set", set=arguments["set"])}
        if command == "kick":
            question = self._question(arguments)
            tick = robot.command("kick", kick=arguments)
            self._forecast(question, arguments["id"])
            return {"tick": tick, "kick_id": arguments["id"]}
        raise WrongUse(f"there is no command '{printable(command)}'", "reload the page")

    def _perform(self, robot: Robot, primitive: str) -> dict[str, Any]:
        """Bring the robot into a primitive, by kicks that need no plan. Raises KickctlError."""
        robot.lease()
        if robot.status()["state"] in ("idle", "stopped"):
            robot.start()
        require_running(robot)
        with robot.recording() as log:
            leave(robot)  # in chaos no kick leads there
            return drive(robot, log, primitive, planned=False)

    def _record(self, robot: Watcher, on: bool) -> dict[str, Any]:
        """Begin or end a log of the robot. Raises KickctlError or OSError."""
        if on and self.recording is None:
            recording = Recording(robot.info(), self._say)
            self.logs[recording.name] = self.recording = recording
            robot.add_tap(recording)
        elif not on and self.recording is not None:
            # Pages ask for the logs when the recording is off: the log must be whole by then.
            robot.remove_tap(self.recording)
            self.recording.close()
            self.recording = None
        self._wake()
        return {"log": self.recording.name if self.recording else None}

    def _say(self, message: str, hint: str = "") -> None:
        """Tell the pages what a person should know of this robot."""
        self._hear({"type": "note", "message": f"{self.name}: {message}", "hint": hint})

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


def stop_words(stopped: Stopped) -> str:
    """What a robot has said about a stop, if a person has to know it; else empty."""
    return stopped.sentence() if stopped.state != "stopped" else ""


def _text(value: object) -> str | None:
    return None if value is None else printable(str(value))
