"""The eight angles at which a wheel can rest (eq. trivial_fixpoints), and their eigenvalues.

There are no others: at rest the rods balance if g(cos phi) = g(sin phi), or if one of the two is 0;
g(u) = x_t(u) / u is even and falls with |u|. A bounded torque is 0 where the force is. A wheel with
one rod or with functions of the user rests elsewhere; there the angles are found by numbers.
"""

from __future__ import annotations

from itertools import pairwise
from math import e, pi
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.analysis.bisection import last_alike
from host.theory.model.laws import law_of, rates_of
from host.theory.model.symbolic import jacobian_at
from host.theory.model.wheel import OMEGA, Array, Wheel, resting, too_extreme

NDComplex = NDArray[np.complex128]
Kind = Literal["saddle", "stable focus", "stable node", "unstable focus", "unstable node"]

ANGLES = tuple(n * pi / 4 for n in range(8))
# In a search the turn is divided into this many intervals. The first one begins a little
# before 0: no fixpoint for reasons of symmetry is at an end of one.
_INTERVALS, _BEFORE = 1440, 1e-3
# A time course starts NEAR the fixpoint (relative), and grows or shrinks by FACTOR.
NEAR, FACTOR = 1e-6, e


class Fixpoint(NamedTuple):
    """A resting wheel.

    >>> first = fixpoints(Wheel(k=1.4))[0]
    >>> first.phi, first.kind, first.eigenvalues.round(2).tolist()
    (0.0, 'stable focus', [(-0.17+2.91j), (-0.17-2.91j), (-4+0j), (-13.67+0j)])

    Attributes:
        phi: angle, rad.
        state: (4,).
        eigenvalues: 1/s, (4,), in descending order of the real part.
        eigenvectors: one column for each eigenvalue, (4, 4).
    """

    phi: float
    state: Array
    eigenvalues: NDComplex
    eigenvectors: NDComplex

    @property
    def stable(self) -> bool:
        """Whether every small disturbance dies out."""
        return bool(self.eigenvalues.real.max() < 0.0)

    @property
    def kind(self) -> Kind:
        """A saddle, a node or a focus.

        A disturbance of a saddle grows along one direction, and shrinks along the others. One of
        an unstable node grows along two or more. Around a focus a disturbance spirals, away from an
        unstable one.
        """
        if self.stable:
            spirals = bool(np.any(self.eigenvalues.imag != 0.0))
            return "stable focus" if spirals else "stable node"
        growing = self.eigenvalues[self.eigenvalues.real >= 0.0]
        if len(growing) == 1:
            return "saddle"
        return "unstable focus" if np.any(growing.imag != 0.0) else "unstable node"


def fixpoint(phi: float, wheel: Wheel) -> Fixpoint:
    """The fixpoint at an angle at which the wheel can rest.

    Args:
        phi: The angle, rad, one of `angles`; with dry friction, where the rods' force is as large.
        wheel: The wheel; with dry friction, one that begins to roll forward there.

    Returns:
        The fixpoint.

    Raises:
        WrongUse: The rods do not pull: the wheel can rest at any angle. Or its constants are too
            large or too small.
    """
    for name in ("k", "a"):
        if getattr(wheel.checked(), name) == 0.0:
            raise WrongUse(
                f"with {name} = 0 the rods do not pull, and a wheel rests at any angle",
                f"give {name} above 0",
            )
    state = resting(np.array([phi]))[:, 0]
    matrix = jacobian_at(state.tolist(), wheel)
    if not np.isfinite(matrix).all():
        raise too_extreme(wheel)
    values, vectors = np.linalg.eig(matrix)
    order = np.argsort(-values.real, kind="stable")
    return Fixpoint(phi, state, values[order].astype(complex), vectors[:, order].astype(complex))


def angles(wheel: Wheel) -> tuple[float, ...]:
    """The angles (rad) at which a wheel can rest, ascending from 0."""
    law = law_of(wheel)
    if not (law.one_rod or law.own):
        return ANGLES
    own_rates, constants = rates_of(wheel), list(wheel)

    def push(phi: float) -> float:
        return float(own_rates(*resting(np.array([phi]))[:, 0].tolist(), *constants)[OMEGA])

    ends = np.linspace(-_BEFORE, 2 * pi - _BEFORE, _INTERVALS + 1)
    pushes = [push(phi) for phi in ends.tolist()]
    found = [
        last_alike(lambda phi: push(phi) > 0.0, *interval)
        for interval, (one, other) in zip(pairwise(ends.tolist()), pairwise(pushes), strict=True)
        if one * other < 0.0
    ]
    return tuple(0.0 if abs(phi) < NEAR else float(phi) for phi in found)


def fixpoints(wheel: Wheel) -> list[Fixpoint]:
    """All fixpoints, in the order of their angles; the paper's are eight.

    >>> [point.kind for point in fixpoints(Wheel(k=1.4))][:2]
    ['stable focus', 'saddle']

    Args:
        wheel: The wheel. Its dry friction, which would hold it at other angles, too, is left out.

    Returns:
        The fixpoints.

    Raises:
        WrongUse: The rods do not pull: the wheel can rest at any angle.
    """
    return [fixpoint(phi, wheel) for phi in angles(wheel)]


def growth_by_time_course(found: Fixpoint, wheel: Wheel) -> float:
    """The growth rate close to a fixpoint, from a time course: a check of its eigenvalues.

    Args:
        found: The fixpoint.
        wheel: The wheel that it belongs to.

    Returns:
        The real part of the leading eigenvalue, 1/s, as measured.
    """
    leading, vector = found.eigenvalues[0], found.eigenvectors[:, 0]
    left = np.linalg.inv(found.eigenvectors)[0]
    seconds = np.log(FACTOR) / abs(leading.real) if leading.real else 1.0 / abs(leading)
    own_rates, constants = rates_of(wheel), list(wheel)
    start = found.state + NEAR * (vector / np.abs(vector).max()).real
    from scipy.integrate import solve_ivp

    run = solve_ivp(
        lambda _, state: own_rates(*state, *constants),
        (0.0, seconds),
        start,
        method="LSODA",
        rtol=1e-11,
        atol=1e-15,
    )
    along = [abs(left @ (state - found.state)) for state in (start, run.y[:, -1])]
    return float(np.log(along[1] / along[0]) / seconds)
