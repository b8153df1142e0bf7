"""The smallest quenched kick that reverses a wheel, over parameter, shape, length and phase.

A kick's effort is the integral over time of how far it moves its parameter, relative to the whole
inversion of what the neurons see (beta = 1, or a shift of pi) or, for a, tau and k, to their own
value. A pulse counts if it reverses every wheel that it meets in a window of phases through which a
wheel passes in one tick or more: a robot cannot time a kick better than that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import inf, pi
from typing import Any

from host.kicking.kick_map import lengths, request
from host.kicking.rolling_wheels import RollingWheels, Window
from robot.errors import Refused
from robot.kick_requests import parse
from robot.kicks import (
    DEFAULT_TICKS,
    MEMBRANE,
    PHASE,
    POSITION,
    PULSE,
    RECTANGULAR,
    SMOOTH,
    pulse_weight,
    reversing_shift,
)
from robot.params import Params

SHORTEST, LEAST_EFFORT = GOALS = ("shortest", "least-effort")
# What is pulsed and the amplitudes that are tried, in units of `_unit`, the least first.
_UP, _DOWN = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0), (-0.25, -0.5, -0.75, -0.9, -1.0)
_SHIFTS = tuple(number / 8 for number in range(1, 9))
AMPLITUDES = (
    ("a", _UP),
    ("a", _DOWN),
    ("tau_s", _UP),
    ("tau_s", _DOWN),
    ("k", _UP),
    ("k", _DOWN),
    ("beta", (0.25, 0.5, 0.75, 1.0)),
    ("beta", (-0.25, -0.5, -1.0)),
    ("shift_rad", _SHIFTS),
    ("shift_rad", tuple(-shift for shift in _SHIFTS)),
)
SHAPES = (RECTANGULAR, SMOOTH)
# How often the range in which the least amplitude lies is halved.
_HALVINGS = 7


@dataclass(frozen=True)
class Found:
    """A kick that reverses wheels.

    Attributes:
        request: The kick, as robot.kick_requests.parse takes it, without its id.
        effort_s: Its effort, s; None for a kick that changes no parameter.
        window: The phases at which it reverses every wheel that it meets; None if there are none.
    """

    request: dict[str, Any]
    effort_s: float | None
    window: Window | None


def paper_kicks(wheels: RollingWheels) -> list[Found]:
    """The paper's three kicks with their default lengths, on these wheels."""
    shift = reversing_shift(wheels.way)
    kicks = (
        request(mode, DEFAULT_TICKS[mode], shift if mode == PHASE else None)
        for mode in (MEMBRANE, POSITION, PHASE)
    )
    return [Found(kick, effort_s(kick, wheels.params), wheels.window(kick)) for kick in kicks]


def effort_s(kick: Mapping[str, Any], params: Params) -> float | None:
    """The effort of a kick (s) at these parameters; None for one that changes none of them."""
    own = parse({"id": "effort", **kick}, (0, 0), params, 0)
    if not own.pulse:
        return None
    name = {POSITION: "beta", PHASE: "shift_rad"}.get(own.mode) or kick["param"]
    height = abs(own.values[0] - getattr(params, name, 0.0)) / _unit(name, params)
    weights = sum(pulse_weight(age, own.ticks, own.smooth) for age in range(own.ticks))
    return float(height * weights * params.tick_s)


def search(
    wheels: RollingWheels, goal: str, tell: Callable[[float], None] = lambda part: None
) -> list[Found]:
    """The smallest pulse of each parameter that reverses wheels.

    Args:
        wheels: The wheels.
        goal: One of GOALS: the fewest ticks, and of these the widest window; or the least effort.
        tell: Called with the part of the search that is done, 0 to 1.

    Returns:
        The best pulses, one for each sign of each parameter that can do it, the best first.
    """
    found = []
    smallest = _shortest if goal == SHORTEST else _least_effort
    for number, (name, amplitudes) in enumerate(AMPLITUDES):
        tell(number / len(AMPLITUDES))
        best = smallest(wheels, name, amplitudes)
        if best is not None:
            found.append(best)
    tell(1.0)
    return sorted(found, key=partial(_rank, goal))


def _rank(goal: str, found: Found) -> tuple[float, float]:
    ticks, width_rad = found.request["ticks"], found.window.width_rad if found.window else 0.0
    effort = found.effort_s or 0.0
    return (ticks, -width_rad) if goal == SHORTEST else (effort, ticks)


def _unit(name: str, params: Params) -> float:
    """The amplitude of 1 in the parameter's own unit."""
    return {"beta": 1.0, "shift_rad": pi}.get(name) or float(getattr(params, name))


def _pulse(
    name: str, amplitude: float, ticks: int, shape: str, params: Params
) -> dict[str, Any] | None:
    """The request for a pulse of this amplitude; None if the robot would refuse it."""
    value = getattr(params, name, 0.0) + amplitude * _unit(name, params)
    kick = {"mode": PULSE, "param": name, "value": value, "ticks": ticks}
    if shape == SMOOTH:
        kick["shape"] = shape
    try:
        parse({"id": "search", **kick}, (0, 0), params, 0)
    except Refused:
        return None
    return kick


def _try(wheels: RollingWheels, kick: dict[str, Any]) -> Found | None:
    """The kick with its window; None if that is narrower than a tick."""
    window = wheels.window(kick)
    if window is None or window.width_rad < min(wheels.step_rad, wheels.period_rad):
        return None
    return Found(kick, effort_s(kick, wheels.params), window)


def _pulses(
    wheels: RollingWheels, name: str, amplitudes: tuple[float, ...], ticks: int, shape: str
) -> Iterator[tuple[float, float, dict[str, Any]]]:
    """Each pulse that the robot takes, with its amplitude and the next smaller one."""
    smaller = 0.0
    for amplitude in amplitudes:
        kick = _pulse(name, amplitude, ticks, shape, wheels.params)
        if kick is not None:
            yield smaller, amplitude, kick
            smaller = amplitude


def _shortest(wheels: RollingWheels, name: str, amplitudes: tuple[float, ...]) -> Found | None:
    for ticks in range(1, max(lengths(wheels.params.tick_s)) + 1):
        shapes = SHAPES if ticks > 1 else (RECTANGULAR,)
        able = [
            found
            for shape in shapes
            for _, _, kick in _pulses(wheels, name, amplitudes, ticks, shape)
            if (found := _try(wheels, kick))
        ]
        if able:
            return min(able, key=partial(_rank, SHORTEST))
    return None


def _least_effort(wheels: RollingWheels, name: str, amplitudes: tuple[float, ...]) -> Found | None:
    best, least_s = None, inf
    for ticks, shape in product(lengths(wheels.params.tick_s), SHAPES):
        for smaller, amplitude, kick in _pulses(wheels, name, amplitudes, ticks, shape):
            # No pulse of this form that is left to try has less than this.
            if (effort_s(kick, wheels.params) or 0.0) * smaller / amplitude >= least_s:
                break
            found = _try(wheels, kick)
            if found is not None:
                found = _least_amplitude(wheels, found, smaller, amplitude)
                if (found.effort_s or 0.0) < least_s:
                    best, least_s = found, found.effort_s or 0.0
                break
    return best


def _least_amplitude(wheels: RollingWheels, found: Found, too_small: float, enough: float) -> Found:
    """The pulse of the same parameter, length and shape with the least amplitude that reverses.

    It lies between two amplitudes, one too small and one that does it, that of `found`.
    """
    kick = found.request
    for _ in range(_HALVINGS):
        middle = (too_small + enough) / 2
        pulse = _pulse(
            kick["param"], middle, kick["ticks"], kick.get("shape", RECTANGULAR), wheels.params
        )
        smaller = _try(wheels, pulse) if pulse else None
        if smaller is None:
            too_small = middle
        else:
            found, enough = smaller, middle
    return found
