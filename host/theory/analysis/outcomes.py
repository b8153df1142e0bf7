"""What becomes of wheels: from a start, and from a kick at any phase of rolling.

Of the continuous model and of the sampled one.

A quarter turn changes nothing for a wheel, so that the phase of one that rolls is its angle within
a quarter turn. In a mirror it rolls the other way, so that kicks of wheels that roll forward tell
those of the others: at the mirrored phase, with the other sign of a shift.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.stability_thresholds import leading
from host.theory.engine.ensemble import Averages
from host.theory.engine.kicked import Model, Sampled, inverted, memory_s, seen_in
from host.theory.engine.sampled import at_rest
from host.theory.model.symbolic import jacobian_at
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, resting
from robot.kicks import FROZEN_MODES

REST, BACK, FORWARD, BACKWARD, OTHER = OUTCOMES = (
    "rest",
    "forth-and-back",
    "forward",
    "backward",
    "other",
)
QUARTER = pi / 2
# How long wheels settle, and are then watched twice, in their memories; slower (rad/s) than the
# last is rest.
SETTLED, WATCHED, STILL = 60.0, 30.0, 1e-3


def rest_is_stable(model: Model, wheel: Wheel) -> bool:
    """Whether a small swing around an even fixpoint fades."""
    if isinstance(model, Sampled):
        return abs(leading(wheel, model.clock)) <= 1.0 + 1e-12
    return bool(np.linalg.eigvals(jacobian_at(at_rest()[:4], wheel)).real.max() <= 1e-9)


def outcomes(first: Averages, then: Averages, window_s: float, stable: bool) -> NDArray[np.str_]:
    """What wheels do, from two windows one after the other: one of OUTCOMES, (wheels,). stable.

    Whether they can rest.

    A wheel rolls if it covers the same distance in both, to a quarter turn, and half a turn at
    least; it is bound to a well if it covers none, and comes to rest there if it can and its swing
    fades. What does neither has not settled, or never does.
    """
    before, after = (window.omega_mean * window_s / QUARTER for window in (first, then))
    bound = (np.abs(before) < 1.0) & (np.abs(after) < 1.0)
    rolls = (np.abs(after) >= 2.0) & (np.abs(after - before) < 1.0 + 1e-3 * np.abs(after))
    still = bound & stable & ((then.omega_std < STILL) | (then.omega_std < 0.97 * first.omega_std))
    return np.select(
        (still, bound, rolls & (after > 0.0), rolls), (REST, BACK, FORWARD, BACKWARD), OTHER
    )


def watched(model: Model, states: Array, wheel: Wheel) -> tuple[NDArray[np.str_], Averages]:
    """What becomes of wheels from these states.

    Their outcomes, and the averages of the last window.
    """
    memory, parameters = memory_s(wheel), wheel.columns(states.shape[1])
    settled = model.averages(states, parameters, SETTLED * memory)
    first = model.averages(settled.states, parameters, WATCHED * memory)
    then = model.averages(first.states, parameters, WATCHED * memory)
    return outcomes(first, then, WATCHED * memory, rest_is_stable(model, wheel)), then


def started(phi: Array, omega: Array) -> Array:
    """States of wheels at these angles and speeds, with the potentials of wheels that rest there, (4, wheels)."""
    states = resting(phi)
    states[OMEGA] = omega
    return states


def mirrored(states: Array) -> Array:
    """The same wheels in a mirror along phi = 0."""
    signs = np.array([1.0, -1.0, -1.0, -1.0, -1.0])
    return np.asarray(states * signs[: len(states), None])


def free_speed(wheel: Wheel) -> float:
    """The speed (rad/s) that the rods' springs could give a wheel: the root of k (1 + a/2) / I."""
    return sqrt(wheel.k * (1 + wheel.a / 2) / wheel.inertia)


def rolling(model: Model, wheel: Wheel, phases: int) -> Array | None:
    """States of a wheel that rolls forward, at so many moments, (rows, phases), sorted by phase.

    None if none rolls.

    The moments are equally far apart, so that a share of them is a share of kicks that come at any
    time: within a quarter turn of the continuous wheel; at successive ticks of the sampled one,
    which meet all phases unless a whole number of them makes a quarter turn.
    """
    (name,), then = watched(
        model, model.begun(started(np.zeros(1), np.array([2 * free_speed(wheel)]))), wheel
    )
    if name not in (FORWARD, BACKWARD):
        return None
    step_s = (
        model.clock.tick_s
        if isinstance(model, Sampled)
        else QUARTER / abs(float(then.omega_mean[0])) / phases
    )
    states = [then.states if name == FORWARD else mirrored(then.states)]
    while len(states) < phases:
        states.append(model.averages(states[-1], wheel.columns(1), step_s).states)
    found = np.hstack(states)
    return np.asarray(found[:, np.argsort(found[PHI] % QUARTER)])


def after_kicks(
    model: Model, wheel: Wheel, begun: Array, mode: str, sign: int, lengths_s: list[float]
) -> NDArray[np.str_]:
    """What becomes of wheels, (rows, wheels), after a kick of each of these lengths, which rise from 0: (lengths, wheels).

    A frozen kick has no length: it is the same for each.
    """
    if mode in FROZEN_MODES:
        ended = [inverted(begun)] * len(lengths_s)
    else:
        ended = [begun]
        for earlier_s, length_s in pairwise(lengths_s):
            ended.append(
                model.kicked(
                    ended[-1],
                    wheel.columns(begun.shape[1]),
                    length_s - earlier_s,
                    seen_in(mode, sign),
                )
            )
    return watched(model, np.hstack(ended), wheel)[0].reshape(len(lengths_s), begun.shape[1])
