"""Kick control for programs and notebooks: robots to drive and to watch, and their logs.

    from kickctl import connect

    with connect("sim://") as robot:
        robot.wait(3)
        outcome = robot.kick_and_watch("phase", ticks=4)
    print(outcome)

The names in `__all__` are the public API, with those of `kickctl.theory`, the paper's model of a
wheel. Each is loaded when it is first used.

What goes wrong is a KickctlError with `message`, `hint` and `status`. A notebook shows both texts;
after `except KickctlError as error`, print `error.message` and `error.hint`. It is of one of these
kinds:

    WrongUse: The request makes no sense; nothing has changed. LogError is one about a log's file.
    NotDone: The robot has not done it.
    NoLink: The robot cannot be reached, or its link broke.
    RefusedByRobot: Version, token or lease. LeaseLost is one about the lease.
    RobotFault: The robot is in fault.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kickctl import _neighbours
from kickctl._lazy import load

if TYPE_CHECKING:
    from host.client.listeners import Listener, Records
    from host.errors import (
        KickctlError,
        LeaseLost,
        NoLink,
        NotDone,
        RefusedByRobot,
        RobotFault,
        WrongUse,
    )
    from host.logs.mcap_files import LogError
    from host.perform.run import perform as run_experiment
    from kickctl.logs import Log
    from kickctl.robots import KickOutcome, Robot, connect

__all__ = (
    "connect",
    "Robot",
    "KickOutcome",
    "Listener",
    "Records",
    "Log",
    "run_experiment",
    "KickctlError",
    "NotDone",
    "WrongUse",
    "LogError",
    "NoLink",
    "RefusedByRobot",
    "LeaseLost",
    "RobotFault",
)

_PLACES = {
    **dict.fromkeys(__all__, "host.errors"),
    "connect": "kickctl.robots",
    "Robot": "kickctl.robots",
    "KickOutcome": "kickctl.robots",
    "Listener": "host.client.listeners",
    "Records": "host.client.listeners",
    "Log": "kickctl.logs",
    "LogError": "host.logs.mcap_files",
    "run_experiment": "host.perform.run:perform",
}

_neighbours.check()


def __getattr__(name: str) -> object:
    globals()[name] = value = load("kickctl", name, __all__, _PLACES.get(name))
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
