"""kickctl clear."""

import argparse

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
        answer(
            options,
            {"state": "stopped", "tick": tick, "was": reason},
            f"fault cleared ({reason}); `kickctl start` starts the robot",
        )
    return 0
