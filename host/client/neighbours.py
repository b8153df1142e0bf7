"""The connections of one program, which must not lock each other out.

To a robot, all connections of one process are the same host: whichever of them took control last
has it. So a cell of a notebook that connects can be run a second time.
"""

from __future__ import annotations

import os
import uuid
from typing import Any, Protocol
from weakref import WeakSet

from host.link.transport import Link

_PROGRAM = uuid.uuid4().hex


class Neighbour(Protocol):
    """A connection as the others of the same program see it."""

    link: Link
    hello: dict[str, Any]

    def lose_control(self) -> None:
        """Another connection of this program drives the robot now."""

    def give_way(self) -> None:
        """Hang up: another connection of this program needs the line."""


_neighbours: WeakSet[Neighbour] = WeakSet()


def client_id() -> str:
    """By what robots know this process; a fork is another one."""
    return f"{_PROGRAM}-{os.getpid()}"


def arrive(newcomer: Neighbour) -> None:
    """Begin a connection; where only one can be open, the one before it hangs up."""
    if newcomer.link.is_line:
        for other in list(_neighbours):
            if other.link.uri == newcomer.link.uri:
                other.give_way()
    _neighbours.add(newcomer)


def take_control(driver: Neighbour) -> None:
    """From now on this connection drives its robot, and no other one of this process."""
    for other in list(_neighbours):
        if other is not driver and other.hello["boot"] == driver.hello["boot"]:
            other.lose_control()
