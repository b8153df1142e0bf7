"""kickctl discover."""

import argparse

from host.commands._terminal import essential, show
from host.errors import NoLink
from host.link.names import save
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
    parser.add_argument(
        "--save", action="store_true", help="give names to those that have none: see kickctl robots"
    )


def run(options: argparse.Namespace) -> int:
    """Print the robots and bricks that answer, robots first. Raises NoLink if none does."""
    from host.link.discovery import look_around

    found = look_around(options.seconds)
    saved = save((robot.name, robot.uri) for robot in found) if options.save else {}
    named = [
        f"{name} is {address} from now on: kickctl --brick {name} status"
        for name, address in saved.items()
    ]
    if options.json:
        more = {"saved": saved} if options.save else {}
        show({"robots": [robot.as_dict() for robot in found], **more}, "\n".join(named))
    else:
        if options.save and found and not saved:
            named = ["all of them have names already: kickctl robots list"]
        with essential("\n".join(named)):
            for robot in found:
                print(f"{robot.uri}  ({robot.name}: {robot.kind})")
            for line in named:
                print(line)
    if not found:
        raise NoLink("no robot has answered", WHAT_TO_TRY)
    return 0
