"""Curves of solutions followed around folds.

Pseudo-arclength continuation (Keller 1977; Kuznetsov, Elements of Applied Bifurcation Theory,
section 10.2), and the points of a curve where a function vanishes. A problem is a function of n + 1
unknowns, the last of them the followed constant; it gives n residuals and their Jacobian,
(n, n + 1).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from host.errors import NotDone
from host.theory.model.wheel import Array

Problem = Callable[[Array], tuple[Array, Array]]

# Newton's method converges quadratically: the step after one of this size (relative) is rounding.
_CLOSE, _MOST_ITERATIONS = 1e-11, 12
# How far (rad) a curve may turn within a step.
_MOST_TURN = 0.15
_GROWTH = 1.4


class Point(NamedTuple):
    """A solution.

    Attributes:
        unknowns: (n + 1,).
        tangent: the direction in which the curve goes on, (n + 1,), of length 1 in scaled unknowns.
    """

    unknowns: Array
    tangent: Array


class Curve(NamedTuple):
    """A curve of solutions.

    Attributes:
        problem: the residuals and their Jacobian.
        scales: of the unknowns, (n + 1,); lengths are measured in them.
    """

    problem: Problem
    scales: Array

    def _jacobian(self, unknowns: Array) -> tuple[Array, Array]:
        residual, jacobian = self.problem(unknowns)
        return residual, jacobian * self.scales

    def solve(self, guess: Array, direction: Array) -> Point:
        """The solution on a plane, by Newton's method.

        Args:
            guess: A point of the plane, (n + 1,).
            direction: The normal of the plane, in scaled unknowns, (n + 1,).

        Returns:
            The solution.

        Raises:
            NotDone: Newton's method does not converge.
        """
        unknowns = guess.copy()
        for _ in range(_MOST_ITERATIONS):
            residual, jacobian = self._jacobian(unknowns)
            off = direction @ ((unknowns - guess) / self.scales)
            matrix = np.vstack([jacobian, direction])
            if not np.isfinite(matrix).all():
                break
            try:
                change = np.linalg.solve(matrix, -np.append(residual, off))
            except np.linalg.LinAlgError:
                break
            unknowns = unknowns + self.scales * change
            if np.abs(change).max() < _CLOSE:
                return Point(unknowns, self.tangent(unknowns, direction))
        raise NotDone("no solution was found near a guess", "try shorter steps")

    def tangent(self, unknowns: Array, like: Array) -> Array:
        """The direction of the curve at a solution, (n + 1,).

        The curve has two; this one has a positive product with `like`, (n + 1,).
        """
        _, jacobian = self._jacobian(unknowns)
        along: Array = np.linalg.svd(jacobian)[2][-1]
        return along if along @ like >= 0.0 else -along

    def ahead(self, point: Point, length: float) -> Point:
        """The solution at this distance along a point's tangent. Raises NotDone."""
        return self.solve(point.unknowns + length * self.scales * point.tangent, point.tangent)

    def follow(
        self, first: Point, shortest: float, longest: float
    ) -> Iterator[tuple[float, Point]]:
        """Follow the curve with steps that adapt to how it turns.

        Args:
            first: Where to start, and in which direction.
            shortest: Shortest step, in scaled unknowns.
            longest: Longest step, in scaled unknowns.

        Yields:
            The length of the step and the point after it; first a length of 0 and the first point.

        Raises:
            NotDone: The curve is lost.
        """
        yield 0.0, first
        point, length = first, 10 * shortest
        while True:
            try:
                following = self.ahead(point, length)
                turn = float(np.arccos(min(1.0, float(following.tangent @ point.tangent))))
                aside = following.unknowns - point.unknowns - length * self.scales * point.tangent
                near = (
                    turn < _MOST_TURN and np.linalg.norm(aside / self.scales) < _MOST_TURN * length
                )
            except NotDone:
                near = False
            if not near:
                length /= 2
                if length < shortest:
                    raise NotDone(
                        "the curve could not be followed further",
                        "its solutions change too fast there, or cease to exist",
                    )
                continue
            yield length, following
            point = following
            length = min(longest, length * (_GROWTH if turn < _MOST_TURN / 3 else 1.0))

    def between(
        self, point: Point, following: Point, vanishing: Callable[[Point], float]
    ) -> Point | None:
        """The point of the curve between two that `follow` gave where a function vanishes.

        None if the function has the same sign at both. Raises NotDone if the curve is lost.
        """
        if vanishing(point) * vanishing(following) > 0.0:
            return None
        ahead = (following.unknowns - point.unknowns) / self.scales
        return self.locate(point, float(point.tangent @ ahead), vanishing)

    def locate(self, point: Point, length: float, vanishing: Callable[[Point], float]) -> Point:
        """The point of the curve where a function vanishes.

        Args:
            point: A point before it.
            length: The distance of a point behind it.
            vanishing: The function, with different signs at both.

        Returns:
            The point.

        Raises:
            NotDone: The function has the same sign at both.
        """

        def at(distance: float) -> float:
            return vanishing(self.ahead(point, distance) if distance else point)

        if at(0.0) * at(length) > 0.0:
            raise NotDone(
                "a function does not change its sign between two points", "take them further apart"
            )
        return self.ahead(point, float(brentq(at, 0.0, length, xtol=1e-13, rtol=1e-13)))
