"""Trajectories of one wheel at equal times, and the limit cycle that a wheel settles into."""

from __future__ import annotations

from math import pi

import numpy as np

from host.theory.analysis.phases import Phase
from host.theory.engine.ensemble import advance
from host.theory.engine.flow import FINENESS, plain_under, run, steps_for
from host.theory.model.laws import law_of
from host.theory.model.turning import turning
from host.theory.model.wheel import PHI, Array, Wheel

# Time between the states of a trajectory, s.
SAMPLE_S = 0.02
# A wheel settles for SETTLE_S (s); its cycle must then repeat itself within WATCH_S (s).
SETTLE_S, WATCH_S = 300.0, 40.0
# Two states are the same if potentials, cos(phi), sin(phi) and omega as a part of its greatest
# value (of at least SLOWEST, rad/s) differ by less than this.
SAME, SLOWEST = 0.05, 0.01


def trajectory(state: Array, wheel: Wheel, seconds: float, fineness: float = FINENESS) -> Array:
    """The states that a wheel goes through.

    Args:
        state: The first state, (4,).
        wheel: The wheel.
        seconds: How long to follow it, s.
        fineness: Steps per unit of the wheel's rate (see host.theory.engine.flow).

    Returns:
        States every SAMPLE_S, (samples, 4), the first included.

    Raises:
        WrongUse: The wheel is too stiff to be followed.
    """
    samples = round(seconds / SAMPLE_S)
    if wheel.dry_friction:
        states = [np.array(state, dtype=np.float64)[:, None]]
        while len(states) <= samples:
            states.append(advance(states[-1], wheel.columns(1), SAMPLE_S, fineness))
        return np.hstack(states).T
    each = -(-steps_for(seconds, wheel, fineness) // samples)
    found: Array = run(
        plain_under(law_of(wheel)),
        np.array(state)[:, None],
        tuple(wheel),
        samples * SAMPLE_S,
        samples * each,
    )
    return found[::each, :, 0]


def limit_cycle(wheel: Wheel) -> Array | None:
    """The limit cycle that a wheel settles into, pushed off the angle 0.

    Args:
        wheel: The wheel.

    Returns:
        One period, (samples, 4), sampled every SAMPLE_S; no samples if the wheel rests; None if it
        does not repeat itself.

    Raises:
        WrongUse: The wheel is too stiff to be followed.
    """
    start = turning(np.array([0.01]), np.array([0.0]), wheel)
    states = trajectory(advance(start, wheel.columns(1), SETTLE_S)[:, 0], wheel, WATCH_S)
    x1, x2, phi, omega = states.T
    scaled = omega / np.abs(omega).max(initial=SLOWEST)
    seen = np.array([x1, x2, np.cos(phi), np.sin(phi), scaled])
    distance = np.abs(seen - seen[:, :1]).max(axis=0)
    away = np.flatnonzero(distance > SAME)
    if not len(away):
        return states[:0]
    returned = np.flatnonzero(distance[away[0] :] < SAME)
    if not len(returned):
        return None
    back = away[0] + returned[0]
    back += int(np.argmin(distance[back : back + away[0]]))
    second = seen[:, back : 2 * back]
    off = np.abs(second - seen[:, : second.shape[1]]).max()
    return states[: back + 1] if off < 2 * SAME else None


def phase_of_cycle(cycle: Array | None) -> Phase:
    """The phase of a wheel by its limit cycle, as `limit_cycle` gives it.

    Returns:
        S if it rests, FB if the cycle does not turn the wheel, LLM if it does, C without a cycle.
    """
    if cycle is None:
        return "C"
    if not len(cycle):
        return "S"
    return "LLM" if abs(cycle[-1, PHI] - cycle[0, PHI]) > pi else "FB"
