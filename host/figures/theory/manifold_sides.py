"""On which side of a saddle each point of its stable manifold lies, for the figure `portrait`."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from host.theory.model.wheel import Array

_QUARTER = pi / 2
# Distances are in units of this many parts of a quarter turn, and of the greatest speed.
_PARTS = 160
# Points that are as near to the saddle belong to the branch of their own side, in these units.
_NEAR = 4.0
# The way from point to point is the sum of this power of the distances.
_POWER = 6


def sides(points: Array, fastest: float) -> NDArray[np.bool_]:
    """Which points belong to the branch that comes to the saddle with positive speed.

    Both branches are followed from the saddle, from point to point; a leap to another arm of a
    spiral counts as a far longer way than the steps along an arm.

    Args:
        points: (phi in rad, speed), (points, 2), also those with negative speed.
        fastest: The greatest speed, in the unit of the speeds.

    Returns:
        True for points of this branch, False for those of the other one, (points,).
    """
    across = points[:, 0] / _QUARTER * _PARTS
    speed = points[:, 1] / fastest * _PARTS
    # The saddle is an eighth turn from the angle 0; its stable direction has a negative slope.
    from_saddle = across % _PARTS - _PARTS / 2
    forward = speed > from_saddle
    distance = np.full(len(points), np.inf)
    distance[np.hypot(from_saddle, speed) < _NEAR] = 0.0
    left = np.ones(len(points), dtype=bool)
    for _ in range(len(points)):
        nearest = int(np.argmin(np.where(left, distance, np.inf)))
        left[nearest] = False
        apart = np.abs(across - across[nearest]) % _PARTS
        step = np.hypot(np.minimum(apart, _PARTS - apart), speed - speed[nearest])
        new = distance[nearest] + step**_POWER
        nearer = left & (new < distance)
        distance[nearer], forward[nearer] = new[nearer], forward[nearest]
    return forward
