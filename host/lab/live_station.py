"""A station on a robot in real time.

It has a thread for each of the three things that must not wait for each other: to watch, to drive,
and to stop.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, NamedTuple

from host.client.access import find_token
from host.client.robot import Robot
from host.client.stop import Stopped, stop_robot
from host.errors import KickctlError, NoLink, NotDone
from host.kicking.steps import play
from host.lab.station import (
    HARMLESS,
    STARTING,
    STOP,
    Answer,
    Station,
    busy,
    stop_words,
    stopped_meanwhile,
)
from host.lab.stopper import BACK, LAB
from host.lab.urgent import UrgentThread
from host.link.names import link_to, own_token
from host.link.robots_file import Known
from host.logs.tap import Event
from host.util.own_name import own_name
from robot.record import Record

if TYPE_CHECKING:
    from host.lab.live_twin import LiveTwin

# How long somebody who drives counts as there without a new sign (s). Then heartbeats cease, and
# the robot stops by its own dead-man: so it does if this program hangs.
ATTENDED_S = 0.5
STATUS_S = 1.0
# How soon a robot is looked for again, and how often one that has said no is asked again (s).
AGAIN_S, REFUSED_S = 0.5, 10.0
# A command that the robot has not answered by then is not repeated: a stop may have come since.
ANSWER_S = 3.0
MOST_JOBS = 20
# How long a command waits for the stop that came before it (s).
STOP_S = 7.0


class _Job(NamedTuple):
    command: str
    arguments: dict[str, Any]
    answer: Answer
    stops: int


class _UntilStop:
    """A tap that raises in the thread that waits for records, as soon as a check raises."""

    def __init__(self, check: Callable[[], None]) -> None:
        self._check = check

    def take_records(self, records: list[Record]) -> None:
        self._check()

    def take_event(self, event: Event) -> None:
        self._check()


class LiveStation(Station):
    """A robot that is reached by an address.

    Args:
        robot: The robot, with its own token file if it has one.
        rule: What happens when nobody drives it any more: STOP or CONTINUE.
        label: 'simulated' or 'real'.
        walls_m: How far apart the walls are (m); None if there are none.
        pull: Pulls a wheel of a simulated robot: gets its name and the angle (rad) or None.
        twin: Its simulated twin; None for none.

    Attributes:
        met: Set as soon as the robot has been found for the first time.
        again_s: How long after a try that has failed the next one comes (s).
    """

    def __init__(
        self,
        robot: Known,
        rule: str,
        label: str,
        walls_m: float | None = None,
        pull: Callable[[str, float | None], None] | None = None,
        twin: LiveTwin | None = None,
    ) -> None:
        super().__init__(robot.name, robot.address, rule, label, walls_m, twin)
        self.hand_possible = pull is not None
        self._chosen = robot
        self._pull = pull
        self.met = threading.Event()
        self.again_s = AGAIN_S
        self._is_line = link_to(robot).is_line
        self._watcher: Robot | None = None
        self._driver: Robot | None = None
        self._jobs: SimpleQueue[_Job | None] = SimpleQueue()
        self._stops = 0
        self._stop_wanted = threading.Event()
        self._ended = 0  # the number of ended stops
        self._stop_ended = threading.Condition()
        self._stop_owed = False  # by a page, to a robot that was lost
        self._closed = threading.Event()
        self._attended_until = 0.0
        self._release_wanted = False
        self._who = own_name()
        self._performs = False
        self._driven = False
        self._threads = [
            UrgentThread(target=work, name=f"lab {what} {robot.name}", daemon=True)
            for what, work in (("watch", self._watch), ("drive", self._drive), ("stop", self._halt))
        ]

    def start(self) -> None:
        """Begin to look for the robot."""
        for thread in self._threads:
            thread.start()

    def drives_here(self) -> bool:
        driver = self._driving
        return driver is not None and driver.drives

    def clock(self) -> float:
        return time.monotonic()

    # Watch.

    def _watch(self) -> None:
        while not self._closed.is_set():
            try:
                with self._connect(observe=not self._is_line) as robot:
                    robot.on_trouble = self._note_trouble
                    self._meet(robot)
                    self._watcher = robot
                    self.met.set()
                    robot.add_tap(self)
                    self._follow(robot)
            except KickctlError as error:
                self.again_s = AGAIN_S if isinstance(error, NoLink) else REFUSED_S
                self.trouble = f"{error.message}. {error.hint}" if error.hint else error.message
            except Exception as error:  # after any failure the robot must be found again
                logging.getLogger("kickctl").exception("the lab lost a robot")
                self.trouble, self.again_s = f"the lab failed: {error!r}", AGAIN_S
            self._wake()
            self._closed.wait(self.again_s)

    def _follow(self, robot: Robot) -> None:
        if self.recording is not None:
            robot.add_tap(self.recording)
        due = 0.0
        while not self._closed.is_set():
            robot.pump(0.2)
            if self.clock() >= due:
                due = self.clock() + STATUS_S
                self._status = robot.status()
                self.trouble = ""
                if self._stop_owed:
                    self._stop_wanted.set()

    def _connect(self, *, observe: bool) -> Robot:
        robot = self._chosen
        link = link_to(robot)
        token = None if observe else find_token(link, robot.token, own_token(robot))
        return Robot(link, token, self._who)

    def _note_trouble(self, words: str) -> None:
        self.trouble = words
        self._wake()

    # Drive.

    def do(self, command: str, arguments: dict[str, Any], answer: Answer) -> None:
        """Carry out a command in the drive thread; a stop that comes meanwhile cancels it."""
        if self._performs and command not in HARMLESS:
            answer(busy())
            return
        if self._jobs.qsize() >= MOST_JOBS:
            answer(NotDone("the robot has not done the last commands yet", "wait, or stop it"))
            return
        self._performs = self._performs or command == "primitive"
        self._driven = self._driven or command not in HARMLESS
        self._jobs.put(_Job(command, arguments, answer, self._stops))

    def attend(self) -> None:
        """Keep heartbeats going for a moment."""
        self._attended_until = self.clock() + ATTENDED_S

    def _attended(self) -> bool:
        return self.rule != STOP or self.clock() < self._attended_until

    def abandon(self) -> None:
        """By the rule, stop, and give the robot back once it has stopped; or give it back as it is.

        Without a confirmed stop the robot is not given back: it misses the heartbeats and stops.
        """
        self._attended_until = 0.0
        if not self._driven:  # it may be somebody else's
            return
        self._driven = False
        if self.rule == STOP:
            self._release_wanted = True
            self.note_asker(LAB)
            self.stop()
        else:
            self._jobs.put(_Job("release", {}, lambda result: None, self._stops))

    def _drive(self) -> None:
        while (job := self._jobs.get()) is not None:
            self._work(job)
            self._performs = self._performs and job.command != "primitive"
            if job.stops != self._stops and job.command not in (*HARMLESS, "release"):
                # What was under way when the stop came may have moved the robot after it.
                self._stop_once()
        if self._driver is not None:
            self._driver.close()

    def _work(self, job: _Job) -> None:
        result: dict[str, Any] | KickctlError
        try:
            result = self._result(job)
        except KickctlError as error:
            result = error
        except OSError as error:
            result = NotDone(f"the operating system refuses: {error}", "is the disk full?")
        except Exception as error:  # the thread must go on
            logging.getLogger("kickctl").exception("a command of the lab failed")
            result = NotDone(f"the lab failed: {error!r}", "please report this")
        pages = self.pages
        if pages is not None:
            pages.call(lambda: job.answer(result))

    def _result(self, job: _Job) -> dict[str, Any]:
        if job.command in HARMLESS:
            robot = self._watcher
            if robot is None:
                raise NoLink("the robot has not been found yet", self.trouble)
            if job.command == "identify":
                return robot.identify()
            return self._record(robot, bool(job.arguments["on"]))
        self._require_no_stop(job)
        self._await_stop(job)
        if job.command in STARTING:
            self._stop_owed = False
        if job.command == "primitive":
            return self._bring(job)
        if job.command == "release":
            driver = self._driving
            if driver is not None and driver.may_drive:
                driver.release()
            return {}
        return self._carry_out(self._driver_now(), job.command, job.arguments)

    def _require_no_stop(self, job: _Job) -> None:
        if job.stops != self._stops:
            raise stopped_meanwhile()

    def _await_stop(self, job: _Job) -> None:
        """Wait for the end of the stop that came before a command, or it would undo that."""
        with self._stop_ended:
            if not self._stop_ended.wait_for(lambda: self._ended >= job.stops, STOP_S):
                raise NotDone("the stop before it has not come through yet", "try it again")

    def _bring(self, job: _Job) -> dict[str, Any]:
        """Bring the robot into a primitive. A stop ends that with the next record."""
        robot, watch = self._driver_now(), _UntilStop(lambda: self._require_no_stop(job))
        robot.add_tap(watch)
        try:
            return play(robot, self._steps(robot, job.arguments["name"]))
        finally:
            robot.remove_tap(watch)

    @property
    def _driving(self) -> Robot | None:
        """The connection that drives, if there is one. A serial line has room for one only."""
        return self._watcher if self._is_line else self._driver

    def _driver_now(self) -> Robot:
        """The connection that drives, a new one if the one before is gone."""
        if self._is_line:
            if self._watcher is None:
                raise NoLink("the robot has not been found yet", self.trouble)
            self._watcher.attended = self._attended
            return self._watcher
        driver = self._driver
        if driver is None or not driver.may_drive:
            if driver is not None:
                self._driver = None
                driver.close()
            driver = self._connect(observe=False)
            driver.answer_s, driver.reconnect_s = ANSWER_S, 0.0
            driver.attended = self._attended
            self._driver = driver
            if self.rule == STOP and self._follower.params["link_loss"] == "continue":
                self._say(
                    "its parameter link_loss is continue: if the lab dies, it drives on",
                    "set link_loss to stop",
                )
        return driver

    # Stop.

    def stop(self) -> None:
        """Stop the robot in the stop's own thread, or once it is back; cancel what waits."""
        self._stops += 1
        self._stop_wanted.set()

    def _halt(self) -> None:
        while True:
            self._stop_wanted.wait()
            if self._closed.is_set():
                return
            self._stop_wanted.clear()
            stops = self._stops
            release, self._release_wanted = self._release_wanted, False
            if self._stop_once() and release:
                self._jobs.put(_Job("release", {}, lambda result: None, stops))
            with self._stop_ended:
                self._ended = stops
                self._stop_ended.notify_all()

    def _stop_once(self) -> bool:
        """Stop the robot, and tell the pages what they have to know. Returns whether it obeyed."""
        owed, asker = self._stop_owed, self._asker
        if owed and asker is not None:
            self.note_asker(asker)  # it is still the stop of that page
        try:
            words = stop_words(self.stop_now())
            self._stop_owed = False
            if owed:
                self._say(BACK, words, lasts=True)
            elif words:
                self._say(words)
            return True
        except KickctlError as error:
            self._say_error(error)
        except Exception as error:  # the thread must outlive everything
            logging.getLogger("kickctl").exception("a stop of the lab failed")
            self._say(f"the stop failed: {error!r}", "switch the robot off")
        # The lab's own is for a robot that it drives, which may be another's by then.
        self._stop_owed = owed or asker not in (None, LAB)
        return False

    def stop_now(self) -> Stopped:
        """Stop the robot, and wait until it has confirmed that. Raises KickctlError."""
        watcher = self._watcher
        if watcher is not None:
            return watcher.stop_at_once()
        return stop_robot(link_to(self._chosen), self._who)

    def hand(self, wheel: str, angle_rad: float | None) -> None:
        if self._pull is not None:
            self._pull(wheel, angle_rad)

    def say_end(self, words: str) -> None:
        """Say why a simulated robot has ended, and that this one does not come back."""
        self._say(words, "end the lab with ^C, and start it again")

    def end(self) -> str:
        """Stop the robot if this lab drives it and the rule says so, and hang up.

        Returns:
            What a person has to know, in words; may be empty.
        """
        driver, words = self._driving, ""
        if self.rule == STOP and driver is not None and driver.drives:
            try:
                words = self.stop_now().sentence()
            except KickctlError as error:
                words = f"{error.message}\n  {error.hint}"
        self.close()
        return words

    def close(self) -> None:
        """Hang up. The robot is given back as it is."""
        self._closed.set()
        self._stops += 1  # commands that still wait are not carried out
        self._stop_wanted.set()
        self._jobs.put(None)
        for thread in self._threads:
            if thread.is_alive():
                thread.join(2.0)
        if self.recording is not None:
            with suppress(OSError):
                self.recording.close()
