"""A robot that the lab's pages watch and drive.

`LiveStation` connects it to a robot in real time, `SteppedStation` to an embedded one whose time
passes only when a test says so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from host.errors import KickctlError, NotDone, WrongUse, printable
from host.kicking.modes import leave
from host.kicking.outcome import require_running
from host.kicking.primitives import drive_steps
from host.kicking.robot_motor import MEASURE
from host.kicking.steps import Steps
from host.lab import basin_question
from host.lab.kicks import motor_known
from host.lab.lessons.straight import STRAIGHT, start_straight
from host.lab.observed import Observed
from host.logs.tap import Event
from robot.record import Record

if TYPE_CHECKING:
    from host.client.robot import Robot
    from host.client.stop import Stopped
    from host.client.watching import Watcher
    from host.lab.forecasts import Forecasts, Question
    from host.lab.live_twin import LiveTwin
    from host.lab.recording import Recording
    from host.lab.worker import Worker

STOP, CONTINUE = "stop", "continue"
# Commands that a stop or a primitive under way leaves alone.
HARMLESS = ("identify", "record")
# Who wants one of these no longer wants the stop before it.
STARTING = ("start", "primitive")

Answer = Callable[[dict[str, Any] | KickctlError], None]


class Station(Observed):
    """The part of a station that is the same for all robots.

    Args:
        name: What people call the robot.
        uri: Its address.
        rule: What happens when nobody drives it any more: STOP or CONTINUE.
        label: 'simulated' or 'real'.
        walls_m: How far apart the walls are (m); None if there are none.
        twin: Its simulated twin; None for none.

    Attributes:
        recording: The log that is being written, or None.
        logs: The logs that this lab has recorded, by the names of their files.
        forecasts: Where kicks are predicted; None if nowhere.
        basins: Where basins are computed; None if nowhere.
    """

    def __init__(
        self,
        name: str,
        uri: str,
        rule: str,
        label: str,
        walls_m: float | None = None,
        twin: LiveTwin | None = None,
    ) -> None:
        super().__init__(name, uri, label, walls_m)
        self.rule = rule
        self.twin = twin
        self.forecasts: Forecasts | None = None
        self.basins: Worker | None = None
        self.recording: Recording | None = None
        self.logs: dict[str, Recording] = {}

    @property
    def twin_name(self) -> str:
        """What people call its twin. No robot has this name."""
        return f"twin of {self.name}"

    def twin_description(self) -> dict[str, Any]:
        """The twin's entry in the welcome; empty if there is none."""
        if self.twin is None:
            return {}
        own = {"name": self.twin_name, "robot": self.name}
        return own | self.twin.description(self._follower.params)

    def state(self) -> dict[str, Any]:
        return super().state() | {"recording": self.recording.name if self.recording else None}

    # What the robot says goes to its twin, too, once it is on its way to the pages.

    def take_records(self, records: list[Record]) -> None:
        super().take_records(records)
        if self.twin is None:
            return
        compared = self.twin.take_records(records, self.clock())
        if compared is not None:
            self._hear({"type": "twin", "robot": self.name, **compared})
        self._wake()

    def take_event(self, event: Event) -> None:
        super().take_event(event)
        if self.twin is not None:
            self.twin.take_event(event)

    def _meet(self, robot: Watcher) -> None:
        super()._meet(robot)
        if self.twin is not None:
            self.twin.meet(self._hello, self._status["battery_v"])

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
        pages = self.pages
        if self.forecasts is None or pages is None:
            answer(NotDone("this lab does not predict kicks", "kick, and see what happens"))
        elif (question := self._question(kick)) is None:
            answer(NotDone("nobody here knows the motors of this robot", MEASURE))
        else:
            self.forecasts.ask(question, lambda result: pages.call(lambda: answer(result)))

    def _question(self, kick: dict[str, Any]) -> Question | None:
        """What is to be predicted of a kick that begins now; None if the motors are not known."""
        from host.lab.forecasts import Question  # which only a lab that predicts needs

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
            raise NotDone("the robot has not been found yet", "the lab goes on looking for it")
        if self._walls_m is not None:
            raise NotDone(
                "basins are of a wheel by itself, and this robot has walls",
                "start the lab without walls to see them",
            )
        if motor is None:
            raise NotDone("nobody here knows the motors of this robot", MEASURE)
        values = self._follower.params
        decisive = {name: values[name] for name in basin_question.DECISIVE}
        battery_v = self._status.get("battery_v")
        return basin_question.Question(decisive, motor, battery_v, side, (0, side))

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
            question = None if self.forecasts is None else self._question(arguments)
            tick = robot.command("kick", kick=arguments)
            self._forecast(question, arguments["id"])
            return {"tick": tick, "kick_id": arguments["id"]}
        raise WrongUse(f"there is no command '{printable(command)}'", "reload the page")

    def _steps(self, robot: Robot, primitive: str) -> Steps[dict[str, Any]]:
        """The steps that bring the robot into a primitive, by kicks that need no plan."""
        robot.lease()
        if primitive == STRAIGHT:
            return (yield from start_straight(robot))
        if robot.status()["state"] in ("idle", "stopped"):
            robot.start()
        require_running(robot)
        with robot.recording() as log:
            leave(robot)  # in chaos no kick leads there
            return (yield from drive_steps(robot, log, primitive, planned=False))

    def _record(self, robot: Watcher, on: bool) -> dict[str, Any]:
        """Begin or end a log of the robot. Raises KickctlError or OSError."""
        from host.lab.recording import Recording  # which only a lab with a disk needs

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


def busy() -> NotDone:
    """Why a robot does nothing else while it is brought into a primitive."""
    return NotDone("the robot is being brought into a primitive", "wait, or stop it")


def stopped_meanwhile() -> NotDone:
    """Why a command was not carried out to its end."""
    return NotDone("the robot was stopped meanwhile", "try it again")


def stop_words(stopped: Stopped) -> str:
    """What a robot has said about a stop, if a person has to know it; else empty."""
    return stopped.sentence() if stopped.state != "stopped" else ""
