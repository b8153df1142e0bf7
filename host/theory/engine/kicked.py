"""A wheel and its kicks, the same way for the continuous model and for the one that steps by ticks.

A quenched kick changes only what the neurons see: the rods pull where the wheel really is. A frozen
kick changes the neurons. Both are robot/kicks.py's.
"""

from __future__ import annotations

from functools import cache
from math import inf
from typing import Any, NamedTuple, Protocol

import numpy as np

from host.theory.engine import ensemble, sampled
from host.theory.engine.elementary import MATHEMATICS, inlined, vectorised
from host.theory.engine.ensemble import FINE, Averages
from host.theory.engine.sampled import Clock, Seen, ticks_in
from host.theory.model.laws import Law, law_of, under
from host.theory.model.wheel import OMEGA, Array, Wheel, seen_rates
from robot.controller import actual_positions
from robot.kick_requests import parse
from robot.kicks import (
    DEFAULT_SHIFT_RAD,
    MEMBRANE,
    PHASE,
    POSITION,
    apply_pulse,
    invert_membrane,
    seen_positions,
)
from robot.params import Params

# Mode, and sign of the shift.
KICKS = ((MEMBRANE, 0), (POSITION, 0), (PHASE, 1), (PHASE, -1))


class Model(Protocol):
    """Wheels, (rows, wheels), whose rows begin with x1, x2, phi and omega.

    Parameters are (constants, wheels).
    """

    def states_of(self, states: Array) -> Array:
        """The model's states, from (x1, x2, phi, omega), (4, wheels)."""

    def averages(self, states: Array, parameters: Array, seconds: float) -> Averages:
        """Averages over some seconds, and the states after them.

        Raises:
            WrongUse: Wheels cannot be followed.
        """

    def kicked(self, states: Array, parameters: Array, seconds: float, seen: Seen) -> Array:
        """The states after some seconds in which the neurons saw what a kick shows them."""


class Continuous(NamedTuple):
    """The paper's equations, in steps as fine as host.theory.engine.ensemble has them."""

    fineness: float = FINE

    def states_of(self, states: Array) -> Array:
        return np.array(states, dtype=np.float64)

    def averages(self, states: Array, parameters: Array, seconds: float) -> Averages:
        return ensemble.averages(states, parameters, 0.0, seconds, self.fineness)

    def kicked(self, states: Array, parameters: Array, seconds: float, seen: Seen) -> Array:
        carried = np.vstack([states, np.repeat(np.array(seen)[:, None], states.shape[1], axis=1)])
        own_rates = _seeing_rates(law_of(parameters))
        return ensemble.advance(carried, parameters, seconds, self.fineness, own_rates)[: OMEGA + 1]


class Sampled(NamedTuple):
    """The map from tick to tick. Seconds are rounded to ticks."""

    clock: Clock = Clock()

    def states_of(self, states: Array) -> Array:
        return sampled.unforced(states)

    def averages(self, states: Array, parameters: Array, seconds: float) -> Averages:
        return sampled.averages(states, parameters, self.clock, ticks_in(seconds, self.clock))

    def kicked(self, states: Array, parameters: Array, seconds: float, seen: Seen) -> Array:
        return sampled.advance(states, parameters, self.clock, ticks_in(seconds, self.clock), seen)


def seen_in(mode: str, sign: int) -> Seen:
    """What a quenched kick of robot/kicks.py does to what the neurons see, at its height.

    Args:
        mode: The kick's.
        sign: That of a phase kick's shift; 0 for another kick.
    """
    kick = parse(
        {"id": mode, "mode": mode} | ({"shift": sign * DEFAULT_SHIFT_RAD} if sign else {}),
        (0, 0),
        Params(),
        0,
    )
    *_, beta, shift_rad = apply_pulse(kick.pulse, kick.values[0], 1.0, 0.0, 0.0, 0.0)
    return Seen(beta, shift_rad)


def memory_s(wheel: Wheel) -> float:
    """For how long a wheel remembers, s: its neurons' time constant and that of its friction.

    It is infinite without friction.
    """
    return wheel.tau + (wheel.I / wheel.f if wheel.f else inf)


def inverted(states: Array) -> Array:
    """The states after the frozen kick that inverts the membrane potentials."""
    return np.vstack([*invert_membrane(states[0], states[1]), states[2:]])


def _rates(
    x1: Any, x2: Any, phi: Any, omega: Any, beta: Any, shift_rad: Any, constants: Any
) -> Any:
    a, tau_s, k, inertia, friction, dry_friction, bounded = constants
    actual_1, actual_2 = actual_positions(phi)
    seen_1, seen_2 = seen_positions(phi, beta, shift_rad)
    return seen_rates(
        x1,
        x2,
        omega,
        actual_1,
        actual_2,
        seen_1,
        seen_2,
        a,
        tau_s,
        k,
        inertia,
        friction,
        dry_friction,
        bounded,
    )


@cache
def _seeing_rates(law: Law) -> Any:
    """The compiled rates of wheels under a kick.

    Rows 4 and 5 of the states are what the kick does to what the neurons see. They stay.
    """
    vectorised_rates: Any = under(law, _rates, MATHEMATICS, inlined)

    def seeing_rates(states: Array, parameters: Array, out: Array) -> None:
        for i in range(states.shape[1]):
            constants = (
                parameters[0, i],
                parameters[1, i],
                parameters[2, i],
                parameters[3, i],
                parameters[4, i],
                parameters[5, i],
                parameters[6, i],
            )
            out[0, i], out[1, i], out[2, i], out[3, i] = vectorised_rates(
                states[0, i],
                states[1, i],
                states[2, i],
                states[3, i],
                states[4, i],
                states[5, i],
                constants,
            )
            out[4, i] = out[5, i] = 0.0

    return vectorised(seeing_rates)
