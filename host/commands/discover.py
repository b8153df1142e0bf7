"""kickctl discover."""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

from host.client.robot import connect
from host.commands._terminal import essential, show
from host.errors import KickctlError, NoLink
from host.link.addresses import place_of, with_host
from host.link.names import Saved, same_robot, save
from host.link.robots_file import is_hardware_id
from host.util.numbers import Number
from robot.wire import PORT

if TYPE_CHECKING:
    from host.link.discovery import Found

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
        "--save",
        action="store_true",
        help="give names to those that have none, and new addresses to those that have moved: see"
        " kickctl robots",
    )


def run(options: argparse.Namespace) -> int:
    """Print the robots and bricks that answer, robots first. Raises NoLink if none does."""
    from host.link.discovery import look_around

    found = look_around(options.seconds)
    saved = Saved({}, {})
    if options.save and found:
        with ThreadPoolExecutor(len(found)) as pool:
            found = list(pool.map(_ask, found))
        saved = save(found)
    named = [
        f"{name} is {address} from now on: kickctl --brick {name} status"
        for name, address in saved.named.items()
    ] + [
        f"{name} is at {address} now, and no longer at {before}: it has the same hardware id"
        for name, (before, address) in saved.moved.items()
    ]
    if options.json:
        moved = {name: {"from": old, "to": new} for name, (old, new) in saved.moved.items()}
        more = {"saved": saved.named, "moved": moved} if options.save else {}
        show({"robots": [robot.as_dict() for robot in found], **more}, "\n".join(named))
    else:
        if options.save and found and not named:
            named = ["all of them have names already: kickctl robots list"]
        with essential("\n".join(named)):
            for robot in found:
                print(f"{robot.uri}  ({robot.name}: {robot.kind})")
            for line in named:
                print(line)
    if not found:
        raise NoLink("no robot has answered", WHAT_TO_TRY)
    return 0


def _ask(found: Found) -> Found:
    """The same with the hardware id that the robot's program there says.

    Where a robot of this id is known and has a token, it must have this token too: anybody in the
    network can say any id.
    """
    address = found.uri
    if found.kind != "robot":
        address = with_host(f"tcp://brick:{PORT}", place_of(found.uri)[0])
    try:
        with connect(address, observe=True) as robot:
            hardware_id = robot.hello.get("hardware_id")
        known = same_robot(hardware_id, address)
        if known is not None and known.token is not None:
            with connect(address, token=known.token) as robot:
                hardware_id = hardware_id if robot.trusted else None
    except KickctlError:  # an older program, or none
        return found
    return replace(found, hardware_id=hardware_id if is_hardware_id(hardware_id) else None)
