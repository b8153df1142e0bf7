"""kickctl stop."""

import argparse

from host.client.stop import stop_robot
from host.commands._terminal import answer
from host.errors import WrongUse
from host.link.addresses import chosen, make_link, sim_options

HELP = "stop the motors; needs no token, and no robot that understands anything else"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Send the STOP frame before anything else, and wait until the robot confirms it."""
    uri = chosen(options.brick)
    if sim_options(uri) is not None:
        raise WrongUse(
            "no robot of its own is named, so none has been stopped: a simulated robot is embedded"
            " in each command, and ends with it",
            "name the robot, as in kickctl --brick tcp://ev3dev.local stop, or press the back"
            " button on the brick",
        )
    stopped = stop_robot(make_link(uri, options.seed))
    result = {"brick": uri, "state": stopped.state, "tick": stopped.tick}
    answer(options, result, stopped.sentence())
    return 0
