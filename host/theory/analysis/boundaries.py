"""The boundary of a region of the plane of two constants, followed by bisection across it.

What is asked of a wheel is a question with the answers yes and no, so the boundary may be that of
anything, and is found to the last digits. Points are (ln x, ln y): lines that are powers of each
other are straight there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from host.errors import NotDone
from host.theory.analysis.bisection import last_alike
from host.theory.model.wheel import Array

# The boundary is first looked for this far aside of the predicted point, relative to the step, and
# at most as far as the step is long.
_ASIDE = 1 / 64
# At first its direction is not known, and it is looked for as many steps aside.
_FIRST_REACH = 64.0
# A boundary that turns too fast for steps of this part of the longest is lost.
_SHORTEST = 1e-3


class Boundary(NamedTuple):
    """A boundary.

    Attributes:
        holds: whether a point, (2,), is on the one side of it.
        within: how far from it a found point may be.
    """

    holds: Callable[[Array], bool]
    within: float = 1e-14

    def crossings(self, ends: tuple[Array, Array], count: int) -> Iterator[Array]:
        """Its points on the straight line between two others, (2,) each.

        Args:
            ends: Where the line begins and ends.
            count: How many points are tried; two crossings between neighbours are not seen.
        """
        begin, along = ends[0], ends[1] - ends[0]

        def holds(part: float) -> bool:
            return self.holds(begin + part * along)

        for (part, one), (next_part, other) in pairwise(
            (part, holds(part)) for part in np.linspace(0.0, 1.0, count).tolist()
        ):
            if one != other:
                within = self.within / float(np.linalg.norm(along))
                yield begin + last_alike(holds, part, next_part, within) * along

    def beside(self, point: Array, direction: Array, least: float, most: float) -> Array:
        """Its point across a direction.

        Args:
            point: Close to the boundary, (2,).
            direction: How the boundary runs there, (2,), of length 1.
            least: How far to look aside at first.
            most: How far to look aside at most.

        Returns:
            The point, (2,).

        Raises:
            NotDone: There is none.
        """
        across = np.array([-direction[1], direction[0]])

        def holds(aside: float) -> bool:
            return self.holds(point + aside * across)

        while least <= most:
            if holds(-least) != holds(least):
                return np.asarray(point + last_alike(holds, -least, least, self.within) * across)
            least *= 4
        raise NotDone("a boundary is not where it should be", "try shorter steps")

    def follow(self, first: Array, direction: Array, longest: float) -> Iterator[Array]:
        """Follow it from one of its points.

        Args:
            first: The point, (2,).
            direction: In which direction to go at first, (2,).
            longest: The longest step.

        Yields:
            Its points, first the first.

        Raises:
            NotDone: The boundary is lost.
        """
        yield first
        point, step, reach = first, _SHORTEST * longest, _FIRST_REACH
        while True:
            direction = direction / np.linalg.norm(direction)
            try:
                aim = point + step * direction
                following = self.beside(aim, direction, _ASIDE * step, reach * step)
            except NotDone:
                if step <= _SHORTEST * longest:
                    raise
                step = max(step / 4, _SHORTEST * longest)
                continue
            yield following
            direction, point, reach = following - point, following, 1.0
            step = min(longest, 4 * step)

    def where(self, point: Array, following: Array, vanishing: Callable[[Array], float]) -> Array:
        """Its point between two neighbours of `follow` where a function vanishes.

        Args:
            point: A point of it, (2,).
            following: Another, (2,).
            vanishing: The function, with different signs at both.

        Returns:
            The point, (2,). Raises NotDone if the boundary is lost.
        """
        from scipy.optimize import brentq

        chord = following - point
        length = float(np.linalg.norm(chord))

        def at(part: float) -> Array:
            aim = point + part * chord
            return self.beside(aim, chord / length, _ASIDE * length, length)

        ends = {0.0: point, 1.0: following}
        part = brentq(
            lambda part: vanishing(ends[part] if part in ends else at(part)),
            0.0,
            1.0,
            xtol=1e-12,
            rtol=1e-12,
        )
        return at(float(part))
