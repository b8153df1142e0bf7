"""kickctl record."""

from __future__ import annotations

import argparse
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.commands._terminal import answer, robot_of
from host.errors import Interrupted, KickctlError, RobotFault, mark_kept, printable
from host.logs.tap import Span
from host.util.numbers import Number
from host.util.paths import path_argument
from robot.record import Record

if TYPE_CHECKING:
    from host.client.robot import Robot
    from host.logs.mcap_files import McapTap

HELP = "record every tick of the robot into a log"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """How long, and where to."""
    parser.add_argument(
        "seconds", type=Number("s", 0.001, 1e6), help="how long, in s of the robot's time"
    )
    parser.add_argument(
        "--out",
        type=path_argument,
        metavar="FILE",
        help="the log to write (default: a new one under logs/)",
    )


class Tally:
    """A tap that counts what there is of the ticks that were due, and remembers a fault.

    Args:
        seconds: How long the robot is recorded (s of its time).

    Attributes:
        ticks: How many records came.
        missing: How many records were lost on the way.
        missed: How many deadlines passed without a tick, as the robot counts them. Those among lost
            records are not known.
        restarts: How often the robot's program has started again.
        fault: Why the robot fell into a fault; empty if it did not.
    """

    def __init__(self, seconds: float) -> None:
        self.ticks = 0
        self.missing = 0
        self.missed = 0
        self.restarts = 0
        self.fault = ""
        self._seconds = seconds
        self._end_s = inf
        self._tick_s = inf
        self._latest: Record | None = None

    @property
    def due(self) -> int:
        """How many ticks were due."""
        return self.ticks + self.missing + self.missed

    def take_records(self, records: list[Record]) -> None:
        """Count records, and the deadlines that were missed between them."""
        self.ticks += len(records)
        self.missed += sum(record.missed for record in records)
        if self._latest is None and records:
            self._end_s = records[0].t_s + self._seconds
            self.missed -= records[0].missed  # they were due before
        self._latest = records[-1] if records else self._latest

    def take_event(self, event: dict[str, Any]) -> None:
        """Count lost records and restarts; remember the fault and the control period."""
        self._tick_s = event.get("params", event.get("set", {})).get("tick_s", self._tick_s)
        if event["event"] == "lost":
            self.missing += event["tick"] - event["from"]
        elif event["event"] == "restart":
            self.restarts += 1
            self._latest = None
        elif event["event"] == "fault":
            self.fault = str(event["reason"])

    def end(self, recent: list[Record]) -> None:
        """Count the deadlines that were missed between the last record and the end of the time.

        Args:
            recent: The robot's latest records. The first one behind the end says how many deadlines
                passed before it.
        """
        if self._latest is None:
            return
        for record in reversed(recent):
            if record.tick == self._latest.tick + 1:
                due_s = record.t_s - record.late_s
                missed_s = (due_s - back * self._tick_s for back in range(1, record.missed + 1))
                self.missed += sum(time_s < self._end_s for time_s in missed_s)
                return


def run(options: argparse.Namespace) -> int:
    """Record. An interrupt ends it early, and what was recorded is kept.

    Raises:
        Interrupted: The recording was interrupted.
        RobotFault: The robot fell into a fault meanwhile.
    """
    tally = Tally(options.seconds)
    path: Path | None = None
    interrupted = False
    try:
        with robot_of(options) as robot, _new_log(options.out, robot.info()) as tap:
            path = tap.path
            span = Span(options.seconds, tap, tally)
            robot.add_tap(span)
            _wait(robot, options.seconds, span)
            tally.end(robot.recent())
    except KeyboardInterrupt:
        if path is None:  # there is no log yet
            raise
        interrupted = True
    except (KickctlError, OSError) as error:
        if tally.ticks:
            # A file that fails lacks what it had not written yet.
            extent = f"{tally.ticks} ticks" if isinstance(error, KickctlError) else "to a second"
            error.add_note(f"what was recorded until then, {extent}, is in {path}")
            mark_kept(error, path)
        raise
    _answer(options, path, tally, interrupted=interrupted)
    if interrupted:
        raise Interrupted("interrupted", "the log holds what was recorded until then")
    if tally.fault:
        raise RobotFault(
            f"fault on the robot meanwhile: {printable(tally.fault)}",
            "mend the cause, then: kickctl clear, kickctl start",
        )
    return 0


def in_one_line(result: dict[str, Any]) -> str:
    """The result in words."""
    deadlines = "1 deadline" if result["missed"] == 1 else f"{result['missed']:,} deadlines"
    words = (
        f"{result['ticks']:,} of {result['due']:,} due ticks in {result['log']}: the robot missed"
        f" {deadlines}, {result['missing']:,} records missing"
    )
    if result["restarts"]:
        words += (
            f"; the robot's program started again {result['restarts']} times, and the ticks that it"
            " had not sent by then are lost"
        )
    return words


def _new_log(out: Path | None, info: dict[str, Any]) -> McapTap:
    from host.logs.log_folder import in_folder
    from host.logs.mcap_files import McapTap

    if out is not None:
        return McapTap(out, info)
    return in_folder("record", info, lambda path: McapTap(path, info))


def _wait(robot: Robot, seconds: float, span: Span) -> None:
    """Wait while the robot is recorded, and show how much is left."""
    from host.util.progress import progress

    began: Record | None = None
    with progress("recording", seconds) as advance:

        def report() -> bool:
            nonlocal began
            began = began or robot.newest
            if began is not None and robot.newest is not None:
                advance(min(seconds, robot.newest.t_s - began.t_s))
            return span.complete

        robot.wait(inf, until=report)


def _answer(
    options: argparse.Namespace, path: Path | None, tally: Tally, *, interrupted: bool
) -> None:
    facts: dict[str, Any] = {
        "log": str(path),
        "ticks": tally.ticks,
        "due": tally.due,
        "missing": tally.missing,
        "missed": tally.missed,
        "restarts": tally.restarts,
        "interrupted": interrupted,
    }
    if tally.fault:
        facts["fault"] = tally.fault
    answer(options, facts, in_one_line(facts))
