"""kickctl record."""

import argparse
from pathlib import Path
from typing import Any

from host.commands._terminal import answer, robot_of, say
from host.errors import KickctlError, RobotFault, WrongUse, printable
from robot.record import Record

HELP = "record every tick of the robot into a log"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """How long, and where to."""
    parser.add_argument("seconds", type=float, help="how long, in the robot's time")
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
    """Record. ^C ends it early, and what was recorded is kept.

    Returns:
        The exit status: 5 if the robot fell into a fault meanwhile.
    """
    from host.logs.log_folder import new_path
    from host.logs.mcap_files import McapTap
    from host.util.progress import progress

    if not 0.0 < options.seconds < 1e6:
        raise WrongUse(f"cannot record {options.seconds:g} s", "give a number of seconds above 0")
    path = options.out or new_path("record")
    tally = Tally()
    try:
        with robot_of(options) as robot, McapTap(path, robot.info()) as tap:
            robot.add_tap(tap)
            robot.add_tap(tally)
            with progress("recording", options.seconds) as advance:
                began = robot.newest

                def report() -> bool:
                    if began is not None and robot.newest is not None:
                        advance(robot.newest.t_s - began.t_s)
                    return False

                robot.wait(options.seconds, until=report)
    except KeyboardInterrupt:
        say("interrupted: the log holds what was recorded until now")
    except (KickctlError, OSError):
        if tally.ticks:
            say(f"what was recorded until then, {tally.ticks} ticks, is in {path}")
        raise
    facts = {
        "log": str(path),
        "ticks": tally.ticks,
        "missing": tally.missing,
        "restarts": tally.restarts,
    }
    more = (
        f"; the robot's program started again {tally.restarts} times, and the ticks that it had not"
        " sent by then are lost"
        if tally.restarts
        else ""
    )
    if tally.fault:
        facts["fault"] = tally.fault
        more += f"\nfault on the robot meanwhile: {printable(tally.fault)}"
    answer(options, facts, f"{tally.ticks} ticks in {path}, {tally.missing} missing{more}")
    return RobotFault.status if tally.fault else 0
