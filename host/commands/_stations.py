"""Robots that are shown live, each by a station of its own."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from ipaddress import ip_address
from typing import TYPE_CHECKING, TypeVar

from host.commands._terminal import say
from host.errors import WrongUse
from host.link.addresses import SIM, sim_options, with_params
from host.link.names import chosen, is_several, named, several
from host.link.robots_file import Known
from host.util.interrupts import uninterrupted
from host.util.numbers import Number

if TYPE_CHECKING:
    from host.lab.live_station import LiveStation
    from host.lab.live_twin import LiveTwin

S = TypeVar("S", bound="LiveStation")


def network_address(text: str) -> str:
    """The address at which others reach this computer, as an option takes it.

    A name or 'every address' would let foreign sites in by a name.
    """
    try:
        address = ip_address(text)
    except ValueError:
        address = None
    if address is None or address.is_unspecified or address.is_multicast:
        raise argparse.ArgumentTypeError(
            f"cannot be '{text}'; give one IP address of this computer, as in 192.168.1.5;"
            " `ip address` shows them"
        )
    return str(address)


def add_port(parser: argparse.ArgumentParser, served: str, usual: int) -> None:
    """Add --port.

    Args:
        parser: Gets the option.
        served: What is served there, in words.
        usual: The port without the option.
    """
    parser.add_argument(
        "--port",
        type=Number(least=0, most=65535, whole=True),
        default=usual,
        metavar="N",
        help=f"TCP port of the {served}, a whole number; 0 for any that is free"
        " (default %(default)s)",
    )


def add_unattended(parser: argparse.ArgumentParser, left_alone: str) -> None:
    """Add --unattended.

    Args:
        parser: Gets the option.
        left_alone: When a robot counts as left alone, in words.
    """
    parser.add_argument(
        "--unattended",
        choices=("stop", "continue"),
        help=f"what a robot does when {left_alone} for 1 s (default: real robots stop, simulated"
        " ones continue)",
    )


def robots_of(options: argparse.Namespace) -> list[Known]:
    """The robots that a command line names. Raises WrongUse."""
    text = named(options.brick)
    robots = several(text) if text is not None and is_several(text) else [chosen(text)]
    if options.seed is not None and any(sim_options(one.address) is None for one in robots):
        raise WrongUse(
            f"--seed is only for the robot that is embedded in this program, {SIM}",
            "leave it out: a robot elsewhere has the seed that it was started with",
        )
    return _told_apart(robots)


def _told_apart(robots: list[Known]) -> list[Known]:
    """The robots with names by which people tell simulated ones without a name apart."""
    nameless = [
        one for one in robots if one.name == one.address and sim_options(one.address) is not None
    ]
    names = dict.fromkeys(nameless, "simulated")
    if len(nameless) > 1:
        names = {one: f"simulated-{number}" for number, one in enumerate(nameless, 1)}
    return [one._replace(name=names.get(one, one.name)) for one in robots]


def station_of(
    robot: Known,
    options: argparse.Namespace,
    stack: ExitStack,
    kind: type[S],
    walls_m: float | None = None,
    twin: LiveTwin | None = None,
) -> S:
    """The station of a robot, which looks for it already. A simulated one is started for it.

    Args:
        robot: The robot.
        options: Of the command, with --unattended, --token and --seed.
        stack: Ends what is begun here.
        kind: What kind of station.
        walls_m: The walls' distance for a simulated robot (m); None for what its address says.
        twin: Its simulated twin; None for none.
    """
    from host.lab.desk_robot import DeskRobot, child_options
    from host.lab.station import CONTINUE, STOP

    if sim_options(robot.address) is None:
        robot = robot._replace(token=options.token or robot.token)
        station = kind(robot, options.unattended or STOP, "real", twin=twin)
    else:
        address = robot.address
        if walls_m is not None:
            address = with_params(address, [f"walls={walls_m:g}"])
        walls = (sim_options(address) or {}).get("walls")
        desk = stack.enter_context(DeskRobot(child_options(address, options.seed)))
        station = kind(
            Known(robot.name, desk.uri, desk.token),
            options.unattended or CONTINUE,
            "simulated",
            walls_m=None if walls is None else float(walls),
            pull=desk.pull,
            twin=twin,
        )
        desk.on_end = station.say_end
    stack.callback(_end, station)
    station.start()
    return station


def _end(station: LiveStation) -> None:
    with uninterrupted():
        words = station.end()
        if words:
            say(f"{station.name}: {words}")
