"""Wheels with dry friction, which opposes motion in either direction and holds a wheel at rest.

A wheel runs forward, runs backward, or sticks. In each of the three its equations are smooth, and a
step is Runge and Kutta's of order 8. A step in which the wheel stops, or the force exceeds the
friction that holds it, ends at that moment.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from host.theory.engine import runge_kutta
from host.theory.engine.elementary import unlocked, vectorised
from host.theory.model.wheel import OMEGA, Array, Wheel

INERTIA, DRY = Wheel._fields.index("I"), Wheel._fields.index("dry_friction")
# The moment of inertia of a wheel that sticks: no force moves it.
_HELD = 1e300
# A moment is located by as many bisections. A wheel that changes its way more often in a step
# sticks for the rest of it.
_BISECTIONS, _MOST_CHANGES = 60, 20


@cache
def _way(rates_of: Any) -> Any:
    """The compiled function that says which way a wheel moves, -1, 0 or 1.

    A wheel that has stopped moves as the force pulls it, if that exceeds its friction.
    """

    def way(own: Array, constants: Array, dry: float, inertia: float) -> Any:
        if own[OMEGA, 0] != 0.0:
            return np.sign(own[OMEGA, 0])
        constants[INERTIA, 0], constants[DRY, 0] = inertia, 0.0
        rates = np.empty_like(own)
        rates_of(own, constants, rates)
        force = inertia * rates[OMEGA, 0]
        return np.sign(force) if abs(force) > dry else 0.0

    return vectorised(way)


@cache
def _attempting(rates_of: Any) -> Any:
    """The compiled function that takes one step of a wheel that keeps its way.

    It returns the state after it, and whether the wheel would have another way by then.
    """
    step, way_of = runge_kutta.stepping(rates_of), _way(rates_of)

    def attempt(
        own: Array, constants: Array, way: float, dry: float, inertia: float, seconds: float
    ) -> tuple[Array, Any]:
        after = own.copy()
        constants[DRY, 0], constants[INERTIA, 0] = way * dry, inertia if way != 0.0 else _HELD
        step(after, constants, seconds, np.int64(1))  # a literal would be compiled once more
        if way != 0.0:
            return after, after[OMEGA, 0] * way < 0.0
        after[OMEGA, 0] = 0.0
        return after, way_of(after, constants, dry, inertia) != 0.0

    return vectorised(attempt)


@cache
def stepping(rates_of: Any) -> Any:
    """The compiled function that takes `count` steps of step_s, as in runge_kutta.

    The dry friction among the parameters is a torque of 0 or more. rates_of gets it with the sign
    of the motion, so that its equations are those of a wheel in that direction.
    """
    attempt, way_of = _attempting(rates_of), _way(rates_of)

    def steps(states: Array, parameters: Array, step_s: float, count: int) -> None:
        for wheel in range(states.shape[1]):
            own = states[:, wheel : wheel + 1].copy()
            constants = parameters[:, wheel : wheel + 1].copy()
            dry, inertia = constants[DRY, 0], constants[INERTIA, 0]
            for _ in range(count):
                left, changes = step_s, 0
                while left > 0.0:
                    way = way_of(own, constants, dry, inertia) if changes < _MOST_CHANGES else 0.0
                    seconds, low, tries = left, 0.0, 0
                    while True:
                        after, changed = attempt(own, constants, way, dry, inertia, seconds)
                        if changed:
                            high, at_change = seconds, after
                        else:
                            low = seconds
                        if low == left or tries == _BISECTIONS or changes == _MOST_CHANGES:
                            break
                        seconds, tries = (low + high) / 2, tries + 1
                    if low == left or changes == _MOST_CHANGES:
                        own, left = after, 0.0
                    else:
                        own, left, changes = at_change, left - high, changes + 1
                        own[OMEGA, 0] = 0.0
            for row in range(len(states)):
                states[row, wheel] = own[row, 0]

    return unlocked(steps)
