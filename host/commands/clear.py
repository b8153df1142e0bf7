"""kickctl clear."""

import argparse
from typing import Any

from host.commands._options import add_take_over
from host.commands._terminal import answer, robot_of

HELP = "clear a fault after its cause is gone"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add whether to take control from another host."""
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Clear the fault; the robot stays stopped."""
    with robot_of(options, sends="clear") as robot:
        reason = robot.status()["reason"]
        tick = robot.clear()
        result = {"state": "stopped", "tick": tick, "was": reason}
        answer(options, result, in_one_line(result))
    return 0


def in_one_line(result: dict[str, Any]) -> str:
    """The result in words."""
    return f"fault cleared ({result['was']}); `kickctl start` starts the robot"
