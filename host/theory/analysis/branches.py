"""Whole branches of cycles in one constant of the wheel, each from where it begins.

Forth-and-back cycles begin at a Hopf bifurcation, rotations near a merging; both are followed to
their ends, through folds.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from host.theory.analysis.bifurcations import MERGING, Followed, follow
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import FORTH_AND_BACK, ROTATION, Shooting, rolling
from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.analysis.merging import course, mergings
from host.theory.model.turning import constant_velocity, turning
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel

# The fields of Wheel by the paper's letters.
FIELDS = {"a": "a", "tau": "tau_s", "k": "k", "I": "inertia", "f": "friction"}
# Amplitude of phi (rad) of the cycle with which a branch of swinging begins.
SMALLEST = 5e-3
# Rotations are looked for so far (relative) beyond a merging.
_BEYOND = 0.1
_GRID = 240
# The direction in which only the followed constant varies.
_ALONG = np.array([0.0, 0.0, 0.0, 0.0, 1.0])


class Branch(NamedTuple):
    """A branch: its curve, and what was found on it one way and, if it began in the middle, the other way."""

    shooting: Shooting
    ways: tuple[Followed, ...]


def with_constant(wheel: Wheel, field: str, value: float) -> Wheel:
    """The wheel with another value of a field."""
    return wheel._replace(**{field: float(value)})


def hopf_values(wheel: Wheel, field: str, low: float, high: float) -> list[float]:
    """Where, along a constant, the even fixpoints' leading pair of eigenvalues crosses the imaginary axis."""

    def growth(value: float) -> float:
        return float(fixpoint(0.0, with_constant(wheel, field, value)).eigenvalues[0].real)

    values = np.geomspace(low, high, _GRID).tolist()
    known = [(value, growth(value) > 0.0) for value in values]
    return [
        float(brentq(growth, below, above, xtol=1e-14, rtol=1e-14))
        for (below, first), (above, then) in pairwise(known)
        if first != then
    ]


def swings(wheel: Wheel, field: str, low: float, high: float) -> list[Branch]:
    """The branches of forth-and-back cycles around phi = 0."""
    found = []
    for value in hopf_values(wheel, field, low, high):
        shooting = Shooting(wheel, FORTH_AND_BACK, field)
        curve = Curve(shooting, _scales(with_constant(wheel, field, value), value))
        found.append(
            Branch(
                shooting,
                (
                    follow(
                        curve,
                        _first_swing(curve, with_constant(wheel, field, value), value),
                        low,
                        high,
                    ),
                ),
            )
        )
    return found


def rotations(wheel: Wheel, field: str, low: float, high: float) -> list[Branch]:
    """The branches of rotations forward: one from each merging.

    Without any, one from the wheel itself. Raises NotDone if none rolls.
    """
    met = list(mergings(wheel, low, high, field))
    branches: list[Branch] = []
    for found in met:
        value = getattr(found.wheel, field)
        ends = [
            way.points[-1].unknowns[4]
            for branch in branches
            for way in branch.ways
            if way.end == MERGING
        ]
        if not any(abs(value / end - 1) < 1e-3 for end in ends):
            start = with_constant(
                wheel, field, value * (1 + _BEYOND if found.passes_above else 1 / (1 + _BEYOND))
            )
            branches.append(_both_ways(start, field, course(start)[1][:, -1], low, high))
    if not met:
        start = (
            wheel
            if low < getattr(wheel, field) < high
            else with_constant(wheel, field, 0.999 * high)
        )
        branches.append(_both_ways(start, field, turned(start), low, high))
    return branches


def _both_ways(wheel: Wheel, field: str, state: Array, low: float, high: float) -> Branch:
    shooting = Shooting(wheel, ROTATION, field)
    curve = Curve(shooting, _scales(wheel, getattr(wheel, field)))
    first = rotation(wheel, state, field)
    ways = (
        Point(first.unknowns, sign * curve.tangent(first.unknowns, _ALONG)) for sign in (-1.0, 1.0)
    )
    return Branch(shooting, tuple(follow(curve, way, low, high) for way in ways))


def turned(wheel: Wheel) -> Array:
    """The state (4,), at phi = 0, of a wheel that has been turned for long at the paper's speed of locomotion, or at 1/tau."""
    return turning(np.zeros(1), np.array([constant_velocity(wheel) or 1.0 / wheel.tau_s]), wheel)[
        :, 0
    ]


def rotation(wheel: Wheel, state: Array, field: str = "k") -> Point:
    """The rotation of a wheel at its own constants, sought from a state in which it rolls.

    Raises NotDone.
    """
    section, seconds = rolling(wheel, state)
    value = getattr(wheel, field)
    guess = np.array([*section[[0, 1, OMEGA]], seconds, value])
    return Curve(Shooting(wheel, ROTATION, field), _scales(wheel, value)).solve(guess, _ALONG)


def _scales(wheel: Wheel, value: float) -> Array:
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
