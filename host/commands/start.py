"""kickctl start."""

import argparse
from typing import Any

from host.commands._options import add_take_over
from host.commands._terminal import answer, robot_of

HELP = "start the robot from random membrane potentials"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add whether to take control from another host."""
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Start the robot. A robot elsewhere keeps running when this program has ended."""
    with robot_of(options, moves=True, sends="start") as robot:
        if robot.link.virtual and robot.status()["state"] == "running":
            robot.stop()
        tick = robot.start()
        result = {"state": "running", "tick": tick}
        answer(options, result, in_one_line(result))
    return 0


def in_one_line(result: dict[str, Any]) -> str:
    """The result in words."""
    return f"the robot runs from tick {result['tick']} on"
