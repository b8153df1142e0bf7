"""kickctl discover."""

import argparse

from host.commands._terminal import show
from host.errors import NoLink
from host.util.numbers import Number

HELP = "look for robots in the network"
USES = ()

WHAT_TO_TRY = """\
What to try:
  Is the brick on, and in this network? Its screen shows its address at the top:
    kickctl --brick ssh://robot@ADDRESS status
  With a USB cable: choose "Wired" in the brick's menu Wireless and Networks, then
    kickctl --brick ssh://robot@ev3dev.local status
  If another brick has that name already, try ssh://robot@ev3dev-2.local.
  Many guest networks keep their machines apart: use a cable, or another network."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add how long to listen."""
    parser.add_argument(
        "--seconds",
        type=Number("s", 0.1, 3600.0),
        default=4.0,
        metavar="S",
        help="how long to listen, s (default %(default)s)",
    )


def run(options: argparse.Namespace) -> int:
    """Print the robots and bricks that answer, robots first. Raises NoLink if none does."""
    from host.link.discovery import look_around

    found = look_around(options.seconds)
    if options.json:
        show({"robots": [robot.as_dict() for robot in found]})
    for robot in found:
        if not options.json:
            print(f"{robot.uri}  ({robot.name}: {robot.kind})")
    if not found:
        raise NoLink("no robot has answered", WHAT_TO_TRY)
    return 0
