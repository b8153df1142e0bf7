"""kickctl lab."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser
from contextlib import ExitStack, suppress
from ipaddress import ip_address
from typing import TYPE_CHECKING, Any

from host.commands import _lab_replay
from host.commands._stations import add_port, add_unattended, network_address, robots_of, station_of
from host.commands._terminal import print_result, say, show_next
from host.errors import WrongUse
from host.link.addresses import sim_options
from host.link.robots_file import Known
from host.util.numbers import Number

if TYPE_CHECKING:
    from host.lab.live_station import LiveStation
    from host.lab.live_twin import LiveTwin
    from host.lab.server import Lab

HELP = (
    "open a page on which you watch running robots, kick them, and see their attractors and"
    " basins. Without --brick it is a simulated robot. ^C ends the lab, and the exit status is 0"
)
# Robots and pages come before predictions and checks, and these before basins.
_BASINS_NICENESS, _CHECKS_NICENESS = 10, 5
# How long a robot may take to answer before the command says that it is not there yet (s).
_FIND_S = 3.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to serve, and what happens to a robot to which nobody attends."""
    add_port(parser, "page", 5426)
    network = parser.add_mutually_exclusive_group()
    network.add_argument(
        "--host",
        type=network_address,
        metavar="ADDRESS",
        help="an address of this computer in its network: who has the view address may watch there,"
        " answer and stop, and drives only if a page hands over the baton (default: this computer"
        " only)",
    )
    network.add_argument(
        "--class",
        dest="host",
        action=_OwnAddress,
        help="the same at this computer's own address, which is looked up",
    )
    parser.add_argument("--no-open", action="store_true", help="open no browser")
    add_unattended(parser, "the page that drives it is hidden, closed or asleep")
    parser.add_argument(
        "--walls",
        type=Number("m", 0.3, 100.0),
        metavar="M",
        help="put the simulated robot between two walls at this distance, in m",
    )
    parser.add_argument(
        "--twin",
        nargs="?",
        const="",
        metavar="MOTOR",
        help="show beside each robot, or beside the robot of a log, its simulated twin: the same"
        " program under the same kicks, with the motor of this entry of a motors file, as"
        " `kickctl experiment calibrate` writes one (default: the robot's own)",
    )
    _lab_replay.add_arguments(parser)


def run(options: argparse.Namespace) -> int:
    """Serve the page until ^C. Raises KickctlError if that cannot begin."""
    if _lab_replay.wants_replay(options):
        return _lab_replay.run(options, _open)
    from host.lab.forecasts import Forecasts
    from host.lab.live_station import LiveStation
    from host.lab.replays import Replays
    from host.lab.server import Lab
    from host.lab.worker import Worker

    with ExitStack() as stack:
        forecasts, basins = Forecasts(), Worker("computes basins", _BASINS_NICENESS)
        checks = Worker("checks exercises", _CHECKS_NICENESS)
        for worker in (forecasts, basins, checks):
            stack.callback(worker.close)
        robots = robots_of(options)
        walls_m = _walls_m(options, robots)
        twins = [_twin_of(options) for _ in robots]
        stations = [
            station_of(one, options, stack, LiveStation, walls_m, twin)
            for one, twin in zip(robots, twins, strict=True)
        ]
        lab = stack.enter_context(
            Lab(
                stations,
                options.port,
                options.host,
                forecasts=forecasts,
                basins=basins,
                replays=Replays(),
                checks=checks,
            )
        )
        with suppress(KeyboardInterrupt):
            _tell(lab, stations, options)
            forecasts.begin()
            basins.begin()
            lab.wait()
    return 0


class _OwnAddress(argparse.Action):
    """Takes the address of this computer in its network for --host."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(nargs=0, **settings)

    def __call__(self, parser: argparse.ArgumentParser, options: Any, *_: object) -> None:
        from robot.program import own_address

        address = own_address()
        if ip_address(address).is_loopback:
            parser.error(
                "argument --class: this computer is in no network; join one, or leave --class out"
            )
        options.host = address


def _walls_m(options: argparse.Namespace, robots: list[Known]) -> float | None:
    """How far apart the walls are that were asked for. Raises WrongUse for a real robot."""
    if options.walls is not None and any(sim_options(one.address) is None for one in robots):
        raise WrongUse("--walls is for the simulated robot", "leave it or --brick out")
    return None if options.walls is None else float(options.walls)


def _twin_of(options: argparse.Namespace) -> LiveTwin | None:
    """A twin for a robot, if twins are wanted. Raises WrongUse if its motor is not known."""
    if options.twin is None:
        return None
    from host.lab.live_twin import LiveTwin

    return LiveTwin(options.twin)


def _tell(lab: Lab, stations: list[LiveStation], options: argparse.Namespace) -> None:
    """Say where the page is, open it, and say which robots are not there."""
    if options.json:
        robots = [
            {"name": station.name, "uri": station.uri, "unattended": station.rule}
            for station in stations
        ]
        show_next({"drive": lab.drive_url, "view": lab.view_url, "robots": robots})
    else:
        print_result(f"drive {lab.drive_url}\nview  {lab.view_url}")
    if options.host:
        say(
            f"this opens {options.host} to others in this network: who has the view address may"
            " watch, answer and stop, and drives only if your page hands over the baton. Nothing is"
            " encrypted. The drive address works on this computer only"
        )
    if not options.no_open:
        _open(lab.drive_url)
    for station in stations:
        if not station.met.wait(_FIND_S):
            say(
                f"{station.name} is not there yet: {station.trouble or 'it does not answer'}\n"
                "  the page shows it as lost, and finds it when it comes"
            )
        elif station.twin is not None and station.twin.trouble is not None:
            trouble = station.twin.trouble
            say(f"{station.name} has no twin: {trouble.message}\n  {trouble.hint}")


def _open(url: str) -> None:
    graphical = sys.platform != "linux" or {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ)
    if not graphical or not webbrowser.open(url):
        say("no browser opens here: open the drive address yourself")
