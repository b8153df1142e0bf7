"""Stable and unstable manifolds of the saddles.

The flow has four dimensions. A saddle's unstable manifold is a curve. Its stable manifold has three
dimensions and is the boundary between basins of attraction; here it is cut with the plane of
`turning` states, whose potentials are those of a wheel that has always turned with its present
speed.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.trajectories import trajectory
from host.theory.engine.ensemble import advance
from host.theory.engine.flow import FINENESS
from host.theory.model.turning import turning
from host.theory.model.wheel import PHI, Array, Wheel

QUARTER = pi / 2
# Unstable manifolds start at this distance from the saddle, in units of its eigenvector.
NEAR = 1e-5
# After this time (s) a wheel is in its well for good, or rolls.
SETTLE_S = 60.0
# A wheel with a faster mean speed (rad/s) rolls.
ROLLING_MEAN = 0.1
# Lines of the grid of starts over a quarter turn, and over the speeds of one sign. Each piece of a
# boundary is then bisected this many times, to 1e-6 rad.
GRID, BISECTIONS = 160, 14
# Lines of a coarse grid. If it has boundaries only in this part of the speeds, the fine grid covers
# this part alone: boundaries of stiff wheels are folded there.
COARSE, LOW = 40, 0.25
# Steps per unit of a wheel's rate; they put a boundary where finer ones do, to 1e-6 rad.
LABELLING = 0.6


def unstable_manifolds(
    phi: float, wheel: Wheel, seconds: float, fineness: float = FINENESS
) -> Array:
    """Both branches of a saddle's unstable manifold.

    Args:
        phi: The saddle's angle, rad.
        wheel: The wheel.
        seconds: How long to follow a branch, s.
        fineness: Steps per unit of the wheel's rate (see host.theory.engine.flow).

    Returns:
        States, (2, samples, 4); first of the branch that leaves the saddle forward.

    Raises:
        WrongUse: The wheel can rest at any angle, or is too stiff to be followed.
    """
    saddle = fixpoint(phi, wheel)
    vector = saddle.eigenvectors[:, 0].real
    vector = vector * np.sign(vector[PHI])
    starts = [saddle.state + sign * NEAR * vector for sign in (1.0, -1.0)]
    return np.array([trajectory(start, wheel, seconds, fineness) for start in starts])


def basin_labels(phi: Array, omega: Array, wheel: Wheel) -> NDArray[np.int64]:
    """Which attractor each wheel ends on, from `turning` states.

    Args:
        phi: Angles, rad, (wheels,).
        omega: Speeds, rad/s, (wheels,).
        wheel: The constants of all wheels.

    Returns:
        The number of the well, in quarter turns from angle 0; far from all wells, 1e6 for a wheel
        that rolls forward and -1e6 for one that rolls backward, (wheels,).
    """
    parameters = wheel.columns(len(phi))
    half = advance(turning(phi, omega, wheel), parameters, SETTLE_S / 2, LABELLING)
    full = advance(half, parameters, SETTLE_S / 2, LABELLING)
    mean = (full[PHI] - half[PHI]) / (SETTLE_S / 2)
    wells = np.rint((half[PHI] + full[PHI]) / 2 / QUARTER)
    labels = np.where(np.abs(mean) > ROLLING_MEAN, 1e6 * np.sign(mean), wells)
    return np.asarray(labels.astype(np.int64))


def stable_manifolds(wheel: Wheel, fastest: float) -> Array:
    """Where the stable manifolds of the saddles cut the plane of `turning` states.

    Found as boundaries between basins. Quarter turns, and reflection of both phi and omega, give
    the rest of the plane.

    Args:
        wheel: The wheel.
        fastest: The greatest speed, rad/s.

    Returns:
        Points (phi in rad, omega in rad/s), (2, points), with phi between plus and minus an eighth
        turn and omega from 0 to `fastest`.
    """
    grid, along_phi, along_omega = _changes(wheel, fastest, COARSE)
    lines = np.flatnonzero(along_phi.any(axis=1) | np.pad(along_omega.any(axis=1), (1, 0)))
    if len(lines) and lines[-1] < LOW * COARSE:
        fastest *= float(lines[-1] + 1) / COARSE
    grid, along_phi, along_omega = _changes(wheel, fastest, GRID)
    one = np.concatenate([grid[:, :, :-1][:, along_phi], grid[:, :-1][:, along_omega]], axis=1)
    other = np.concatenate([grid[:, :, 1:][:, along_phi], grid[:, 1:][:, along_omega]], axis=1)
    own = basin_labels(one[0], one[1], wheel)
    for _ in range(BISECTIONS):
        middle = (one + other) / 2
        same = basin_labels(middle[0], middle[1], wheel) == own
        one, other = np.where(same, middle, one), np.where(same, other, middle)
    return np.asarray((one + other) / 2)


def _changes(
    wheel: Wheel, fastest: float, parts: int
) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Where labels change on a grid.

    Args:
        wheel: The wheel.
        fastest: The greatest speed, rad/s.
        parts: Of the grid, in either direction.

    Returns:
        Angles and speeds, (2, parts + 1, parts + 1), a line for each speed; whether the label
        changes from an angle to the next, (parts + 1, parts); from a speed to the next,
        (parts, parts + 1).
    """
    phis = np.linspace(-QUARTER / 2, QUARTER / 2, parts + 1)
    grid = np.array(np.meshgrid(phis, np.linspace(0.0, fastest, parts + 1)))
    labels = basin_labels(grid[0].ravel(), grid[1].ravel(), wheel).reshape(grid.shape[1:])
    return grid, labels[:, :-1] != labels[:, 1:], labels[:-1] != labels[1:]
