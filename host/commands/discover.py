"""kickctl discover."""

import argparse

from host.commands._terminal import say, show

HELP = "look for robots in the network"

NOBODY = """\
no robot has answered. What to try:
  is the brick on, and in this network? Its screen shows its address at the top: kickctl --brick ssh://robot@ADDRESS status
  by USB cable it is a network of its own: choose "Wired" in its menu Wireless and Networks, then ssh://robot@ev3dev.local
  if another brick has that name already: ssh://robot@ev3dev-2.local
  many guest networks keep their machines apart; a cable, or another network, does not"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """How long to listen."""
    parser.add_argument(
        "--seconds",
        type=float,
        default=4.0,
        metavar="S",
        help="how long to listen (default %(default)s)",
    )


def run(options: argparse.Namespace) -> int:
    """Print what answers, robots that announce themselves first; 3 if nothing does."""
    from host.link.discovery import look_around

    found = look_around(options.seconds)
    if options.json:
        show({"robots": [robot.as_dict() for robot in found]})
    for robot in found:
        if not options.json:
            print(f"{robot.uri}  ({robot.name}: {robot.kind})")
    if not found:
        say(NOBODY)
    return 0 if found else 3
