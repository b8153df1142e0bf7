"""The connections of one program, which must not lock each other out.

To a robot, all connections of one process are the same host: whichever of them took control last
has it. So a cell of a notebook that connects can be run a second time, and a robot that it drives
drives on: the new connection inherits the control of the one that it replaces.
"""

from __future__ import annotations

import logging
import os
import uuid
from itertools import count
from typing import Any, Protocol
from weakref import WeakValueDictionary

from host.link.serial_line import SerialLink
from host.link.transport import Link

_PROGRAM = uuid.uuid4().hex


class Control:
    """Whether a connection drives its robot. It outlives the connection, so as to be inherited.

    taken_over_by: who has taken control from it; None if nobody has, or it has control again.
    """

    def __init__(self, name: str, link: Link) -> None:
        self.name = name
        self.uri = link.uri
        self.embedded = link.virtual
        self.held = False
        self.taken_over_by: str | None = None
        self.boot: object = None


class Neighbour(Protocol):
    """A connection as the others of the same program see it."""

    link: Link
    hello: dict[str, Any]

    @property
    def may_drive(self) -> bool:
        """Whether it is open, and robot and host have shown each other the token."""

    def gain_control(self) -> None:
        """This connection drives the robot now, instead of another one of this program."""

    def lose_control(self) -> None:
        """Another connection of this program drives the robot now."""

    def give_way(self) -> Control:
        """Hang up: another connection of this program needs the line. Returns what it had."""


# By their age: the newest comes last.
_neighbours: WeakValueDictionary[int, Neighbour] = WeakValueDictionary()
_numbers = count()


def client_id() -> str:
    """By what robots know this process; a fork is another one."""
    return f"{_PROGRAM}-{os.getpid()}"


def arrive(newcomer: Neighbour) -> list[Control]:
    """Begin a connection; where only one can be open, the one before it hangs up.

    Returns:
        The control that was left by those that hung up, for `inherit`.
    """
    line = _line_of(newcomer.link)
    left = [
        other.give_way()
        for other in list(_neighbours.values())
        if line is not None and _line_of(other.link) == line
    ]
    _neighbours[next(_numbers)] = newcomer
    return left


def take_control(driver: Neighbour) -> None:
    """From now on this connection drives its robot, and no other one of this process."""
    for other in list(_neighbours.values()):
        if other is not driver and other.hello["boot"] == driver.hello["boot"]:
            other.lose_control()


def inherit(control: Control) -> None:
    """Hand on the control of a connection that is gone to the newest one to the same robot.

    It has to send heartbeats from now on, before the robot takes this host for lost.
    """
    if not control.held:
        return
    control.held = False
    for heir in reversed(list(_neighbours.values())):
        if heir.hello["boot"] == control.boot and heir.may_drive:
            heir.gain_control()
            return
    if not control.embedded:  # an embedded robot is gone as well
        logging.getLogger("kickctl").warning(
            "the connection '%s', which drove %s, is gone: nothing refers to it any more, and no"
            " other connection of this program may drive. The robot stops, unless its parameter"
            " link_loss says otherwise. `close()` hangs up and lets the robot go on",
            control.name,
            control.uri,
        )


def _line_of(link: Link) -> str | None:
    """The device file of a serial line by its own name; None for other links."""
    return os.path.realpath(link.device) if isinstance(link, SerialLink) else None
