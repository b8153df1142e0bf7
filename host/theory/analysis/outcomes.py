"""What wheels do in the end, from any start and after a kick, in either model.

A wheel looks the same after a quarter turn: the phase of one that rolls is its angle within a
quarter turn. In a mirror it rolls the other way: kicks of wheels that roll forward also say what
kicks of the others do, at the mirrored phase and with the other sign of the shift.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi, sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.deciding import parted, with_close
from host.theory.analysis.stability_thresholds import leading
from host.theory.engine.ensemble import Averages
from host.theory.engine.kicked import Model, Sampled, inverted, memory_s, seen_in
from host.theory.engine.sampled import at_rest
from host.theory.model.symbolic import jacobian_at
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, resting
from robot.kicks import FROZEN_MODES

Outcome = Literal["rest", "forth-and-back", "forward", "backward", "other"]
REST: Outcome = "rest"
BACK: Outcome = "forth-and-back"
FORWARD: Outcome = "forward"
BACKWARD: Outcome = "backward"
OTHER: Outcome = "other"
OUTCOMES: tuple[Outcome, ...] = (REST, BACK, FORWARD, BACKWARD, OTHER)
QUARTER = pi / 2
# How long wheels settle, and the length of each of the two windows after that, in units of their
# memory.
SETTLE, WINDOW = 60.0, 30.0
# A slower wheel (rad/s) rests.
STILL = 1e-3
# Where some wheels do not settle, all are followed for as long as they settled, and twice and four
# times as long.
ROUNDS = 3


def rest_is_stable(model: Model, wheel: Wheel) -> bool:
    """Whether a small swing around an even fixpoint dies out, without dry friction."""
    if isinstance(model, Sampled):
        return abs(leading(wheel, model.clock)) <= 1.0 + 1e-12
    return bool(np.linalg.eigvals(jacobian_at(at_rest()[:4], wheel)).real.max() <= 1e-9)


def classify(
    first: Averages, second: Averages, window_s: float, *, stable: bool, held: bool = False
) -> NDArray[np.str_]:
    """What wheels do, from two windows of time, one after the other.

    A wheel rolls if it covers the same distance in both windows, to a quarter turn, and at least
    half a turn. It is bound to a well if it covers none; there it comes to rest if rest is stable
    and its swing fades. Dry friction also holds a wheel where rest would not be stable, but such
    a swing may as well go on: only a wheel that stands still rests then. A wheel that does neither
    has not settled, or never does.

    Args:
        first: Averages over the first window, (wheels,).
        second: Averages over the second window, (wheels,).
        window_s: Length of a window, s.
        stable: Whether rest is stable without dry friction.
        held: Whether dry friction holds wheels at rest.

    Returns:
        One of OUTCOMES each, (wheels,).
    """
    before, after = (window.omega_mean * window_s / QUARTER for window in (first, second))
    bound = (np.abs(before) < 1.0) & (np.abs(after) < 1.0)
    rolls = (np.abs(after) >= 2.0) & (np.abs(after - before) < 1.0 + 1e-3 * np.abs(after))
    still = second.omega_std < STILL
    fades = still | (second.omega_std < 0.97 * first.omega_std)
    rests = (stable & fades) | (held & still)
    return np.select(
        (bound & rests, bound, rolls & (after > 0.0), rolls),
        (REST, BACK, FORWARD, BACKWARD),
        OTHER,
    )


def settle_and_classify(
    model: Model, states: Array, wheel: Wheel
) -> tuple[NDArray[np.str_], Averages]:
    """What wheels do in the end.

    Args:
        model: The continuous or the sampled model.
        states: Where they start, (rows, wheels), with the model's rows.
        wheel: The constants of all wheels.

    Returns:
        One of OUTCOMES each, (wheels,), and the averages over the last window.

    Raises:
        WrongUse: The wheels cannot be followed.
    """
    memory, parameters = memory_s(wheel), wheel.columns(states.shape[1])
    settled = model.averages(states, parameters, SETTLE * memory)
    stable = rest_is_stable(model, wheel)
    names, last = _watched(model, settled.states, wheel, stable=stable)
    if (names == OTHER).any():
        return _followed(model, names, last, wheel, stable=stable)
    return names, last


def _watched(
    model: Model, states: Array, wheel: Wheel, *, stable: bool
) -> tuple[NDArray[np.str_], Averages]:
    """What settled wheels do in two windows, and the averages over the second one."""
    window_s, parameters = WINDOW * memory_s(wheel), wheel.columns(states.shape[1])
    first = model.averages(states, parameters, window_s)
    second = model.averages(first.states, parameters, window_s)
    held = wheel.dry_friction > 0.0
    return classify(first, second, window_s, stable=stable, held=held), second


def _followed(
    model: Model, names: NDArray[np.str_], last: Averages, wheel: Wheel, *, stable: bool
) -> tuple[NDArray[np.str_], Averages]:
    """What wheels do, where some do not settle: others may seem to, for a while.

    They are followed on. One that parts from a close wheel is irregular; one that does the same
    again has settled.
    """
    memory = memory_s(wheel)
    names, (mean, std, states) = names.copy(), (values.copy() for values in last)
    left = np.arange(len(names))
    for seconds in (SETTLE * memory * 2**number for number in range(ROUNDS)):
        pairs = wheel.columns(2 * len(left))
        ended = model.averages(with_close(states[:, left]), pairs, seconds).states
        states[:, left], irregular = parted(ended)
        names[left[irregular]] = OTHER
        left = left[~irregular]
        if not len(left):
            break
        again, second = _watched(model, states[:, left], wheel, stable=stable)
        settled = (again == names[left]) & (again != OTHER)
        names[left] = again
        mean[left], std[left], states[:, left] = second
        left = left[~settled]
        if not len(left):
            break
    names[left] = OTHER
    return names, Averages(mean, std, states)


def starting_states(phi: Array, omega: Array) -> Array:
    """States of wheels with the potentials of rest.

    Args:
        phi: Angles, rad, (wheels,).
        omega: Speeds, rad/s, (wheels,).

    Returns:
        States, (4, wheels).
    """
    states = resting(phi)
    states[OMEGA] = omega
    return states


def mirror(states: Array) -> Array:
    """The same wheels reflected at phi = 0, (rows, wheels)."""
    signs = np.array([1.0, -1.0, -1.0, -1.0, -1.0])
    return np.asarray(states * signs[: len(states), None])


def free_speed(wheel: Wheel) -> float:
    """The speed (rad/s) that the springs could give a wheel, sqrt(k (1 + a/2) / I)."""
    return sqrt(wheel.k * (1 + wheel.a / 2) / wheel.I)


def rolling_states(model: Model, wheel: Wheel, phases: int) -> Array | None:
    """States of a wheel that rolls forward, at moments that are equally far apart.

    A share of these moments is therefore a share of kicks that come at any time. The moments cover
    a quarter turn of the continuous wheel. Those of the sampled wheel are successive ticks; they
    meet all phases unless a whole number of them makes a quarter turn.

    Args:
        model: The continuous or the sampled model.
        wheel: The wheel's constants.
        phases: How many moments.

    Returns:
        States sorted by phase, (rows, phases); None if the wheel does not roll.

    Raises:
        WrongUse: The wheel cannot be followed.
    """
    fast = model.states_of(starting_states(np.zeros(1), np.array([2 * free_speed(wheel)])))
    (name,), last = settle_and_classify(model, fast, wheel)
    if name not in (FORWARD, BACKWARD):
        return None
    if isinstance(model, Sampled):
        step_s = model.clock.tick_s
    else:
        step_s = QUARTER / abs(float(last.omega_mean[0])) / phases
    found = last.states if name == FORWARD else mirror(last.states)
    while (count := found.shape[1]) < phases:
        later = model.averages(found, wheel.columns(count), count * step_s).states
        found = np.hstack([found, later])[:, :phases]
    return np.asarray(found[:, np.argsort(found[PHI] % QUARTER)])


def acts_at_once(mode: str) -> bool:
    """Whether a kick of this mode changes the neurons at once: it has no length."""
    return mode in FROZEN_MODES


def outcomes_after_kicks(
    model: Model, wheel: Wheel, states: Array, mode: str, sign: int, lengths_s: list[float]
) -> NDArray[np.str_]:
    """What wheels do after a kick.

    Args:
        model: The continuous or the sampled model.
        wheel: The constants of all wheels.
        states: When the kick comes, (rows, wheels).
        mode: The kick's mode, see robot/kicks.py.
        sign: Sign of a phase kick's shift; 0 for other kicks.
        lengths_s: Lengths of the kick, s, ascending from 0. They make no difference to a frozen
            kick, which acts at once.

    Returns:
        One of OUTCOMES for each length and wheel, (lengths, wheels).

    Raises:
        WrongUse: The wheels cannot be followed.
    """
    count = states.shape[1]
    if acts_at_once(mode):
        after = [inverted(states)] * len(lengths_s)
    else:
        after = [states]
        for earlier_s, length_s in pairwise(lengths_s):
            longer_s = length_s - earlier_s
            seen = seen_in(mode, sign)
            after.append(model.kicked(after[-1], wheel.columns(count), longer_s, seen))
    outcomes, _ = settle_and_classify(model, np.hstack(after), wheel)
    return outcomes.reshape(len(lengths_s), count)
