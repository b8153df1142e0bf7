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

    def ahead(self, point: Point, length: float, other: Point | None = None) -> Point:
        """The solution at this distance along a point's tangent.

        The guess is on the tangent, or on the cubic that the curve nearly is through this point and
        another one. Raises NotDone.
        """
        offset = length * point.tangent
        if other is not None:
            offset = self._cubic(point, other, length)
            offset = offset + (length - point.tangent @ offset) * point.tangent
        return self.solve(point.unknowns + self.scales * offset, point.tangent)

    def _cubic(self, point: Point, other: Point, length: float) -> Array:
        """How far the cubic through two points and their tangents is from the first, scaled."""
        chord = (other.unknowns - point.unknowns) / self.scales
        whole = float(np.linalg.norm(chord)) * (1.0 if chord @ point.tangent > 0.0 else -1.0)
        part = length / whole
        slopes = (1 - part) * point.tangent - part * other.tangent
        bent: Array = part**2 * (3 - 2 * part) * chord + whole * part * (1 - part) * slopes
        return bent

    def follow(
        self, first: Point, shortest: float, longest: float, *, cubic: bool = False
    ) -> Iterator[Point]:
        """Follow the curve with steps that adapt to how it turns.

        Args:
            first: Where to start, and in which direction.
            shortest: Shortest step, in scaled unknowns.
            longest: Longest step, in scaled unknowns.
            cubic: Whether the next point is guessed on a cubic through the last two, not on the
                tangent. Where the curve goes close to another, steps are then much longer.

        Yields:
            Its points, first the first.

        Raises:
            NotDone: The curve is lost.
        """
        yield first
        point, length, before = first, 10 * shortest, None
        while True:
            try:
                following = self.ahead(point, length, before)
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
            yield following
            before, point = point if cubic else None, following
            length = min(longest, length * (_GROWTH if turn < _MOST_TURN / 3 else 1.0))

    def between(
        self, point: Point, following: Point, vanishing: Callable[[Point], float]
    ) -> Point | None:
        """The point of the curve between two that `follow` gave where a function vanishes.

        None if the function has the same sign at both. Raises NotDone if the curve is lost.
        """
        if vanishing(point) * vanishing(following) > 0.0:
            return None
        return self.locate(point, following, vanishing)

    def locate(self, point: Point, following: Point, vanishing: Callable[[Point], float]) -> Point:
        """The point of the curve where a function vanishes.

        Args:
            point: A point before it.
            following: The next one that `follow` gave.
            vanishing: The function, with different signs at both.

        Returns:
            The point.

        Raises:
            NotDone: The function has the same sign at both.
        """
        ahead = float(point.tangent @ ((following.unknowns - point.unknowns) / self.scales))

        def at(distance: float) -> Point:
            return self.ahead(point, distance, following) if distance else point

        if vanishing(at(0.0)) * vanishing(at(ahead)) > 0.0:
            raise NotDone(
                "a function does not change its sign between two points", "take them further apart"
            )
        return at(
            float(brentq(lambda part: vanishing(at(part)), 0.0, ahead, xtol=1e-13, rtol=1e-13))
        )
