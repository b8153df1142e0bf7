"""How a wheel moves, and how fast small differences between wheels grow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isclose

import numpy as np

from host.theory.engine.ensemble import advance
from host.theory.engine.flow import FINENESS
from host.theory.model.wheel import Array, Wheel
from host.util.arguments import need_whole, wrong
from kickctl.theory._values import Result, need_ascending, need_numbers, need_smooth, need_wheel

# Time between the states of a trajectory that is given by its length, s.
_SAMPLE_S = 0.02
# This number of states takes 32 MB.
_MOST_SAMPLES = 1_000_000
# Wheels settle, and are measured for at least this long, s.
_LEAST_S, _MOST_S = 50.0, 250.0


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Result):
    """The states of a wheel at some times; all arrays are (times,).

    >>> path = trajectory(Wheel(k=8), t=[0, 5, 10])
    >>> path.omega.round(2).tolist()  # rad/s
    [0.0, 9.71, 9.77]

    Attributes:
        t: time, s.
        x1: membrane potential of the first neuron, without unit.
        x2: membrane potential of the second neuron, without unit.
        phi: angle, rad; it counts full turns.
        omega: angular velocity, rad/s.
    """

    t: Array
    x1: Array
    x2: Array
    phi: Array
    omega: Array


def trajectory(
    wheel: Wheel,
    t: float | Sequence[float] | Array = 20.0,
    start: Sequence[float] | Array = (1.0, 0.0, 0.01, 0.0),
) -> Trajectory:
    """The states that a wheel goes through. Eq. dot_x_phi.

    >>> path = trajectory(Wheel(k=8), t=10)
    >>> path
    Trajectory(t=<501: 0 to 10>, x1=<501: -0.380788 to 1>, ...)
    >>> round(float(path.omega[-1]), 4)
    9.7657

    Args:
        wheel: The wheel.
        t: How long to follow it, s, at most 20 000; or the times of the states, s, ascending from 0
            or later.
        start: The state at time 0: x1, x2, phi (rad) and omega (rad/s). By default a wheel that
            rests at 0.01 rad.

    Returns:
        The states every 0.02 s and at the end, or at the times that were given.

    Raises:
        WrongUse: An argument is none of these, or the wheel is too stiff to be followed.
    """
    wheel = need_wheel(wheel)
    times = need_ascending("t", t, "a number of seconds, or times that ascend from 0", 0.0)
    if len(times) == 1:
        if times[0] > _MOST_SAMPLES * _SAMPLE_S:
            raise wrong(
                "t",
                t,
                f"at most {_MOST_SAMPLES * _SAMPLE_S:g} s, which are {_MOST_SAMPLES:,} states, or"
                " the times of the states that you need, of two or more",
            )
        times = _samples(float(times[0]))
    state = need_numbers("start", start, "four numbers: x1, x2, phi (rad) and omega (rad/s)")
    if len(state) != 4:
        raise wrong("start", start, "four numbers: x1, x2, phi (rad) and omega (rad/s)")
    states: list[Array] = []
    now, at = 0.0, state[:, None]
    for time_s in times.tolist():
        at = advance(at, wheel.columns(1), time_s - now, FINENESS) if time_s > now else at
        now = time_s
        states.append(at[:, 0])
    return Trajectory(times, *np.array(states).T)


def _samples(seconds: float) -> Array:
    """The times, s, at which a wheel is shown that is followed for so long."""
    count = round(seconds / _SAMPLE_S)
    times: Array = np.asarray(np.arange(count + 1) * _SAMPLE_S)
    if isclose(times[-1], seconds, rel_tol=1e-12):
        return times
    return np.append(times[times < seconds], seconds)


@dataclass(frozen=True, eq=False, repr=False)
class Lyapunov(Result):
    """The four Lyapunov exponents of the attractor that most wheels are on.

    >>> found = lyapunov(Wheel(k=8), seconds=50)
    >>> found.verdict, found.shares
    ('rolling', {'rolling': 1.0})

    Attributes:
        verdict: 'at rest', 'forth-and-back', 'rolling', 'chaotic' or 'hyperchaotic'.
        exponents: in descending order, 1/s, (4,).
        errors: their standard errors, 1/s, (4,).
        dimension: the Lyapunov dimension (Kaplan and Yorke), without unit.
        by_pairs: the largest exponent from pairs of near wheels, 1/s: a check.
        by_pairs_error: its standard error, 1/s.
        omega_mean_abs: mean over the wheels of abs(mean of omega), rad/s.
        omega_std: mean standard deviation of omega, rad/s.
        shares: the share of wheels on each attractor, without unit, by its name. Where it is not
            one attractor, the start decides.
        attractors: the exponents on each attractor, 1/s, (4,), by its name.
    """

    verdict: str
    exponents: Array
    errors: Array
    dimension: float
    by_pairs: float
    by_pairs_error: float
    omega_mean_abs: float
    omega_std: float
    shares: dict[str, float]
    attractors: dict[str, Array]


def lyapunov(wheel: Wheel, seconds: float = 250.0, seed: int = 1) -> Lyapunov:
    """The Lyapunov exponents of a wheel, from 32 wheels that start anywhere. Takes seconds.

    >>> found = lyapunov(Wheel(k=1.4), seconds=50)
    >>> found.verdict, found.exponents.round(3).tolist()
    ('at rest', [-0.165, -0.165, -4.0, -13.669])

    Args:
        wheel: The wheel.
        seconds: How long to measure each wheel, s, from 50 to 250. The errors fall with the square
            root of it.
        seed: The random seed of the starts.

    Returns:
        The exponents with errors.

    Raises:
        WrongUse: An argument is none of these, or wheels never settle or are too fast.
        NotDone: No wheel stayed on its attractor.
    """
    from host.theory.studies import lyapunov_pieces as pieces
    from host.theory.studies.lyapunov_report import spectrum, verdict_of

    wheel = need_wheel(wheel)
    need_smooth(wheel, "the exponents")
    (duration_s,) = need_numbers("seconds", seconds, "a number of seconds").tolist()
    if not _LEAST_S <= duration_s <= _MOST_S:
        raise wrong("seconds", seconds, f"a number of seconds from {_LEAST_S:g} to {_MOST_S:g}")
    pieces.require_slow(wheel)
    rng = np.random.default_rng(need_whole("seed", seed, "a whole number, 0 or more"))
    blocks = pieces.spectrum_in_blocks(wheel, duration_s, rng)
    found = spectrum(
        [{"part": "point", "batch": 0, "seconds": duration_s, **block} for block in blocks], wheel
    )
    return Lyapunov(
        verdict_of(found),
        np.array(found["exponents"]),
        np.array(found["standard_errors"]),
        found["dimension"],
        found["by_pairs"],
        found["by_pairs_error"],
        found["omega_mean_abs"],
        found["omega_std"],
        {name: own["wheels"] / found["of_wheels"] for name, own in found["attractors"].items()},
        {name: np.array(own["exponents"]) for name, own in found["attractors"].items()},
    )
