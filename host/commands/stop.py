"""kickctl stop."""

import argparse

from host.commands._terminal import answer, robot_of

HELP = "stop the motors; needs no token"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Stop, whoever controls the robot."""
    with robot_of(options, observe=True) as robot:
        tick = robot.stop()
        state = robot.status()["state"]
        answer(
            options,
            {"state": state, "tick": tick},
            f"motors stopped before tick {tick}; the robot is"
            f" {'in fault' if state == 'fault' else state}",
        )
    return 0
