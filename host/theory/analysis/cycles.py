"""Cycles of the wheel by shooting, stable or not, each from a piece of its period that the wheel's symmetry repeats.

The equations look the same from a quarter turn on, R: (x1, x2, phi) -> (-x2, x1, phi + pi/2), and
in the mirror, M: (x2, phi, omega) -> -(x2, phi, omega). A rotation is a fixpoint of: run for a
quarter turn, then undo R; a forth-and-back cycle around phi = 0 one of: run for half a period, then
apply M. With the plane phi = 0 as section, such a reduced map has three multipliers.
"""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import NotDone, WrongUse
from host.theory.engine.flow import FINENESS, plain, run, steps_for, varied
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, rates

# The coordinates of the section phi = 0.
SECTION = [0, 1, OMEGA]
# A wheel has settled in a rotation when its state changes so little in a quarter turn, or after so
# many; it is given so many steps.
_SETTLED, _QUARTERS, _CHUNK, _PATIENCE = 1e-4, 60, 100, 20_000


class Family(NamedTuple):
    """Cycles of one symmetry. back.

    The symmetry that closes the reduced map, (4, 4), after the wheel has advanced by `turn` (rad).

    power: how many reduced maps make a period.
    """

    name: str
    back: Array
    turn: float
    power: float


FORTH_AND_BACK = Family("FB", np.diag([1.0, -1.0, -1.0, -1.0]), 0.0, 2.0)
_UNDO_QUARTER = np.eye(4)
_UNDO_QUARTER[:2, :2] = [[0.0, 1.0], [-1.0, 0.0]]
ROTATION = Family("LLM", _UNDO_QUARTER, pi / 2, 4.0)


class Shooting:
    """The cycles of a family as a problem (see host.theory.analysis.continuation) in the unknowns (x1, x2, omega, time, constant).

    The first three are the state at phi = 0. time: what the reduced map takes, s. constant: of the
    wheel, that of the field `along`.
    """

    def __init__(
        self, wheel: Wheel, family: Family, along: str = "k", fineness: float = FINENESS
    ) -> None:
        self.wheel, self.family, self.along, self.fineness = wheel, family, along, fineness

    def wheel_at(self, unknowns: Array) -> Wheel:
        """The wheel with its followed constant."""
        return self.wheel._replace(**{self.along: float(unknowns[4])})

    def path(self, unknowns: Array) -> Array:
        """States and their derivatives in the course of the reduced map, (steps + 1, 4, 6).

        Raises NotDone if it makes no sense there.
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
        states = np.hstack([np.array([[x1], [x2], [0.0], [omega]]), np.eye(4), np.zeros((4, 1))])
        found: Array = run(
            varied(Wheel._fields.index(self.along)), states, tuple(wheel), seconds, count
        )
        return found

    def _rates(self, state: Array, unknowns: Array) -> Array:
        x1, x2, phi, omega = state.tolist()
        return np.array(rates(x1, x2, phi, omega, *self.wheel_at(unknowns)))

    def __call__(self, unknowns: Array) -> tuple[Array, Array]:
        """By how much the reduced map misses its start, (4,), and the derivatives (4, 5) by the unknowns."""
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
        """The three of the reduced map, the greatest modulus first.

        To the family's power they are those of the whole period.
        """
        found = np.linalg.eigvals(self.map_derivative(unknowns)).astype(complex)
        return found[np.argsort(-np.abs(found), kind="stable")]

    def product_off_by(self, unknowns: Array) -> float:
        """By how much the product of these misses what the constant divergence, -2 / tau - f / I, makes it exactly: a check."""
        wheel = self.wheel_at(unknowns)
        exact = np.linalg.det(self.family.back) * np.exp(
            -(2.0 / wheel.tau_s + wheel.friction / wheel.inertia) * unknowns[3]
        )
        return float(abs(np.linalg.det(self.map_derivative(unknowns)) - exact))


def rolling(wheel: Wheel, state: Array) -> tuple[Array, float]:
    """(state (4,) at phi = 0, time of a quarter turn, s) of a wheel that began in a state and was given time to settle in a rotation.

    Raises NotDone if it turns back instead.
    """
    step_s = 1.0 / steps_for(1.0, wheel)
    at, now_s, crossings = np.array(state, dtype=np.float64), 0.0, 0
    section, since_s = np.full(4, np.inf), 0.0
    for _ in range(_PATIENCE):
        path = run(plain, at[:, None], tuple(wheel), _CHUNK * step_s, _CHUNK)[:, :, 0]
        quarters = np.floor(path[:, PHI] / ROTATION.turn)
        for index in np.flatnonzero(np.diff(quarters) > 0):
            part = (ROTATION.turn * quarters[index + 1] - path[index, PHI]) / (
                path[index + 1, PHI] - path[index, PHI]
            )
            there = path[index] + part * (path[index + 1] - path[index])
            before, before_s = section, since_s
            section, since_s = (
                np.linalg.matrix_power(ROTATION.back, int(quarters[index + 1]) % 4) @ there,
                now_s + (index + part) * step_s,
            )
            section[PHI] = 0.0
            crossings += 1
            if (
                np.abs(section - before).max() < _SETTLED * np.abs(section).max()
                or crossings > _QUARTERS
            ):
                return section, since_s - before_s
        if path[:, OMEGA].min() < 0.0:
            break
        at, now_s = path[-1], now_s + _CHUNK * step_s
    raise NotDone(
        f"a wheel with k = {wheel.k:g}, tau = {wheel.tau_s:g} s does not go on rolling",
        "begin with another k",
    )
