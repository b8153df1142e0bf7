"""kickctl identify."""

import argparse
from typing import Any

from host.commands._terminal import answer, robot_of
from host.errors import NotDone, WrongUse, printable

HELP = "have the robot blink its lights and beep for 3 s, to find it among others; needs no token"

_WAYS = {
    "lights": "blinks its lights",
    "beep": "beeps",
    "words": "says so on its program's standard error",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add nothing: it has no arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Ask the robot to show itself; it drives on meanwhile."""
    with robot_of(options, observe=True) as robot:
        if robot.link.virtual:
            raise WrongUse(
                "a simulated robot that is embedded in this program has nothing to show itself by",
                "name a robot: --brick tcp://HOST or ssh://USER@HOST",
            )
        shown = robot.identify()
        result = {**shown, "brick": robot.link.uri}
    if not shown["ways"]:
        raise NotDone(
            f"{result['brick']} has neither lights nor a speaker that its program may use",
            "its lights and its speaker belong to ev3dev; see its program's messages",
        )
    answer(options, result, f"{result['brick']} {in_one_line(result)}")
    return 0


def in_one_line(result: dict[str, Any]) -> str:
    """The result in words."""
    ways = [_WAYS.get(way, printable(str(way))) for way in result["ways"]]
    return f"{' and '.join(ways)} for {result['seconds']:.0f} s"
