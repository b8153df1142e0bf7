"""Many wheels of the analytic model at once, over all cores and vector units.

`averages` are by Taylor's method (host.theory.engine.taylor), all else by Runge and Kutta's with
fixed steps.

The rates are those of host.theory.model.wheel, and so of robot/controller.py, compiled with sin,
cos and exp of host.theory.engine.elementary. Wheels stand side by side in memory, so that the
compiler lets one instruction do several of them.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.engine import runge_kutta, sliding, taylor
from host.theory.engine.elementary import MATHEMATICS, inlined, vectorised
from host.theory.engine.taylor import AROUND, SQUARE
from host.theory.model.laws import PAPER, Law, law_of, under
from host.theory.model.wheel import OMEGA, PHI, Array, in_words, rates
from sim_motor.compiled import over_cores

# Wheels in a block: at most as many as the fastest cache holds with all stages; but no wheel beyond
# the fewest takes many more steps than it needs, for the sake of the others.
LANES, FEWEST, ALIKE = 64, 16, 0.75
# Steps per unit of a wheel's rate (see `rate_per_s`): at FINE, averages of regular motion have nine
# digits.
FINE = 1.0
# A wheel that needs more is stiff: an explicit method is the wrong one.
MOST_STEPS = 20_000_000
# A wheel without friction gets faster and faster; for so long its steps are short enough.
_SPINNING_UP_S = 1000.0

Whole = NDArray[np.int64]


@cache
def rates_under(law: Law) -> Any:
    """The compiled function that gives the rates of all wheels of a law, (4, wheels)."""
    vectorised_rates: Any = under(law, rates, MATHEMATICS, inlined)

    def wheel_rates(states: Array, parameters: Array, out: Array) -> None:
        for i in range(states.shape[1]):
            out[0, i], out[1, i], out[2, i], out[3, i] = vectorised_rates(
                states[0, i],
                states[1, i],
                states[2, i],
                states[3, i],
                parameters[0, i],
                parameters[1, i],
                parameters[2, i],
                parameters[3, i],
                parameters[4, i],
                parameters[5, i],
                parameters[6, i],
                parameters[7, i],
                parameters[8, i],
            )

    return vectorised(wheel_rates)


# The paper's.
wheel_rates = rates_under(PAPER)


@cache
def _averaged_rates(law: Law) -> Any:
    """The compiled rates of wheels, and the square of omega's difference from a parameter beside.

    The square makes the standard deviation. With omega itself that of a rolling wheel would be the
    small difference of two large numbers.
    """
    own_rates = rates_under(law)

    def averaged_rates(states: Array, parameters: Array, out: Array) -> None:
        own_rates(states, parameters, out)
        for i in range(states.shape[1]):
            out[SQUARE, i] = (states[OMEGA, i] - parameters[AROUND, i]) ** 2

    return vectorised(averaged_rates)


def rate_per_s(parameters: Array) -> Array:
    """How fast a wheel changes, 1/s, (wheels,); its steps are chosen by that. Eq. F_tan_ana.

    It combines the paper's rates of relaxation and of turning, with factors so that wheels that
    come to rest and wheels that roll need the same number of steps per unit for the same error.
    """
    a, tau_s, k, inertia, friction = parameters[:5]
    relaxing = 1.0 / tau_s + friction / inertia + np.sqrt(k * (1.0 + a / 2) / inertia)
    slowed = friction + inertia / (2.0 * _SPINNING_UP_S)
    turning = np.sqrt(np.maximum(a * k * tau_s / (2.0 * slowed) - 1.0, 0.0)) / tau_s
    return np.asarray(np.hypot(0.9 * relaxing, 3.4 * turning))


def _edges(needed: Array) -> Whole:
    """Where blocks of wheels begin, and where the last ends.

    Args:
        needed: How many steps each wheel needs, in rising order. All wheels of a block take as many
            as its last.
    """
    # Few wheels make two blocks, so that two cores have work, if both are large enough to be fast.
    most = min(LANES, max(2 * FEWEST, -(-len(needed) // 2)))
    edges = [len(needed)]
    while edges[-1]:
        end = edges[-1]
        alike = int(np.searchsorted(needed[:end], ALIKE * needed[end - 1]))
        edges.append(max(0, end - most, min(alike, end - FEWEST)))
    return np.array(edges[::-1])


def too_stiff(seconds: float, constants: Array, steps: float) -> WrongUse:
    """The exception for a wheel with these constants that would take that many steps."""
    return WrongUse(
        f"{seconds:g} s of a wheel with {in_words(constants.tolist())} would take {steps:.1e}"
        " steps",
        "choose a shorter time, a larger tau or I, or a smaller k"
        if constants[4]
        else "give f above 0",
    )


def require_loose(parameters: Array, seconds: float) -> None:
    """Raise WrongUse if one of these wheels, (constants, wheels), is too stiff to be followed."""
    needed = np.ceil(seconds * FINE * rate_per_s(parameters))
    worst = int(np.argmax(needed))
    if not needed[worst] <= MOST_STEPS:
        raise too_stiff(seconds, parameters[:, worst], needed[worst])


def advance(
    states: Array,
    parameters: Array,
    seconds: float,
    fineness: float = FINE,
    rates_of: Any = None,
) -> Array:
    """The states of wheels after some time, by Runge and Kutta's method of order 8.

    The work is done in blocks of wheels that need about the same step, however many cores there
    are, so that the same call gives the same bits. The other wheels of its block matter to a wheel
    by the block's step, in the last digits.

    Args:
        states: (rows, wheels).
        parameters: (6 or more, wheels).
        seconds: How long, s.
        fineness: Steps per unit of `rate_per_s`.
        rates_of: A compiled function that gives the states' rates; by default that of the wheels'
            law.

    Raises:
        WrongUse: A wheel is too stiff.
    """
    own_rates = rates_under(law_of(parameters)) if rates_of is None else rates_of
    return _advanced(runge_kutta, states, parameters, seconds, fineness, own_rates)


def _advanced(
    method: Any, states: Array, parameters: Array, seconds: float, fineness: float, rates_of: Any
) -> Array:
    """The same by `runge_kutta`; with dry friction by `sliding`."""
    if parameters[sliding.DRY].any():
        method = sliding
    order, needed = _ordered(parameters, seconds, fineness)
    edges = _edges(needed)
    counts = np.maximum(1, needed[edges[1:] - 1]).astype(np.int64)
    found = np.ascontiguousarray(states[:, order], dtype=np.float64)
    ordered = parameters[:, order]
    steps = method.stepping(rates_of)

    # The longest first, so that no core waits long for the others. Each takes the next of them.
    blocks = iter(np.argsort(-counts * np.diff(edges), kind="stable").tolist())

    def advance_blocks(_core: int, _cores: int) -> None:
        for block in blocks:
            wheels = slice(edges[block], edges[block + 1])
            own, constants = found[:, wheels].copy(), ordered[:, wheels].copy()
            steps(own, constants, seconds / counts[block], counts[block])
            found[:, wheels] = own

    over_cores(advance_blocks, len(counts))
    return _back(found, order, parameters)


def _ordered(parameters: Array, seconds: float, fineness: float) -> tuple[Whole, Array]:
    """The numbers of wheels, slow ones first, and how many steps each then needs.

    Raises:
        WrongUse: One is too stiff.
    """
    rate = rate_per_s(parameters)
    order = np.argsort(rate, kind="stable")
    needed = np.ceil(seconds * fineness * rate[order])
    if len(order) and not needed[-1] <= MOST_STEPS:
        raise too_stiff(seconds, parameters[:, order[-1]], needed[-1])
    return order, needed


def _back(found: Array, order: Whole, parameters: Array) -> Array:
    """States of wheels that stand in some order as they stood before.

    Raises:
        WrongUse: One is not finite.
    """
    found = found[:, np.argsort(order)]
    if not np.isfinite(found).all():
        lost = int(np.flatnonzero(~np.isfinite(found).all(axis=0))[0])
        raise WrongUse(
            f"a wheel with {in_words(parameters[:, lost].tolist())} ran away: its numbers became"
            " too large",
            "choose a larger tau or I, a smaller k, or a start nearer to 0",
        )
    return found


def _by_series(
    states: Array, parameters: Array, seconds: float, fineness: float, law: Law
) -> Array:
    """The states (5, wheels) after some time by Taylor's method."""
    order, _ = _ordered(parameters, seconds, fineness)
    order = order[::-1]
    found = np.ascontiguousarray(states[:, order], dtype=np.float64)
    own = np.ascontiguousarray(parameters[:, order])
    accuracy = taylor.accuracy_of(fineness)
    taylor.follow(found, own, seconds, 1.0 / rate_per_s(own), law, accuracy)
    return _back(found, order, parameters)


class Averages(NamedTuple):
    """Time averages of wheels, rad/s, (wheels,), and their last states, (4, wheels)."""

    omega_mean: Array
    omega_std: Array
    states: Array


def averages(
    states: Array, parameters: Array, transient_s: float, measured_s: float, fineness: float = FINE
) -> Averages:
    """Mean and standard deviation of omega over measured_s, after transient_s.

    They are by Taylor's method; with dry friction or the user's functions, which have no series,
    by Runge and Kutta's. Twice the fineness takes another order, too, so that a finer run checks
    more than the step.

    Raises:
        WrongUse: A wheel is too stiff, or cannot be followed.
    """
    law = law_of(parameters)
    smooth = not law.own and not parameters[sliding.DRY].any()

    def after(seconds: float, start: Array) -> Array:
        given = np.vstack([start, np.zeros(start.shape[1])]), np.vstack([parameters, start[OMEGA]])
        if smooth and start.shape[1]:
            return _by_series(*given, seconds, fineness, law)
        return _advanced(runge_kutta, *given, seconds, fineness, _averaged_rates(law))

    start = np.asarray(states, dtype=np.float64)
    if start.shape != (OMEGA + 1, parameters.shape[1]) or len(parameters) != AROUND:
        shapes = f"{start.shape} and {parameters.shape}"
        raise WrongUse(
            f"states and parameters cannot be of shapes {shapes}",
            f"give (4, wheels) and ({AROUND}, wheels), as Wheel.columns does",
        )
    if not np.isfinite(start).all():
        raise WrongUse(
            "a wheel begins in a state that is not finite",
            "give finite potentials, angles and speeds",
        )
    if transient_s > 0.0:
        # What is averaged on the way is thrown away: that costs less than to compile the rates
        # without it.
        start = after(transient_s, start)[: OMEGA + 1]
    last = after(measured_s, start)
    mean = (last[PHI] - start[PHI]) / measured_s
    variance = last[SQUARE] / measured_s - (mean - start[OMEGA]) ** 2
    return Averages(mean, np.sqrt(np.maximum(variance, 0.0)), last[: OMEGA + 1])
