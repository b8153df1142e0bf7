"""What wheels do over two parameters, over where they start, and over kicks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, isqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.analysis import outcomes
from host.theory.analysis.phases import phases
from host.theory.analysis.sure_kicks import sure_ranges
from host.theory.engine.ensemble import averages
from host.theory.engine.kicked import KICKS, Continuous
from host.theory.model.laws import require_friction
from host.theory.model.turning import rolling_states
from host.theory.model.wheel import Array, Wheel, resting
from host.theory.studies import basins as study
from host.theory.studies.basins_rows import CONTINUOUS, LENGTHS_S
from host.theory.studies.phase_diagram import PUSH
from host.util.arguments import need_whole, wrong
from kickctl.theory._values import Result, need_ascending, need_smooth, need_symmetric, need_wheel

# What memory holds, and minutes are enough for.
_MOST_POINTS, _MOST_PHASES = 1_000_000, 10_000
_LENGTHS = "lengths (s) that begin with 0 and ascend"

Names = NDArray[np.str_]


@dataclass(frozen=True, eq=False, repr=False)
class PhaseDiagram(Result):
    """What wheels do over (k, tau). Rows belong to tau, columns to k.

    >>> found = phase_diagram(Wheel(), k=[1, 1.7, 8], tau=[0.1, 0.25], seconds=40)
    >>> found.phase
    array([['S', 'S', 'LLM'],
           ['S', 'FB', 'LLM']], dtype='<U3')

    Attributes:
        k: spring constants, without unit, (ks,).
        tau: time constants, s, (taus,).
        omega_mean: mean of omega, rad/s, (taus, ks).
        omega_std: standard deviation of omega, rad/s, (taus, ks).
        phase: 'S' the wheel rests, 'FB' it rolls forth and back, 'LLM' it rolls one way, 'C' it is
            chaotic, 'undecided' it has not settled after 6000 s more, or is so fast that one
            round of these would take more than 100 000 steps of integration, (taus, ks).
    """

    k: Array
    tau: Array
    omega_mean: Array
    omega_std: Array
    phase: Names


def phase_diagram(
    wheel: Wheel,
    k: Sequence[float] | Array,
    tau: Sequence[float] | Array,
    start: Literal["rest", "roll"] = "rest",
    seconds: float = 100.0,
) -> PhaseDiagram:
    """Mean and standard deviation of omega over (k, tau). 40 000 points take a minute.

    >>> found = phase_diagram(Wheel(), k=[1, 8], tau=[0.25], seconds=40)
    >>> found.phase.tolist()
    [['S', 'LLM']]

    Args:
        wheel: The wheel; its own k and tau do not matter.
        k: Spring constants, without unit, ascending.
        tau: Time constants, s, ascending.
        start: 'rest', from close to rest, or 'roll', from rolling.
        seconds: How long to wait before measuring, and how long to measure, s.

    Returns:
        The averages and the phase of each wheel.

    Raises:
        WrongUse: An argument is none of these, or wheels never settle, or are too stiff to be
            followed.
    """
    wheel = need_wheel(wheel)
    ks = need_ascending("k", k, "numbers that ascend from 0", 0.0)
    taus = need_ascending("tau", tau, "times (s) that ascend from above 0", 1e-6)
    if start not in ("rest", "roll"):
        raise wrong("start", start, "'rest' or 'roll'")
    (measured_s,) = need_ascending("seconds", seconds, "a number of seconds, 1 or more", 1.0)
    if len(ks) * len(taus) > _MOST_POINTS:
        raise WrongUse(
            f"{len(ks):,} values of k and {len(taus):,} of tau are too many points",
            f"give at most {_MOST_POINTS:,} points at once",
        )
    require_friction(wheel)
    parameters = wheel.columns(
        len(ks) * len(taus), tau=np.repeat(taus, len(ks)), k=np.tile(ks, len(taus))
    )
    begin = (
        rolling_states(parameters)
        if start == "roll"
        else resting(np.full(parameters.shape[1], PUSH))
    )
    found = averages(begin, parameters, measured_s, measured_s)
    shape = len(taus), len(ks)
    mean, std = found.omega_mean.reshape(shape), found.omega_std.reshape(shape)
    names = np.array(phases(found, parameters)).reshape(shape)
    return PhaseDiagram(ks, taus, mean, std, names)


@dataclass(frozen=True, eq=False, repr=False)
class Basins(Result):
    """Where wheels end that start in the slice x1 = cos phi, x2 = sin phi.

    >>> found = basins(Wheel(k=1.4), points=16)
    >>> found.outcome.shape, found.shares
    ((16, 16), {'rest': 1.0})

    Attributes:
        phi: angles at the start, rad, (phis,).
        omega: angular velocities at the start, rad/s, (omegas,).
        outcome: 'rest', 'forth-and-back', 'forward', 'backward' or 'other', (omegas, phis).
        quarters: the well that the wheel ends in, in quarter turns from phi = 0, full turns
            included; nan if it ends in none, (omegas, phis).
        shares: the share of starts with each outcome, without unit, by its name.
    """

    phi: Array
    omega: Array
    outcome: Names
    quarters: Array
    shares: dict[str, float]


def basins(wheel: Wheel, points: int = 120) -> Basins:
    """Basins of attraction over the angle and the speed at the start. 14 400 starts take seconds.

    >>> found = basins(Wheel(k=8), points=16)
    >>> found.shares
    {'backward': 0.5, 'forward': 0.5}

    Args:
        wheel: The wheel.
        points: How many angles from -pi to pi, and how many speeds from minus to plus twice the
            speed that the springs can give; 16 to 1000.

    Returns:
        What each wheel does in the end.

    Raises:
        WrongUse: An argument is none of these, or wheels are too stiff or settle too slowly.
    """
    count = _need_count("points", points, 16, isqrt(_MOST_POINTS))
    wheel = need_wheel(wheel)
    study.require_settling(wheel)
    phi, omega = study.angles(count), study.omegas(wheel, count)
    grid = (axis.ravel() for axis in np.meshgrid(phi, omega))
    starts = study.simulate_starts(Continuous(), wheel, *grid)
    names = np.array([row["outcome"] for row in starts]).reshape(count, count)
    wells = np.array([row["quarters"] for row in starts], dtype=np.float64).reshape(count, count)
    values, counts = np.unique(names, return_counts=True)
    shares = dict(zip(values.tolist(), (counts / names.size).tolist(), strict=True))
    return Basins(phi, omega, names, wells, shares)


@dataclass(frozen=True, eq=False, repr=False)
class Kicks(Result):
    """What kicks of a wheel that rolls forward lead to.

    >>> found = kicks(Wheel(k=8), "membrane", phases=12)
    >>> found.mode, found.reversed.tolist()  # the share of phases
    ('membrane', [1.0])

    Attributes:
        mode: 'membrane', 'position' or 'phase'.
        sign: sign of a phase kick's shift of 3 pi / 4; 0 for other kicks.
        length: lengths of the kick, s, (lengths,).
        phase: angles at which it comes, within a quarter turn, degrees, (phases,).
        outcome: 'rest', 'forth-and-back', 'forward', 'backward' or 'other', (lengths, phases).
        reversed: the share of phases at which the wheel ends backward, without unit, (lengths,).
        sure: the ranges of lengths, s, (ranges, 2), that reverse the wheel at every phase.
    """

    mode: str
    sign: int
    length: Array
    phase: Array
    outcome: Names
    reversed: Array
    sure: Array


def kicks(
    wheel: Wheel,
    mode: str = "phase",
    sign: int | None = None,
    length: Sequence[float] | Array | None = None,
    phases: int = 60,
) -> Kicks:
    """Which kicks reverse a wheel that rolls, by length and phase. Takes seconds.

    >>> found = kicks(Wheel(k=8), "phase", length=[0.0, 0.1, 0.15], phases=12)
    >>> found.reversed
    array([0.        , 0.58333333, 1.        ])
    >>> found.sure.round(4).tolist()
    [[0.1078, 0.15]]

    Args:
        wheel: The wheel.
        mode: 'membrane', which inverts the potentials at once; 'position' or 'phase', which change
            what the neurons see for a while.
        sign: Sign of a phase kick's shift, 1 or -1; by default 1.
        length: Lengths of the kick, s; they begin with 0 and ascend. By default every 5 ms up to
            0.4 s.
        phases: At how many moments of a quarter turn it comes, 4 to 10 000.

    Returns:
        The outcomes.

    Raises:
        WrongUse: An argument is none of these, or the wheel does not roll.
    """
    wheel = need_wheel(wheel)
    need_smooth(wheel, "kicks")
    need_symmetric(wheel, "kicks")
    modes = {own for own, _ in KICKS}
    if mode not in modes:
        raise wrong("mode", mode, "one of " + ", ".join(sorted(modes)))
    own_sign = sign if sign is not None else 1 if mode == "phase" else 0
    if (mode, own_sign) not in KICKS:
        raise wrong("sign", sign, "1 or -1 for a phase kick, and nothing for other kicks")
    count = _need_count("phases", phases, 4, _MOST_PHASES)
    lengths = [0.0]
    if not outcomes.acts_at_once(mode):
        given = LENGTHS_S[CONTINUOUS] if length is None else length
        lengths = need_ascending("length", given, _LENGTHS, 0.0).tolist()
        if lengths[0]:
            raise wrong("length", length, _LENGTHS)
    study.require_settling(wheel)
    model = Continuous()
    states = outcomes.rolling_states(model, wheel, count)
    if states is None:
        raise WrongUse(
            f"a wheel with k = {wheel.k:g} and tau = {wheel.tau:g} s does not roll",
            "give a larger k",
        )
    found = outcomes.outcomes_after_kicks(model, wheel, states, mode, own_sign, lengths)
    sure: list[tuple[float, float]] = []
    if not outcomes.acts_at_once(mode):
        sure = sure_ranges(model, wheel, mode, own_sign, lengths, count)
    return Kicks(
        mode,
        own_sign,
        np.array(lengths),
        np.array([degrees(phi) for phi in (states[2] % outcomes.QUARTER).tolist()]),
        found,
        (found == outcomes.BACKWARD).mean(axis=1),
        np.array(sure).reshape(-1, 2),
    )


def _need_count(name: str, value: object, least: int, most: int) -> int:
    wanted = f"a whole number from {least} to {most}"
    count = need_whole(name, value, wanted)
    if not least <= count <= most:
        raise wrong(name, value, wanted)
    return count
