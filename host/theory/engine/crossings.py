"""Where wheels cross a surface of section, each moment by Newton's method on the flow itself.

A moment is the length of a step of Runge and Kutta's method of order 8 that ends on the surface, so
that it is as exact as the steps; nothing is interpolated (Henon, Physica D 5, 1982, for another way
to the same end).
"""

from __future__ import annotations

from functools import cache
from math import cos, sin
from typing import Any, Literal, NamedTuple

import numpy as np

from host.theory.engine.ensemble import rate_per_s, require_loose
from host.theory.engine.flow import FINENESS
from host.theory.engine.runge_kutta import STAGES, TABLEAU
from host.theory.model.laws import Law, law_of, under
from host.theory.model.wheel import OMEGA, PHI, Array, rates
from sim_motor.compiled import inner_jit, over_cores, unlocked_jit

# phi: a wheel comes to a multiple of a quarter turn. omega: it turns round.
Surface = Literal["phi", "omega"]
EQUATIONS: dict[Surface, str] = {"phi": "sin(2 phi) = 0", "omega": "omega = 0"}
# Newton's method is done if a moment (relative to the step) changes less than this, or after
# _MOST steps; some of them bisect.
_SAME, _MOST = 1e-14, 60


def _rates_of(state: Array, constants: Array) -> Any:
    """The rates of a state, (4,)."""
    return rates(
        state[0],
        state[1],
        state[2],
        state[3],
        constants[0],
        constants[1],
        constants[2],
        constants[3],
        constants[4],
        constants[5],
        constants[6],
    )


def _step(at: Array, constants: Array, step_s: float, after: Array) -> None:
    """One step from the state `at`, (4,), into `after`."""
    stages = np.empty((STAGES, 4))
    for row in range(4):
        after[row] = at[row]
    for stage in range(1, STAGES + 1):
        (
            stages[stage - 1, 0],
            stages[stage - 1, 1],
            stages[stage - 1, 2],
            stages[stage - 1, 3],
        ) = _rates_of(after, constants)
        for row in range(4):
            total = 0.0
            for earlier in range(stage):
                total += TABLEAU[stage, earlier] * stages[earlier, row]
            after[row] = at[row] + step_s * total


def _height(state: Array, constants: Array, turns: bool) -> tuple[float, float]:
    """How far a state is from the surface, and the rate of that."""
    if not turns:
        return sin(2.0 * state[PHI]), 2.0 * cos(2.0 * state[PHI]) * state[OMEGA]
    return state[OMEGA], _rates_of(state, constants)[OMEGA]


def _moment(
    at: Array, constants: Array, turns: bool, low: float, high: float, above: bool, there: Array
) -> float:
    """The length of the step, between two others, that ends on the surface in the state `there`.

    above: whether the shorter one ends above it.
    """
    own_low, own_high, step_s = low, high, (low + high) / 2.0
    for _ in range(_MOST):
        _step(at, constants, step_s, there)
        height, rate = _height(there, constants, turns)
        if (height > 0.0) == above:
            own_low = step_s
        else:
            own_high = step_s
        better = step_s - height / rate
        if not own_low <= better <= own_high:
            better = (own_low + own_high) / 2.0
        change, step_s = abs(better - step_s), better
        if change <= _SAME * high:
            break
    _step(at, constants, step_s, there)
    return step_s


def _nearest(first: float, rate: float, last: float, last_rate: float, step_s: float) -> Any:
    """When a height that shrinks and grows again is least, by Hermite's cubic; 0 if it does not."""
    if rate * first >= 0.0 or last_rate * last <= 0.0:
        return 0.0
    # The cubic's rate is 3 square s^2 + 2 linear s + rate, with s from 0 to 1.
    mean = (last - first) / step_s
    square, linear = rate + last_rate - 2.0 * mean, 3.0 * mean - 2.0 * rate - last_rate
    root = np.sqrt(linear * linear - 3.0 * square * rate)
    return step_s * -rate / (linear + (root if first > 0.0 else -root))


def _follow_some(
    states: Array,
    parameters: Array,
    steps_s: Array,
    counts: Any,
    turns: bool,
    times: Array,
    found: Array,
    seen: Any,
    first: int,
    every: int,
) -> None:
    """Follow wheels, (4, wheels), in counts[wheel] steps; keep their first crossings.

    It is one of `every` wheels, from the first on.
    """
    most = times.shape[1]
    for wheel in range(first, states.shape[1], every):
        at, after, there = states[:, wheel].copy(), np.empty(4), np.empty(4)
        constants, step_s = parameters[:, wheel].copy(), steps_s[wheel]
        height, rate = _height(at, constants, turns)
        for index in range(counts[wheel]):
            _step(at, constants, step_s, after)
            later, later_rate = _height(after, constants, turns)
            above, ends = height > 0.0, later > 0.0
            # A crossing lies before `middle` if the wheel is on the other side then, and one more
            # after it if it comes back.
            middle = step_s if ends != above else _nearest(height, rate, later, later_rate, step_s)
            if ends == above and middle > 0.0:
                _step(at, constants, middle, there)
                if (_height(there, constants, turns)[0] > 0.0) == above:
                    middle = 0.0
            begin, end = 0.0, middle
            while end > begin:
                if seen[wheel] < most:
                    moment_s = _moment(at, constants, turns, begin, end, above, there)
                    times[wheel, seen[wheel]] = index * step_s + moment_s
                    for row in range(4):
                        found[wheel, seen[wheel], row] = there[row]
                seen[wheel] += 1
                begin, end, above = end, step_s, not above
            for row in range(4):
                at[row] = after[row]
            height, rate = later, later_rate
        for row in range(4):
            states[row, wheel] = at[row]


@cache
def _following(law: Law) -> Any:
    """`_follow_some` compiled, with the equations of a law."""

    def finish(function: Any) -> Any:
        return (unlocked_jit if function.__name__ == _follow_some.__name__ else inner_jit)(function)

    return under(law, _follow_some, {}, finish)


class Crossings(NamedTuple):
    """How wheels crossed a surface.

    Attributes:
        times_s: when, s from the start, (crossings,) of each wheel.
        states: in which states, (crossings, 4) of each wheel.
        ended: where the wheels ended, (4, wheels).
    """

    times_s: list[Array]
    states: list[Array]
    ended: Array


def crossings(
    states: Array,
    parameters: Array,
    seconds: float,
    surface: Surface = "phi",
    most: int = 10_000,
    fineness: float = FINENESS,
) -> Crossings:
    """Follow wheels, and find where they cross a surface in either direction.

    Two crossings within a step are found, too, unless a wheel only just touches the surface.

    Args:
        states: Where they start, (4, wheels).
        parameters: Their constants, (constants, wheels), without dry friction.
        seconds: How long to follow them, s.
        surface: A key of EQUATIONS.
        most: How many crossings of a wheel are kept at most: the first ones.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.flow).

    Returns:
        The crossings.

    Raises:
        WrongUse: A wheel is too stiff to be followed.
    """
    require_loose(parameters, seconds * fineness)
    wheels = states.shape[1]
    counts = np.maximum(1, np.ceil(seconds * fineness * rate_per_s(parameters))).astype(np.int64)
    ended = np.ascontiguousarray(states, dtype=np.float64).copy()
    times, found = np.empty((wheels, most)), np.empty((wheels, most, 4))
    seen = np.zeros(wheels, dtype=np.int64)
    follow_some = _following(law_of(parameters))
    given = np.ascontiguousarray(parameters), seconds / counts, counts, surface == "omega"
    over_cores(
        lambda core, cores: follow_some(ended, *given, times, found, seen, core, cores), wheels
    )
    kept = np.minimum(seen, most).tolist()
    return Crossings(
        [times[wheel, :count] for wheel, count in enumerate(kept)],
        [found[wheel, :count] for wheel, count in enumerate(kept)],
        ended,
    )
