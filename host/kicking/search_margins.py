"""How safe a kick is: how far the parameters may be off before it fails, and its odds.

The odds are those of specimens of the motor, with ticks as late as the robot's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.kicking.kick_map import kick_specimens
from host.kicking.rolling_wheels import RollingWheels, roll
from host.kicking.search import Found
from host.util.intervals import wilson
from robot.errors import Refused
from robot.params import Params
from sim_motor.batch import Result

BATTERY = "battery_v"
# What may be off, and by which parts of itself.
MAY_BE_OFF = ("k", "tau_s", "a", BATTERY)
STEPS = (0.1, 0.2, 0.4)
# Simulated wheels for the odds of a kick; about half of them roll its way.
_WHEELS, _SEED = 600, 1
# A kick that is timed for the middle of its window may meet this part of it.
_MIDDLE = 0.5


class Odds(NamedTuple):
    """How many simulated wheels a kick reversed.

    Attributes:
        reversed: How many.
        tried: Of how many.
    """

    reversed: int
    tried: int

    def interval(self) -> tuple[float, float]:
        """The Wilson interval (95 %) of the rate."""
        return wilson(self.reversed, self.tried)


@dataclass(frozen=True)
class Safety:
    """How safe a kick is.

    Attributes:
        margins: For each of MAY_BE_OFF, how far it may be off downward and upward, in parts of
            itself, the greatest of STEPS; 0 for less than the least of them.
        in_window: Its odds if it begins in its window.
        at_any_phase: Its odds at phases by chance.
    """

    margins: dict[str, tuple[float, float]]
    in_window: Odds
    at_any_phase: Odds


def assess(
    kicks: Sequence[Found], wheels: RollingWheels, tell: Callable[[float], None] = lambda part: None
) -> list[Safety]:
    """How safe kicks are.

    Args:
        kicks: The kicks.
        wheels: The wheels for which they were found.
        tell: Called with the part of the work that is done, 0 to 1.
    """
    reach: list[dict[str, list[float]]] = [{name: [0.0, 0.0] for name in MAY_BE_OFF} for _ in kicks]
    sides = [(name, side, sign) for name in MAY_BE_OFF for side, sign in enumerate((-1, 1))]
    for number, (name, side, sign) in enumerate(sides):
        tell(number / len(sides))
        able = list(range(len(kicks)))
        for step in STEPS:
            other = _other_wheels(wheels, name, 1.0 + sign * step) if able else None
            able = [index for index in able if other and _reverses(kicks[index], other)]
            for index in able:
                reach[index][name][side] = step
    tell(1.0)
    return [
        Safety({name: (low, high) for name, (low, high) in own.items()}, *_odds(kick, wheels))
        for own, kick in zip(reach, kicks, strict=True)
    ]


def _other_wheels(wheels: RollingWheels, name: str, factor: float) -> RollingWheels | None:
    """Wheels with another parameter or battery; None if they do not roll, or cannot have it."""
    params, battery_v = Params(), wheels.battery_v
    params.apply(wheels.params.values())
    if name == BATTERY:
        battery_v *= factor
    else:
        try:
            params.apply(params.check({name: factor * getattr(params, name)}))
        except Refused:
            return None
    return roll(params, wheels.motor, wheels.way, battery_v)


def _reverses(kick: Found, wheels: RollingWheels) -> bool:
    """Whether a kick reverses all wheels that it meets in the middle of its window."""
    if kick.window is None:
        return False
    phases, reverses = wheels.kicked(kick.request)
    whole = kick.window.width_rad >= wheels.period_rad
    met = kick.window.holds(phases, wheels.period_rad, 1.0 if whole else _MIDDLE)
    return bool(met.any() and reverses[met].all())


def _odds(kick: Found, wheels: RollingWheels) -> tuple[Odds, Odds]:
    result = kick_specimens(
        kick.request,
        _WHEELS,
        _SEED,
        params=wheels.params,
        motor=wheels.motor,
        battery_v=wheels.battery_v,
    )
    rolls = result.before == wheels.way
    phases = result.kick_phi_rad % wheels.period_rad
    met = np.zeros_like(rolls)
    if kick.window is not None:
        met = rolls & kick.window.holds(phases, wheels.period_rad)
    return _count(result, met), _count(result, rolls)


def _count(result: Result, chosen: NDArray[np.bool_]) -> Odds:
    return Odds(int((result.reversed & chosen).sum()), int(chosen.sum()))
