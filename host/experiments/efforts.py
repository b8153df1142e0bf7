"""How long the experiments on a robot take there, and how many trials fit into a time.

Measured on the simulated robot, whose time passes as a real one's does. Like registry.py it imports
nothing heavy.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, floor
from types import MappingProxyType
from typing import Any, NamedTuple

from host.errors import WrongUse
from host.runs.registry import Entry, Option

QUICK_MINUTES = 5.0


class Effort(NamedTuple):
    """The option that sizes an experiment, and the time that it takes on a robot.

    Attributes:
        option: The option's name.
        each_s: How long each unit of it takes, s.
        fixed_s: How long all else takes, s.
        round: How many units are done at once: the run rounds up to these.
        times: The option that says how often all of the units are done; empty if once.
        also_s: How long each unit of other options takes, s, by their names.
        short: The values of other options in a time that is too short for their defaults.
    """

    option: str
    each_s: float
    fixed_s: float = 0.0
    round: int = 1
    times: str = ""
    also_s: Mapping[str, float] = MappingProxyType({})
    short: Mapping[str, int] = MappingProxyType({})

    def seconds(self, options: dict[str, Any]) -> float:
        """How long a whole run takes with these options, s."""
        rounds = float(options[self.option]) / self.round
        units = rounds if self.round == 1 else ceil(rounds) * self.round
        also_s = sum(each_s * float(options[name]) for name, each_s in self.also_s.items())
        return self.fixed_s + also_s + self.unit_s(options) * units

    def unit_s(self, options: dict[str, Any]) -> float:
        """How long each unit takes with these options, s."""
        return self.each_s * float(options[self.times] if self.times else 1)


EFFORTS = {
    "primitives": Effort("trials", 280.0),
    "timeline": Effort("trials", 30.5),
    "reliability": Effort("trials", 91.0),
    "kick-map": Effort("kicks", 2.9, round=36),
    "bifurcation": Effort(
        "points",
        10.0,
        95.0,
        times="rounds",
        also_s={"rounds": 300.0, "branch": 87.0},
        short={"rounds": 1, "branch": 0},
    ),
    "wall": Effort("bounces", 9.8),
    "chaos": Effort("minutes", 60.0, 1.0),
    "starts": Effort("starts", 3.3),
    "predictions": Effort("kicks", 3.3),
    "calibrate": Effort("seconds", 1.0, 3.0),
}


def size(
    name: str, entry: Entry, minutes: float, given: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """The options with which an experiment fits into a time on a robot.

    Args:
        name: The experiment's name, a key of EFFORTS.
        entry: Its entry.
        minutes: The time, minutes.
        given: Other options that are wished so; those left out have their defaults, or, if these
            take too long, fewer repetitions.

    Returns:
        The options' values by their names.

    Raises:
        WrongUse: The experiment cannot be as short as that.
    """
    effort = EFFORTS[name]
    option = _size_option(entry, effort)
    for shorter in ({}, _shorter(effort, given)):
        others = _others(entry, given) | shorter
        fixed_s = effort.seconds({**others, option.name: 0})
        value = (60 * minutes - fixed_s) / effort.unit_s(others)
        if value >= option.least:
            whole = floor(min(value, option.most) / effort.round + 1e-9) * effort.round
            return {option.name: whole if isinstance(option.default, int) else float(whole)} | (
                shorter
            )
    shortest = in_words(effort.seconds({**others, option.name: option.least}))
    raise WrongUse(
        f"{name} does not fit into {minutes:g} minutes: {option.name} = {option.least:g} takes"
        f" {shortest} on a robot",
        "give it more minutes, or take another experiment",
    )


def _others(entry: Entry, given: Mapping[str, Any] | None) -> dict[str, Any]:
    return {option.name: option.default for option in entry.options} | dict(given or {})


def _shorter(effort: Effort, given: Mapping[str, Any] | None) -> dict[str, int]:
    return {name: value for name, value in effort.short.items() if name not in (given or {})}


def quick_minutes(name: str, entry: Entry, given: Mapping[str, Any] | None = None) -> float:
    """QUICK_MINUTES, or the shortest time in which an experiment can be done if that is longer."""
    effort = EFFORTS[name]
    option = _size_option(entry, effort)
    others = _others(entry, given) | _shorter(effort, given)
    return max(QUICK_MINUTES, effort.seconds({**others, option.name: option.least}) / 60)


def _size_option(entry: Entry, effort: Effort) -> Option:
    return next(option for option in entry.options if option.name == effort.option)


def in_words(seconds: float) -> str:
    """A time in words, rounded as an estimate is."""
    if seconds < 90:
        return f"{max(5, 5 * round(seconds / 5))} s"
    minutes = seconds / 60
    if minutes < 100:
        return f"{minutes:.0f} minutes"
    return f"{minutes / 60:.0f} hours" if minutes < 60 * 48 else f"{minutes / 60 / 24:.0f} days"
