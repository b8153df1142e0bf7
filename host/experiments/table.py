"""Which experiments there are, and what each can be asked for. Light enough for `kickctl --help`."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from host.errors import WrongUse

if TYPE_CHECKING:
    from host.experiments.experiment import Experiment


class Option(NamedTuple):
    """A number that an experiment can be asked for, of the type of its default, from `least` to `most`."""

    name: str
    default: int | float
    least: float
    most: float
    doc: str


class Entry(NamedTuple):
    """An experiment, for people. claims: ids of the paper's claims that are settled here (others may be touched)."""

    help: str
    options: tuple[Option, ...]
    claims: tuple[str, ...] = ()


TABLE = {
    "primitives": Entry(
        "all motion primitives from each other by kicks, stopped and back: success rates and times, speed, duty, torque",
        (Option("trials", 10, 1, 1000, "tries of each transition"),),
        ("R1", "R2", "R3", "R4", "R7"),
    ),
    "timeline": Entry(
        "the three kicks one after the other: potentials, torque, settling, and the phase slip between the wheels",
        (Option("trials", 25, 1, 10000, "rounds of the three kicks, there and back"),),
        ("R11", "R12"),
    ),
    "reliability": Entry(
        "how surely kicks of 1 to 10 ticks reverse a wheel: position and phase, both signs, and membrane",
        (Option("trials", 50, 1, 100000, "kicks at each point"),),
        ("R8", "R9", "R10"),
    ),
    "kick-map": Entry(
        "success against the kick's length and the wheel's phase when it comes: where the basin lies",
        (Option("kicks", 200000, 36, 100000000, "kicks in all; on a robot a few hundred"),),
    ),
    "bifurcation": Entry(
        "torque and speed against k, swept down and up: the jump, the hysteresis, and the unstable branch between",
        (Option("points", 33, 5, 1000, "values of k in each sweep"),),
        ("R5", "R6"),
    ),
    "wall": Entry(
        "a robot between two walls at k = 2, which reverses by itself; grip, wall stiffness and k varied",
        (Option("bounces", 50, 1, 10000, "bounces to count"),),
        ("R13",),
    ),
    "chaos": Entry(
        "k = 15 and tau = 1 s: torque series, return map, Lyapunov exponent, and where motor latency and inertia make it chaotic",
        (Option("minutes", 10.0, 1.0, 600.0, "length of the series"),),
        ("R14",),
    ),
    "calibrate": Entry(
        "identifies this robot's motor from logs and writes it for sim://?motor=mine",
        (Option("seconds", 120.0, 60.0, 3600.0, "how long to drive the robot about"),),
    ),
}


def load(name: str) -> Experiment:
    """The module of an experiment. Raises WrongUse if there is none."""
    if name not in TABLE:
        raise WrongUse(f"there is no experiment '{name}'", "there are " + ", ".join(TABLE))
    return cast("Experiment", importlib.import_module("host.experiments." + name.replace("-", "_")))


def checked(name: str, arguments: dict[str, Any]) -> dict[str, int | float]:
    """All options of an experiment, those that are not given at their defaults. Raises WrongUse."""
    if name not in TABLE:
        raise WrongUse(f"there is no experiment '{name}'", "there are " + ", ".join(TABLE))
    options = {option.name: option for option in TABLE[name].options}
    for given in arguments:
        if given not in options:
            raise WrongUse(f"the experiment '{name}' has no option '{given}'", "it has " + (", ".join(options) or "none"))
    values = {}
    for option in options.values():
        value = arguments.get(option.name, option.default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not option.least <= value <= option.most:
            raise WrongUse(f"{option.name} cannot be {value!r}", f"give a number from {option.least:g} to {option.most:g}: {option.doc}")
        if isinstance(option.default, int) and value != int(value):
            raise WrongUse(f"{option.name} cannot be {value!r}", f"give a whole number: {option.doc}")
        values[option.name] = type(option.default)(value)
    return values
