"""kickctl record."""

from __future__ import annotations

import argparse
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.commands._terminal import answer, robot_of
from host.errors import Interrupted, KickctlError, RobotFault, printable
from host.logs.tap import Span
from host.util.numbers import Number
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
        "--out", type=Path, metavar="FILE", help="the log to write (default: a new one under logs/)"
    )


class Tally:
    """A tap that counts ticks, lost ticks and restarts, and remembers a fault."""

    def __init__(self) -> None:
        self.ticks = 0
        self.missing = 0
        self.restarts = 0
        self.fault = ""

    def take_records(self, records: list[Record]) -> None:
        """Count records."""
        self.ticks += len(records)

    def take_event(self, event: dict[str, Any]) -> None:
        """Count lost ticks and restarts; remember the fault."""
        if event["event"] == "lost":
            self.missing += event["tick"] - event["from"]
        elif event["event"] == "restart":
            self.restarts += 1
        elif event["event"] == "fault":
            self.fault = str(event["reason"])


def run(options: argparse.Namespace) -> int:
    """Record. An interrupt ends it early, and what was recorded is kept.

    Raises:
        Interrupted: The recording was interrupted.
        RobotFault: The robot fell into a fault meanwhile.
    """
    tally = Tally()
    path: Path | None = None
    interrupted = False
    try:
        with robot_of(options) as robot, _new_log(options.out, robot.info()) as tap:
            path = tap.path
            span = Span(options.seconds, tap, tally)
            robot.add_tap(span)
            _wait(robot, options.seconds, span)
    except KeyboardInterrupt:
        if path is None:  # there is no log yet
            raise
        interrupted = True
    except (KickctlError, OSError) as error:
        if tally.ticks:
            error.add_note(f"what was recorded until then, {tally.ticks} ticks, is in {path}")
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
        "missing": tally.missing,
        "restarts": tally.restarts,
        "interrupted": interrupted,
    }
    more = (
        f"; the robot's program started again {tally.restarts} times, and the ticks that it had not"
        " sent by then are lost"
        if tally.restarts
        else ""
    )
    if tally.fault:
        facts["fault"] = tally.fault
    answer(options, facts, f"{tally.ticks} ticks in {path}, {tally.missing} missing{more}")
