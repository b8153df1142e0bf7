"""kickctl clear."""

import argparse

from host.commands._terminal import answer, robot_of

HELP = "clear a fault once its cause is mended"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Clear; the robot stays stopped."""
    with robot_of(options) as robot:
        reason = robot.status()["reason"]
        tick = robot.clear()
        answer(
            options,
            {"state": "stopped", "tick": tick, "was": reason},
            f"fault cleared ({reason}); start the robot by `kickctl start`",
        )
    return 0
