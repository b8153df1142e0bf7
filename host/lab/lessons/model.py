"""The model wheel of guided exercises: the paper's equations by themselves, without a robot."""

from __future__ import annotations

from functools import cache
from math import log, pi
from typing import Any, NamedTuple

import numpy as np

from host.theory.analysis.hopf import critical_k
from host.theory.analysis.tangent import growth
from host.theory.analysis.trajectories import SAMPLE_S, trajectory
from host.theory.engine.ensemble import advance
from host.theory.model.turning import turning
from host.theory.model.wheel import PHI, Array, Wheel, resting
from robot.controller import target_position
from sim_motor.compiled import on_one_core

# How far a resting wheel is turned before it is let go (rad), and for how long it is watched (s).
PUSH_RAD, RING_S = 0.1, 40.0
CHAOTIC = Wheel(k=15.0, tau=1.0)
# How far twins are apart at first (rad), and for how long they are followed (s). Before, each wheel
# reaches its attractor (s).
APART_RAD, TWINS_S, SETTLE_S = 1e-6, 20.0, 60.0
# When the distance of twins is read (s): first it has turned into the direction in which it grows,
# and last it is still small.
EARLY_S, LATE_S = 2.0, 12.0
# Of the states, pages get every second one.
_EVERY = 2
_DIGITS = 4
# From how many wheels, and over how long (s), the exact exponent is.
_WHEELS, _MEASURE_S = 64, 200.0


class Run(NamedTuple):
    """What a page shows of one run.

    t_s: times, s. wheels: for each wheel its angle (phi_rad), speed (omega_rad_s), potentials (x1,
    x2) and targets (target1, target2) at these times. curve: what the exercise is about, at these
    times. seen: what a pupil reads off, in short.
    """

    t_s: list[float]
    wheels: list[dict[str, list[float]]]
    curve: list[float]
    seen: list[float | None]


def ring(k: float) -> Run:
    """Turn a resting wheel by PUSH_RAD, and let go.

    Returns:
        The run. Its curve is phi (rad); seen are the time in which the swings have become half as
        large as the first (s), None if they have not, and the last swing in parts of the first.
    """
    wheel = Wheel(k=k)
    start = resting(np.zeros(1))[:, 0]
    start[PHI] = PUSH_RAD
    path = trajectory(start, wheel, RING_S)
    phi = path[:, PHI]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(phi)))) + 1
    swings = np.abs(phi[turns]) / np.abs(phi[turns[0]])
    small = np.flatnonzero(swings <= 0.5)
    rings_s = None
    if len(small):
        # Between two swings the logarithm of their size falls evenly.
        place = np.interp(log(2.0), -np.log(swings[small[0] - 1 : small[0] + 1]), [-1.0, 0.0])
        times = turns[small[0]] + place * (turns[small[0]] - turns[small[0] - 1])
        rings_s = _rounded(SAMPLE_S * (times - turns[0]))
    return _shown([path], [wheel], phi, [rings_s, _rounded(swings[-1])])


def part(number: float) -> Run:
    """Let a pair of twins go, each pair from another place on the chaotic attractor.

    Returns:
        The run. Its curve is ln d, with d the distance of their states; seen are its values at
        EARLY_S and LATE_S.
    """
    start = turning(np.random.default_rng(int(number)).uniform(-pi, pi, 1), np.zeros(1), CHAOTIC)
    first = trajectory(start[:, 0], CHAOTIC, SETTLE_S)[-1]
    second = first.copy()
    second[PHI] += APART_RAD
    paths = [trajectory(state, CHAOTIC, TWINS_S) for state in (first, second)]
    curve = np.log(np.linalg.norm(paths[1] - paths[0], axis=1))
    seen = [_rounded(curve[round(time_s / SAMPLE_S)]) for time_s in (EARLY_S, LATE_S)]
    return _shown(paths, [CHAOTIC, CHAOTIC], curve, list(seen))


# By the exercise's name: what happens with the number that a pupil chooses.
RUNS = {"rest": ring, "twins": part}


def exact_k() -> float:
    """The k above which a resting model wheel swings by itself."""
    return critical_k(Wheel())


@cache
def exact_slope() -> float:
    """The largest Lyapunov exponent of the chaotic model wheel, 1/s; its error is about 0.01."""
    rng = np.random.default_rng(0)
    states = turning(rng.uniform(-pi, pi, _WHEELS), np.zeros(_WHEELS), CHAOTIC)
    columns = CHAOTIC.columns(_WHEELS)
    with on_one_core():
        settled = growth(advance(states, columns, SETTLE_S), columns, SETTLE_S)
        after = growth(settled.states, columns, _MEASURE_S, vectors=settled.vectors)
    return float(after.rates.mean())


def _shown(paths: list[Array], wheels: list[Wheel], curve: Array, seen: list[Any]) -> Run:
    times = SAMPLE_S * np.arange(0, len(curve), _EVERY)
    return Run(
        [_rounded(time_s) for time_s in times],
        [_channels(path[::_EVERY], wheel) for path, wheel in zip(paths, wheels, strict=True)],
        [_rounded(value) for value in curve[::_EVERY]],
        seen,
    )


def _channels(path: Array, wheel: Wheel) -> dict[str, list[float]]:
    columns = dict(zip(("x1", "x2", "phi_rad", "omega_rad_s"), path.T.tolist(), strict=True))
    for number in "12":
        potentials = columns[f"x{number}"]
        columns[f"target{number}"] = [target_position(x, wheel.a) for x in potentials]
    return {name: [_rounded(value) for value in values] for name, values in columns.items()}


def _rounded(value: float) -> float:
    return round(float(value), _DIGITS)
