"""Branches of cycles in one constant of the wheel, each from where it begins.

Forth-and-back cycles begin at a Hopf bifurcation, rotations close to a merging. Both are followed
to their ends, around folds.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from host.errors import NotDone
from host.theory.analysis.bifurcations import MERGING, Bifurcation, Followed, follow
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import FORTH_AND_BACK, ROTATION, Shooting, settle_in_rotation
from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.analysis.merging import course, mergings
from host.theory.model.turning import constant_velocity, turning
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel

# Amplitude of phi (rad) of the cycle with which a branch of forth-and-back cycles begins.
SMALLEST = 5e-3
# Rotations are looked for this far (relative) beyond a merging.
_BEYOND = 0.1
# Two mergings this close (relative) are one.
_SAME = 1e-3
_GRID = 240
# The direction in which only the followed constant varies.
_ALONG = np.array([0.0, 0.0, 0.0, 0.0, 1.0])


class Branch(NamedTuple):
    """A branch of cycles.

    Attributes:
        shooting: the problem that the cycles solve.
        curve: the curve of its solutions.
        ways: the parts that are followed; two of them, down and up, if the branch begins in the
            middle.
    """

    shooting: Shooting
    curve: Curve
    ways: tuple[Followed, ...]


def with_constant(wheel: Wheel, field: str, value: float) -> Wheel:
    """The wheel with another value of a field."""
    return wheel._replace(**{field: float(value)})


def hopf_values(wheel: Wheel, field: str, low: float, high: float) -> list[float]:
    """The Hopf bifurcations of the even fixpoints along a constant.

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        field: The field of Wheel that is followed.
        low: Least value of the constant, above 0.
        high: Greatest value of the constant.

    Returns:
        The values at which the leading eigenvalues cross the imaginary axis, ascending.

    Raises:
        WrongUse: The wheel can rest at any angle.
    """

    def growth(value: float) -> float:
        return float(fixpoint(0.0, with_constant(wheel, field, value)).eigenvalues[0].real)

    values = np.geomspace(low, high, _GRID).tolist()
    unstable = [(value, growth(value) > 0.0) for value in values]
    return [
        float(brentq(growth, below, above, xtol=1e-14, rtol=1e-14))
        for (below, first), (above, second) in pairwise(unstable)
        if first != second
    ]


def swings(wheel: Wheel, field: str, low: float, high: float) -> list[Branch]:
    """The branches of forth-and-back cycles around phi = 0, one from each Hopf bifurcation.

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        field: The field of Wheel that is followed.
        low: Least value of the constant, above 0.
        high: Greatest value of the constant.

    Returns:
        The branches, each followed one way.

    Raises:
        NotDone: The first cycle of a branch was not found.
        WrongUse: There is no Hopf bifurcation.
    """
    branches = []
    for value in hopf_values(wheel, field, low, high):
        there = with_constant(wheel, field, value)
        shooting = Shooting(wheel, FORTH_AND_BACK, field)
        curve = Curve(shooting, _scales(there, value))
        first = _first_swing(curve, there, value)
        branches.append(Branch(shooting, curve, (follow(shooting, curve, first, low, high),)))
    return branches


def rotations(wheel: Wheel, field: str, low: float, high: float) -> list[Branch]:
    """The branches of rotations forward, one from each merging.

    Without a merging, one from the wheel itself.

    Args:
        wheel: The wheel.
        field: The field of Wheel that is followed.
        low: Least value of the constant, above 0.
        high: Greatest value of the constant.

    Returns:
        The branches, each followed down and up.

    Raises:
        NotDone: The wheel does not go on rolling.
        WrongUse: There is no Hopf bifurcation, or the wheel is too stiff.
    """
    found = list(mergings(wheel, low, high, field))
    branches: list[Branch] = []
    for one in found:
        value = getattr(one.wheel, field)
        ends = [
            way.points[-1].unknowns[4]
            for branch in branches
            for way in branch.ways
            if way.end == MERGING
        ]
        if any(abs(value / end - 1) < _SAME for end in ends):
            continue
        factor = 1 + _BEYOND if one.passes_above else 1 / (1 + _BEYOND)
        start = with_constant(wheel, field, value * factor)
        branches.append(_both_ways(start, field, course(start)[1][:, -1], low, high))
    if not found:
        start = wheel
        if not low < getattr(wheel, field) < high:
            start = with_constant(wheel, field, 0.999 * high)
        branches.append(_both_ways(start, field, turning_state(start), low, high))
    return branches


def last_stable(branches: list[Branch]) -> Bifurcation | None:
    """Where stable rotations end as the constant rises.

    Args:
        branches: Of rotations, as `rotations` finds them.

    Returns:
        The bifurcation of greatest value before which the rotations are stable; None if there is
        none.
    """
    found = [
        one
        for branch in branches
        for one in branch.ways[-1].bifurcations
        if abs(branch.shooting.multipliers(branch.ways[-1].points[one.before - 1].unknowns)[0]) < 1
    ]
    return max(found, key=lambda one: float(one.point.unknowns[4]), default=None)


def _both_ways(wheel: Wheel, field: str, state: Array, low: float, high: float) -> Branch:
    shooting = Shooting(wheel, ROTATION, field)
    curve = Curve(shooting, _scales(wheel, getattr(wheel, field)))
    first = rotation(wheel, state, field).unknowns
    down, up = (Point(first, sign * curve.tangent(first, _ALONG)) for sign in (-1.0, 1.0))
    ways = follow(shooting, curve, down, low, high), follow(shooting, curve, up, low, high)
    return Branch(shooting, curve, ways)


def turning_state(wheel: Wheel) -> Array:
    """The state, (4,), at phi = 0, of a wheel that has always turned at constant velocity.

    That of the paper's formula, or 1/tau where it has none.
    """
    omega = constant_velocity(wheel) or 1.0 / wheel.tau
    return turning(np.zeros(1), np.array([omega]), wheel)[:, 0]


def rotation(wheel: Wheel, state: Array, field: str = "k") -> Point:
    """The rotation of a wheel at its own constants.

    Args:
        wheel: The wheel.
        state: A state from which it rolls, (4,).
        field: The field of Wheel in which the rotation may be followed.

    Returns:
        The rotation, with the unknowns of Shooting.

    Raises:
        NotDone: The wheel does not go on rolling.
        WrongUse: The wheel is too stiff to be followed.
    """
    section, seconds = settle_in_rotation(wheel, state)
    value = getattr(wheel, field)
    guess = np.array([*section[[0, 1, OMEGA]], seconds, value])
    return Curve(Shooting(wheel, ROTATION, field), _scales(wheel, value)).solve(guess, _ALONG)


def rotation_by_formula(wheel: Wheel) -> Point:
    """The rotation of a wheel, stable or not, from the paper's formula by Newton's method alone.

    Raises:
        NotDone: There is none near the formula.
        WrongUse: There is no Hopf bifurcation.
    """
    if wheel.k == 0.0:  # it is a scale of the search, too
        raise NotDone("without springs no wheel goes on rolling", "give k above 0")
    start = turning_state(wheel)
    guess = np.array([*start[[0, 1, OMEGA]], pi / 2 / start[OMEGA], wheel.k])
    return Curve(Shooting(wheel, ROTATION), _scales(wheel, wheel.k)).solve(guess, _ALONG)


def _scales(wheel: Wheel, value: float) -> Array:
    """The scales of the unknowns of Shooting, (5,)."""
    swinging = hopf(wheel).omega
    return np.array([1.0, 1.0, swinging, pi / swinging, value])


def _first_swing(curve: Curve, wheel: Wheel, value: float) -> Point:
    """The forth-and-back cycle of amplitude SMALLEST, near a Hopf bifurcation."""
    found, rest = hopf(wheel), fixpoint(0.0, wheel)
    vector = rest.eigenvectors[:, np.argmin(np.abs(rest.eigenvalues - 1j * found.omega))]
    vector = vector / vector[PHI] * -1j  # phi = 0 and rising
    across = np.append(vector.real[[0, 1, OMEGA]], [0.0, 0.0])
    direction = across / curve.scales
    return curve.solve(
        np.array([1.0, 0.0, 0.0, pi / found.omega, value]) + SMALLEST * across,
        direction / np.linalg.norm(direction),
    )
