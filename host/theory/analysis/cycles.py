"""Cycles of the wheel by shooting, stable or not.

The equations have two symmetries. R is a quarter turn, (x1, x2, phi) -> (-x2, x1, phi + pi/2), and
M the mirror, (x2, phi, omega) -> -(x2, phi, omega). It is enough to integrate the piece of a period
that a symmetry repeats: a rotation is a fixpoint of 'integrate a quarter turn, then undo R', and a
forth-and-back cycle around phi = 0 one of 'integrate half a period, then apply M'. On the section
phi = 0 this reduced map has three multipliers.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from host.errors import NotDone, WrongUse
from host.theory.analysis.continuation import Point
from host.theory.engine.flow import FINENESS, plain_under, run, steps_for, varied
from host.theory.model.laws import law_of, rates_of
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel

# The coordinates on the section phi = 0.
SECTION = [0, 1, OMEGA]
# A wheel has settled in a rotation if its state changes less than this (relative) in a quarter
# turn, or after this many quarter turns.
_SETTLED, _QUARTERS = 1e-4, 60
# It is integrated in chunks of steps, at most this many.
_CHUNK, _MOST_CHUNKS = 100, 20_000
# The least speed of a cycle is looked for in this many steps instead of two.
_CLOSE_UP = 64


class Family(NamedTuple):
    """Cycles of one symmetry.

    Attributes:
        name: FB or LLM.
        back: the symmetry that closes the reduced map, (4, 4).
        turn: how far the wheel has turned before `back` is applied, rad.
        power: how many reduced maps make a period.
        crossings: how often the reduced map comes to a multiple of a quarter turn.
    """

    name: str
    back: Array
    turn: float
    power: float
    crossings: int = 1


FORTH_AND_BACK = Family("FB", np.diag([1.0, -1.0, -1.0, -1.0]), 0.0, 2.0)
_UNDO_QUARTER = np.eye(4)
_UNDO_QUARTER[:2, :2] = [[0.0, 1.0], [-1.0, 0.0]]
ROTATION = Family("LLM", _UNDO_QUARTER, pi / 2, 4.0)


class Shooting:
    """The cycles of a family as a problem (see host.theory.analysis.continuation).

    The unknowns are (x1, x2, omega, time, constant), (5,): the state at phi = 0, the duration of
    the reduced map in s, and the wheel's constant that is followed.
    """

    def __init__(
        self, wheel: Wheel, family: Family, along: str = "k", fineness: float = FINENESS
    ) -> None:
        """Cycles of a wheel.

        Args:
            wheel: The wheel; the followed constant is replaced.
            family: The symmetry of the cycles.
            along: The field of Wheel that is followed.
            fineness: Steps per unit of the wheel's rate (see host.theory.engine.flow).
        """
        self.wheel, self.family, self.along, self.fineness = wheel, family, along, fineness

    def with_finer_steps(self, factor: float) -> Shooting:
        """The same problem with steps that are shorter by a factor."""
        return type(self)(self.wheel, self.family, self.along, factor * self.fineness)

    def wheel_at(self, unknowns: Array) -> Wheel:
        """The wheel with its followed constant."""
        return self.wheel._replace(**{self.along: float(unknowns[4])})

    def path(self, unknowns: Array) -> Array:
        """The states of the reduced map, and their derivatives.

        Args:
            unknowns: (x1, x2, omega, time, constant), (5,).

        Returns:
            (steps + 1, 4, 6): the state, its derivatives by the initial state, and its derivative
            by the constant.

        Raises:
            NotDone: There is no cycle with these unknowns, or the wheel is too stiff.
        """
        x1, x2, omega, seconds, constant = map(float, unknowns)
        if not (
            np.isfinite(unknowns).all() and seconds > 0.0 and constant >= 0.0 and abs(omega) < 1e6
        ):
            raise NotDone(
                "the search for a cycle left the range of possible ones", "begin nearer to a cycle"
            )
        wheel = self.wheel_at(unknowns)
        try:
            count = steps_for(seconds, wheel, self.fineness)
        except WrongUse as stiff:
            raise NotDone(
                f"the search for a cycle came to where {stiff}", "begin nearer to a cycle"
            ) from stiff
        return _path(self.along, wheel, (x1, x2, 0.0, omega), seconds, count)

    def least_omega(self, point: Point) -> float:
        """The least angular velocity of a cycle, rad/s. Raises NotDone as `path` does."""
        path = self.path(point.unknowns)[:, :, 0]
        step_s = float(point.unknowns[3]) / (len(path) - 1)
        before = max(0, int(path[:, OMEGA].argmin()) - 1)
        wheel, states = self.wheel_at(point.unknowns), path[before, :, None]
        own_rates = plain_under(law_of(wheel))
        close = run(own_rates, states, tuple(wheel), 2 * step_s, _CLOSE_UP)[:, :, 0]
        slopes = [rates_of(wheel)(*state, *wheel)[OMEGA] for state in close.tolist()]
        times = np.linspace(0.0, 2 * step_s, len(close))
        course = CubicHermiteSpline(times, close[:, OMEGA], slopes)
        turns = course.derivative().roots(extrapolate=False)
        return float(min(*close[[0, -1], OMEGA], *course(turns)))

    def _rates(self, state: Array, unknowns: Array) -> Array:
        wheel = self.wheel_at(unknowns)
        try:
            return np.array(rates_of(wheel)(*state.tolist(), *wheel))
        except OverflowError as beyond:
            raise NotDone(
                "the search for a cycle came to where the neurons' exponential has no number",
                "begin nearer to a cycle",
            ) from beyond

    def __call__(self, unknowns: Array) -> tuple[Array, Array]:
        """The residual of the reduced map, and its Jacobian.

        Args:
            unknowns: (x1, x2, omega, time, constant), (5,).

        Returns:
            End minus start, (4,), and the derivatives of that by the unknowns, (4, 5).

        Raises:
            NotDone: There is no cycle with these unknowns, or the wheel is too stiff.
        """
        end = self.path(unknowns)[-1]
        start = np.array([unknowns[0], unknowns[1], 0.0, unknowns[2]])
        back = self.family.back
        residual = back @ (end[:, 0] - [0.0, 0.0, self.family.turn, 0.0]) - start
        moved = back @ self._rates(end[:, 0], unknowns)
        by_start = (back @ end[:, 1:5] - np.eye(4))[:, SECTION]
        return residual, np.column_stack([by_start, moved, back @ end[:, 5]])

    def map_derivative(self, unknowns: Array) -> Array:
        """The Jacobian (3, 3) of the reduced map on the section, at one of its fixpoints."""
        end = self.path(unknowns)[-1]
        moved = self.family.back @ self._rates(end[:, 0], unknowns)
        whole = (self.family.back @ end[:, 1:5])[:, SECTION]
        found: Array = whole[SECTION] - np.outer(moved[SECTION], whole[PHI]) / moved[PHI]
        return found

    def multipliers(self, unknowns: Array) -> NDArray[np.complex128]:
        """The three multipliers of the reduced map, the greatest modulus first, (3,).

        Raised to the family's power they are the Floquet multipliers of the whole period, without
        the trivial one.
        """
        found = np.linalg.eigvals(self.map_derivative(unknowns)).astype(complex)
        return found[np.argsort(-np.abs(found), kind="stable")]

    def product_off_by(self, unknowns: Array) -> float:
        """The error of the product of the multipliers: a check.

        Liouville's formula gives the product exactly: the divergence of the flow is constant, -2 /
        tau - f / I.
        """
        wheel = self.wheel_at(unknowns)
        exact = np.linalg.det(self.family.back) * np.exp(
            -(2.0 / wheel.tau + wheel.f / wheel.I) * unknowns[3]
        )
        return float(abs(np.linalg.det(self.map_derivative(unknowns)) - exact))


# What is asked of a cycle, its residual, its multipliers and whether it bifurcates, is asked of the
# same path.
@lru_cache(maxsize=2)
def _path(along: str, wheel: Wheel, state: tuple[float, ...], seconds: float, count: int) -> Array:
    """The states in the course of `count` steps, and their derivatives, as of `Shooting.path`."""
    states = np.hstack([np.array(state)[:, None], np.eye(4), np.zeros((4, 1))])
    own_rates = varied(Wheel._fields.index(along), law_of(wheel))
    found = run(own_rates, states, tuple(wheel), seconds, count)
    found.flags.writeable = False
    return found


def settle_in_rotation(wheel: Wheel, state: Array) -> tuple[Array, float]:
    """Let a wheel settle in a rotation.

    Args:
        wheel: The wheel.
        state: Where it starts, (4,).

    Returns:
        Its state at phi = 0, (4,), and the time it takes for a quarter turn, s.

    Raises:
        NotDone: It turns back instead.
        WrongUse: It is too stiff to be followed.
    """
    step_s = 1.0 / steps_for(1.0, wheel)
    at, now_s, crossings = np.array(state, dtype=np.float64), 0.0, 0
    section, since_s = np.full(4, np.inf), 0.0
    for _ in range(_MOST_CHUNKS):
        path = run(plain_under(law_of(wheel)), at[:, None], tuple(wheel), _CHUNK * step_s, _CHUNK)[
            :, :, 0
        ]
        quarters = np.floor(path[:, PHI] / ROTATION.turn)
        for index in np.flatnonzero(np.diff(quarters) > 0):
            rest_of_step = ROTATION.turn * quarters[index + 1] - path[index, PHI]
            part = rest_of_step / (path[index + 1, PHI] - path[index, PHI])
            there = path[index] + part * (path[index + 1] - path[index])
            before, before_s = section, since_s
            section = np.linalg.matrix_power(ROTATION.back, int(quarters[index + 1]) % 4) @ there
            section[PHI] = 0.0
            since_s = now_s + (index + part) * step_s
            crossings += 1
            same = np.abs(section - before).max() < _SETTLED * np.abs(section).max()
            if same or crossings > _QUARTERS:
                return section, since_s - before_s
        if path[:, OMEGA].min() < 0.0:
            break
        at, now_s = path[-1], now_s + _CHUNK * step_s
    raise NotDone(
        f"a wheel with k = {wheel.k:g}, tau = {wheel.tau:g} s does not go on rolling",
        "begin with another k",
    )
