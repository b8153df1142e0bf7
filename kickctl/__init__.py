"""Kick control for programs and notebooks: robots to drive and to watch, and their logs.

    from kickctl import connect

    with connect("sim://") as robot:
        robot.wait(3)
        outcome = robot.kick_and_watch("phase", ticks=4)
    print(outcome)

The names in `__all__` are the public API. Each is loaded when it is first used.

What goes wrong is a KickctlError with `message`, `hint` and `status`, of one of these kinds:
    WrongUse: The request makes no sense; nothing has changed. LogError is one about a log's file.
    NotDone: The robot has not done it.
    NoLink: The robot cannot be reached, or its link broke.
    RefusedByRobot: Version, token or lease. LeaseLost is one about the lease.
    RobotFault: The robot is in fault.
"""

from __future__ import annotations

from difflib import get_close_matches
from importlib import import_module
from typing import TYPE_CHECKING

from kickctl import _neighbours

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
    from host.logs.log import Log
    from host.logs.mcap_files import LogError
    from host.perform.run import perform as run_experiment
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
    "connect": "kickctl.robots",
    "Robot": "kickctl.robots",
    "KickOutcome": "kickctl.robots",
    "Listener": "host.client.listeners",
    "Records": "host.client.listeners",
    "Log": "host.logs.log",
    "LogError": "host.logs.mcap_files",
    "run_experiment": "host.perform.run",
}
_OTHER_NAMES = {"run_experiment": "perform"}

_neighbours.check()


def __getattr__(name: str) -> object:
    if name not in __all__:
        close = get_close_matches(name, __all__, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(__all__)}"
        raise AttributeError(f"module 'kickctl' has no attribute '{name}'; {hint}", name=name)
    module = import_module(_PLACES.get(name, "host.errors"))
    value: object = getattr(module, _OTHER_NAMES.get(name, name))
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
