"""The wheel as a brick drives it: neurons that step once a tick, and a force held between ticks.

Between ticks I domega/dt = F - f omega with F constant has an exact solution, so that a tick is a
map. Its state is (x1, x2, phi, omega, F): that of host.theory.model.wheel, and the force that acts
until the next one does. Arrays of states are (5, wheels), of parameters (constants, wheels), as in
host.theory.engine.ensemble. No motor sticks here; F is the torque of one that is bounded.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from functools import cache
from math import exp, expm1
from typing import Any, NamedTuple

import numpy as np

import robot.wheel
from host.errors import WrongUse
from host.theory.engine.elementary import MATHEMATICS, inlined
from host.theory.engine.ensemble import Averages
from host.theory.engine.sliding import DRY
from host.theory.model.laws import Law, law_of, torque_under, under
from host.theory.model.wheel import PHI, Array, Wheel, torque
from robot.controller import actual_positions, step_wheel
from robot.kicks import WHEELS, Kick, seen_positions
from robot.params import Params
from sim_motor.compiled import compiled, over_cores, unlocked_jit

HELD = 4
# A run of more ticks takes too long.
MOST_TICKS = 50_000_000
# What host.theory.engine.elementary can take.
_LARGEST_EXPONENT = 700.0


class Clock(NamedTuple):
    """When a brick reads and acts.

    Attributes:
        tick_s: How often it reads, s.
        latency_s: How long after a tick's beginning its decision acts, s.
        fresh: Whether the force is that of the potentials after this tick's step, as on the robot,
            else that of the tick before.
    """

    tick_s: float = 0.03
    latency_s: float = 0.0
    fresh: bool = True

    def checked(self) -> Clock:
        """The same clock. Raises WrongUse if it cannot go."""
        if not 0.0 < self.tick_s < float("inf"):
            raise WrongUse(f"a tick cannot last {self.tick_s!r} s", "give a finite number above 0")
        if not 0.0 <= self.latency_s <= self.tick_s:
            raise WrongUse(
                f"a torque cannot act {self.latency_s!r} s after the beginning of a tick of"
                f" {self.tick_s:g} s",
                "give 0 to a whole tick",
            )
        return self


class Seen(NamedTuple):
    """How a kick alters what the neurons see, as robot.kicks.seen_positions takes it.

    Nothing, if both are 0.
    """

    beta: float = 0.0
    shift_rad: float = 0.0


PLAIN = Seen()


class Coast(NamedTuple):
    """How a wheel under a constant force F coasts for some time.

    Its angle becomes phi + ahead omega + pushed F, its speed kept omega + gained F.
    """

    ahead: float
    pushed: float
    kept: float
    gained: float


def coast(seconds: float, inertia: float, friction: float) -> Coast:
    """The exact solution of I domega/dt = F - f omega with F constant, after some seconds."""
    decay = friction * seconds / inertia
    if decay > 0.1:
        reach = -expm1(-decay) / decay
        rest = (1.0 - reach) / decay
    else:
        # The series of the same, in which nothing cancels.
        rest = 0.0
        for power in range(11, 1, -1):
            rest = (1.0 - decay * rest) / power
        reach = 1.0 - decay * rest
    return Coast(
        seconds * reach, seconds**2 / inertia * rest, exp(-decay), seconds / inertia * reach
    )


def tick(
    x1: Any,
    x2: Any,
    phi: Any,
    omega: Any,
    held: Any,
    beta: float,
    shift_rad: float,
    a: Any,
    tau_s: Any,
    k: Any,
    tick_s: float,
    fresh: bool,
    bounded: Any,
    late: Any,
    then: Any,
) -> Any:
    """The state (x1, x2, phi, omega, force) a tick later.

    beta, shift_rad: of the kick that acts, 0 if none does. bounded: the greatest torque, for a law
    that bounds it. late, then: how the wheel coasts before and after the tick's force acts.
    """
    actual_1, actual_2 = actual_positions(phi)
    seen_1, seen_2 = seen_positions(phi, beta, shift_rad)
    new_1, new_2, force, _ = step_wheel(
        x1, x2, actual_1, actual_2, actual_1, actual_2, seen_1, seen_2, tick_s, a, tau_s, k, 2
    )
    if not fresh:
        force = step_wheel(
            x1, x2, actual_1, actual_2, actual_1, actual_2, seen_1, seen_2, 0.0, a, tau_s, k, 2
        )[2]
    force = torque(force, bounded)
    for (ahead, pushed, kept, gained), acting in ((late, held), (then, force)):
        phi, omega = phi + ahead * omega + pushed * acting, kept * omega + gained * acting
    return new_1, new_2, phi, omega, force


_coast: Any = compiled(coast)


@cache
def _running(law: Law) -> Any:
    """The compiled function that advances wheels by some ticks, in place.

    It gives the sums of omega^2 at the begins of these ticks, (wheels,).
    """
    own_tick: Any = under(law, tick, MATHEMATICS, inlined)

    def run(
        states: Array, parameters: Array, seen: tuple[Any, ...], clock: tuple[Any, ...], ticks: int,
        squares: Array, first: int, every: int,
    ) -> None:  # fmt: skip
        """One of `every` wheels, from the first on."""
        tick_s, latency_s, fresh = clock
        for i in range(first, states.shape[1], every):
            x1, x2, phi, omega, held = (
                states[0, i],
                states[1, i],
                states[2, i],
                states[3, i],
                states[4, i],
            )
            a, tau_s, k, inertia, friction, bounded = (
                parameters[0, i],
                parameters[1, i],
                parameters[2, i],
                parameters[3, i],
                parameters[4, i],
                parameters[6, i],
            )
            late, then = (
                _coast(latency_s, inertia, friction),
                _coast(tick_s - latency_s, inertia, friction),
            )
            square = 0.0
            for _ in range(ticks):
                square += omega * omega
                x1, x2, phi, omega, held = own_tick(
                    x1, x2, phi, omega, held, seen[0], seen[1],
                    a, tau_s, k, tick_s, fresh, bounded, late, then,
                )  # fmt: skip
            states[0, i], states[1, i], states[2, i], states[3, i], states[4, i] = (
                x1,
                x2,
                phi,
                omega,
                held,
            )
            squares[i] = square

    return unlocked_jit(run)


def ticks_in(seconds: float, clock: Clock) -> int:
    """How many ticks there are in some seconds, at least one.

    Raises:
        WrongUse: They are too many to compute.
    """
    count = round(seconds / clock.tick_s)
    if count > MOST_TICKS:
        raise WrongUse(
            f"{seconds:g} s are {count:.1e} ticks of {clock.tick_s:g} s", "choose a longer tick"
        )
    return max(1, count)


def unforced(states: Array) -> Array:
    """States of the continuous model as those of sampled wheels on which no force acts yet.

    Args:
        states: (4, wheels).

    Returns:
        (5, wheels).
    """
    return np.vstack([states, np.zeros(states.shape[1])])


def overshoots(a: Any, tau_s: Any, clock: Clock) -> Any:
    """Whether ticks are so long that Euler steps carry the potentials ever farther away.

    That is at 2 tau. Just below, they stay finite, but grow too large to compute the exponential of
    a x.
    """
    part = clock.tick_s / tau_s
    largest = np.where(part > 1.0, part / np.maximum(2.0 - part, 1e-300), 1.0)
    return a * largest > _LARGEST_EXPONENT


def _advanced(
    states: Array, parameters: Array, clock: Clock, ticks: int, seen: Seen
) -> tuple[Array, Array]:
    if parameters[DRY].any():
        raise WrongUse(
            "a wheel that steps by ticks has no dry friction", "follow it without ticks, or without"
        )
    wild = np.flatnonzero(overshoots(parameters[0], parameters[1], clock))
    if len(wild):
        raise WrongUse(
            f"potentials of tau = {parameters[1, wild[0]]:g} s run away in steps of"
            f" {clock.tick_s:g} s",
            "give a tau of more than half a tick; the robot asks for three ticks",
        )
    law, last = law_of(parameters), np.array(states, dtype=np.float64, order="C")
    if law.own:
        raise WrongUse(
            "a wheel with functions of its own does not step by ticks", "follow it without ticks"
        )
    run, squares = _running(law), np.empty(last.shape[1])
    given = last, np.ascontiguousarray(parameters), tuple(seen), tuple(clock), ticks, squares
    over_cores(lambda core, cores: run(*given, core, cores), last.shape[1])
    return last, squares


def advance(
    states: Array, parameters: Array, clock: Clock, ticks: int, seen: Seen = PLAIN
) -> Array:
    """The states of wheels, (5, wheels), some ticks later.

    Args:
        states: (5, wheels).
        parameters: (constants, wheels).
        clock: The brick's.
        ticks: How many.
        seen: What a kick does to all wheels all that time.

    Raises:
        WrongUse: The potentials of a wheel run away.
    """
    return _advanced(states, parameters, clock, ticks, seen)[0]


def averages(states: Array, parameters: Array, clock: Clock, ticks: int) -> Averages:
    """Mean and standard deviation of omega over some ticks.

    The mean is over the whole time, the deviation over the begins of ticks.

    Raises:
        WrongUse: The potentials of a wheel run away.
    """
    last, squares = _advanced(states, parameters, clock, ticks, PLAIN)
    mean = (last[PHI] - states[PHI]) / (ticks * clock.tick_s)
    return Averages(mean, np.sqrt(np.maximum(squares / ticks - mean**2, 0.0)), last)


def as_robot(
    state: Sequence[float], wheel: Wheel, clock: Clock, ticks: int, kick: Kick | None = None
) -> Array:
    """A check of the map: robot.wheel's own steps, under a kick of the left wheel.

    Args:
        state: Where the wheel begins, (5,).
        wheel: Its constants.
        clock: It must be fresh, as the robot's is.
        ticks: How many.
        kick: The kick, or None.

    Returns:
        (phi, omega) at the beginning of each tick, (2, ticks).
    """
    neurons, params = robot.wheel.Wheel(WHEELS[0]), Params()
    params.a, params.tau_s, params.k = wheel.a, wheel.tau, wheel.k
    params.rods, own_torque = int(wheel.rods), torque_under(law_of(wheel))
    neurons.x1, neurons.x2, phi, omega, acting = state
    seen = []
    for number in range(ticks):
        seen.append((phi, omega))
        held, neurons.phi = acting, phi
        neurons.step(number, clock.tick_s, params, kick)
        acting = own_torque(neurons.force, wheel.bounded)
        for seconds, force in (
            (clock.latency_s, held),
            (clock.tick_s - clock.latency_s, acting),
        ):
            ahead, pushed, kept, gained = coast(seconds, wheel.I, wheel.f)
            phi, omega = phi + ahead * omega + pushed * force, kept * omega + gained * force
    return np.array(seen).T


_COMPLEX = {name: getattr(cmath, name) for name in ("cos", "sin", "exp", "tanh")}
_COMPLEX_STEP = 1e-100


def jacobian(state: Sequence[float], wheel: Wheel, clock: Clock) -> Array:
    """The derivatives of a tick by the state before it, (5, 5), exact to rounding.

    They are computed by steps in the imaginary direction.
    """
    coasts = [
        coast(seconds, wheel.I, wheel.f)
        for seconds in (clock.latency_s, clock.tick_s - clock.latency_s)
    ]
    own_tick: Any = under(law_of(wheel), tick, _COMPLEX)
    columns = []
    for index in range(5):
        aside = [complex(value) for value in state]
        aside[index] += 1j * _COMPLEX_STEP
        last = own_tick(
            *aside, *PLAIN, *wheel[:3], clock.tick_s, clock.fresh, wheel.bounded, *coasts
        )
        columns.append(np.imag(last) / _COMPLEX_STEP)
    return np.array(columns).T


def at_rest(phi: float = 0.0) -> list[float]:
    """The fixpoint of the map at a multiple of pi/4."""
    return [*actual_positions(phi), phi, 0.0, 0.0]
