"""kickctl foxglove."""

from __future__ import annotations

import argparse
import time
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING

from host.commands._outputs import add_force, answer_beside, require_place
from host.commands._stations import add_port, add_unattended, network_address, robots_of, station_of
from host.commands._terminal import print_result, say, show_next
from host.errors import WrongUse
from host.util.extras import need
from host.util.paths import path_argument
from host.util.whole_files import write_text

if TYPE_CHECKING:
    from host.foxglove.server import Viewers
    from host.foxglove.station import ShownStation

HELP = (
    "serve running robots live to Foxglove and Lichtblick, which only look unless --control is"
    " given. Without --brick it is a simulated robot. ^C ends it, and the exit status is 0"
)
_LOOK_S = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to serve, what viewers may do, and the layout."""
    add_port(parser, "server", 8765)
    parser.add_argument(
        "--listen",
        type=network_address,
        metavar="ADDRESS",
        help="an address of this computer in its network: everybody there may look (default: this"
        " computer only)",
    )
    parser.add_argument(
        "--control",
        action="store_true",
        help="let viewers on this computer drive: services to kick, start and stop, and the"
        " parameters, after /unlock with the key that is printed",
    )
    add_unattended(parser, "--control drives it, and no viewer that was unlocked watches it")
    parser.add_argument(
        "--layout",
        type=path_argument,
        metavar="FILE",
        help="write the layout for these robots to import in Foxglove or Lichtblick, and end; with"
        " --control it has buttons. It fits logs, too",
    )
    add_force(parser)


def run(options: argparse.Namespace) -> int:
    """Serve until ^C, or write the layout. Raises KickctlError if that cannot begin."""
    if options.layout is not None:
        return _write_layout(options)
    if options.force:
        raise WrongUse("--force is for --layout", "leave it out")
    if options.unattended and not options.control:
        raise WrongUse("--unattended is for robots that are driven", "add --control, or leave it")
    if options.control and options.listen:
        raise WrongUse(
            "--control works on this computer only: nothing is encrypted, so the network could"
            " read the key",
            "leave --listen out, and forward the port: ssh -L 8765:127.0.0.1:8765 THIS-COMPUTER",
        )
    need("foxglove", "foxglove")
    from host.foxglove.server import LOOPBACK, Viewers
    from host.foxglove.station import ShownStation

    with ExitStack() as stack:
        stations = [station_of(one, options, stack, ShownStation) for one in robots_of(options)]
        viewers = stack.enter_context(
            Viewers(
                stations,
                options.port,
                options.listen or LOOPBACK,
                control=options.control,
                say=say,
            )
        )
        with suppress(KeyboardInterrupt):
            _tell(viewers, stations, options)
            while True:
                viewers.look()
                time.sleep(_LOOK_S)
    return 0


def _tell(viewers: Viewers, stations: list[ShownStation], options: argparse.Namespace) -> None:
    """Say where to connect, and with which key."""
    if options.json:
        robots = [
            {"name": station.name, "uri": station.uri, "unattended": station.rule}
            for station in stations
        ]
        show_next({"url": viewers.url, "key": viewers.key or None, "robots": robots})
    else:
        print_result(f"connect {viewers.url}")
        if viewers.key:
            print_result(f"key     {viewers.key}")
    control = " --control" if viewers.key else ""
    say(
        "in Foxglove or Lichtblick: Open connection, Foxglove WebSocket, and this address."
        f" `kickctl foxglove{control} --layout kick.json` writes a layout to import there"
    )
    if viewers.key:
        say("to drive, send the key to the service /unlock; that layout has a button for it")
    if options.listen:
        say(
            f"this opens {options.listen} to others in this network, who may look; nothing is"
            " encrypted"
        )


def _write_layout(options: argparse.Namespace) -> int:
    from host.foxglove.layout import make_layout, to_text

    path = require_place(options, options.layout)
    names = [robot.name for robot in robots_of(options)]
    write_text(path, to_text(make_layout(names, control=options.control)))
    answer_beside(options, path, {"layout": str(path)}, f"layout {path}")
    return 0
