"""How long the experiments on a robot take there, and how many trials fit into a time.

Measured on the simulated robot, whose time passes as a real one's does. Like registry.py it imports
nothing heavy.
"""

from __future__ import annotations

from math import ceil, floor
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
    """

    option: str
    each_s: float
    fixed_s: float = 0.0
    round: int = 1

    def seconds(self, options: dict[str, Any]) -> float:
        """How long a whole run takes with these options, s."""
        rounds = float(options[self.option]) / self.round
        return self.fixed_s + self.each_s * (
            rounds if self.round == 1 else ceil(rounds) * self.round
        )


EFFORTS = {
    "primitives": Effort("trials", 280.0),
    "timeline": Effort("trials", 30.5),
    "reliability": Effort("trials", 91.0),
    "kick-map": Effort("kicks", 2.9, round=36),
    "bifurcation": Effort("points", 30.0, 2135.0),
    "wall": Effort("bounces", 9.8),
    "chaos": Effort("minutes", 60.0, 1.0),
    "starts": Effort("starts", 3.3),
    "predictions": Effort("kicks", 3.3),
    "calibrate": Effort("seconds", 1.0, 3.0),
}


def size(name: str, entry: Entry, minutes: float) -> dict[str, Any]:
    """The option with which an experiment fits into a time on a robot.

    Args:
        name: The experiment's name, a key of EFFORTS.
        entry: Its entry.
        minutes: The time, minutes.

    Returns:
        The option's value by its name.

    Raises:
        WrongUse: The experiment cannot be as short as that.
    """
    effort = EFFORTS[name]
    option = _size_option(entry, effort)
    value = (60 * minutes - effort.fixed_s) / effort.each_s
    if value < option.least:
        shortest = in_words(effort.seconds({option.name: option.least}))
        raise WrongUse(
            f"{name} does not fit into {minutes:g} minutes: {option.name} = {option.least:g}"
            f" takes {shortest} on a robot",
            "give it more minutes, or take another experiment",
        )
    whole = floor(min(value, option.most) / effort.round + 1e-9) * effort.round
    return {option.name: whole if isinstance(option.default, int) else float(whole)}


def quick_minutes(name: str, entry: Entry) -> float:
    """QUICK_MINUTES, or the shortest time in which an experiment can be done if that is longer."""
    effort = EFFORTS[name]
    option = _size_option(entry, effort)
    return max(QUICK_MINUTES, effort.seconds({option.name: option.least}) / 60)


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
