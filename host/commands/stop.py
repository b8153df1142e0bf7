"""kickctl stop."""

import argparse

from host.client.stop import stop_robot
from host.commands._terminal import answer, say
from host.link.addresses import chosen, make_link

HELP = "stop the motors; needs no token, and no robot that understands anything else"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Send the STOP frame before anything else, and wait until the robot confirms it."""
    link = make_link(chosen(options.brick), options.seed)
    if link.virtual:
        say(f"only the simulated robot of this command stops ({link.uri}); name another by --brick")
    stopped = stop_robot(link)
    answer(options, {"state": stopped.state, "tick": stopped.tick}, stopped.sentence())
    return 0
