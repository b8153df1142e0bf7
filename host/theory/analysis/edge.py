"""The edge between rolling forward and rolling backward, and the least push across it.

The edge is the boundary of the basin of wheels that end rolling backward. Wheels that start on it
go to neither side, but to an edge state: a motion that attracts within the edge and repels across
it (Skufca, Yorke, Eckhardt, Phys. Rev. Lett. 96, 2006). The least push of a wheel that rolls
forward leads just across the edge. Between two wheels, one on each side, the edge is found by
bisection; such a pair is followed, and bisected anew whenever it drifts apart.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.outcomes import BACKWARD, settle_and_classify
from host.theory.engine.ensemble import advance
from host.theory.engine.kicked import Continuous, memory_s
from host.theory.model.wheel import Array, Wheel

_MODEL = Continuous()
# In a round of bisection each ray has at least _SECTIONS points between its two ends. Rays together
# have at least _SIDE_BY_SIDE: these run side by side for free.
_SECTIONS, _SIDE_BY_SIDE = 8, 64
# After a bisection a pair across the edge is NEAR; it is bisected again when it is APART.
# Closer pairs would differ less than a wheel's computed course from its true one. Should both be
# on one side all the same, the edge is looked for at these multiples of their distance.
NEAR, APART = 1e-7, 1e-4
_BEYOND = np.array([-8.0, -2.0, 0.0, 1.0, 3.0, 9.0])
_STEP_MEMORIES = 0.05
# They have parted at this distance, and are followed for at most this time, in memories.
PARTED, _LONGEST = 1.0, 100.0


class Pair(NamedTuple):
    """Two states on one ray, (4, rays), on either side of the edge, and the amplitudes of both.

    Attributes:
        below: the greatest amplitude that was tried below that, (rays,); it does not reverse.
        above: the least amplitude that reverses, (rays,); infinite where none does.
    """

    below: Array
    above: Array


def reverses(wheel: Wheel, states: Array) -> NDArray[np.bool_]:
    """Which wheels end rolling backward, (wheels,). Raises WrongUse if they cannot be followed."""
    return np.asarray(settle_and_classify(_MODEL, states, wheel)[0] == BACKWARD)


def thresholds(
    wheel: Wheel, starts: Array, directions: Array, levels: Array, within: float
) -> Pair:
    """The least amplitudes along rays that reverse a wheel.

    Args:
        wheel: The wheel's constants.
        starts: Where the rays begin, (4, rays).
        directions: Where they go, (4, rays).
        levels: Amplitudes at which a first one that reverses is looked for, ascending, (levels,).
        within: How far the two amplitudes of a pair may be apart in the end.

    Returns:
        The amplitudes on both sides of the edge where a ray first crosses it. A reach of the other
        basin that is narrower than the distance of levels may be missed.

    Raises:
        WrongUse: Wheels cannot be followed.
    """

    def reversed_at(amplitudes: Array, rays: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether these amplitudes, (rays, amplitudes), reverse."""
        states = starts[:, rays, None] + directions[:, rays, None] * amplitudes
        return reverses(wheel, states.reshape(4, -1)).reshape(amplitudes.shape)

    def first(amplitudes: Array, found: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The amplitudes around the first that reverses; the last column always does."""
        place, row = found.argmax(axis=1), np.arange(len(found))
        return amplitudes[row, place - 1], amplitudes[row, place]

    count = starts.shape[1]
    tried = np.broadcast_to(levels, (count, len(levels)))
    found = reversed_at(tried, np.arange(count))
    able = np.flatnonzero(found.any(axis=1))
    below, above = np.full(count, levels[-1]), np.full(count, np.inf)
    from_zero = np.hstack([np.zeros((len(able), 1)), tried[able]])
    inside, outside = first(from_zero, np.pad(found[able], ((0, 0), (1, 0))))
    while len(able) and (outside - inside).max() > within:
        sections = max(_SECTIONS, _SIDE_BY_SIDE // len(able))
        parts = np.linspace(inside, outside, sections + 2, axis=1)
        found = reversed_at(parts[:, 1:-1], able)
        inside, outside = first(
            parts, np.pad(found, ((0, 0), (1, 1)), constant_values=(False, True))
        )
    below[able], above[able] = inside, outside
    return Pair(below, above)


class EdgePath(NamedTuple):
    """What a wheel on the edge does.

    Attributes:
        times: s, (points,).
        states: (4, points).
        forward: the last state on the side of rolling forward, (4,).
        backward: the last state on the other side, (4,).
    """

    times: Array
    states: Array
    forward: Array
    backward: Array


def track(wheel: Wheel, forward: Array, backward: Array, memories: float) -> EdgePath:
    """Follow the edge from between two states.

    Args:
        wheel: The wheel's constants.
        forward: A state that does not reverse, (4,).
        backward: A state near it that does, (4,).
        memories: For how long, in units of the wheel's memory; less if the edge gets lost, which
            may be where it has many folds.

    Raises:
        WrongUse: The wheel cannot be followed.
    """
    step_s = _STEP_MEMORIES * memory_s(wheel)
    pair = np.stack([forward, backward], axis=1)
    path = [forward]
    for _ in range(round(memories / _STEP_MEMORIES)):
        if len(path) == 1 or np.abs(pair[:, 1] - pair[:, 0]).max() > APART:
            closer = _closer(wheel, pair)
            if closer is None:
                break
            pair = closer
        pair = advance(pair, wheel.columns(2), step_s)
        path.append(pair[:, 0])
    times: Array = step_s * np.arange(len(path), dtype=np.float64)
    return EdgePath(times, np.stack(path, axis=1), pair[:, 0], pair[:, 1])


def _closer(wheel: Wheel, pair: Array) -> Array | None:
    """A pair across the edge, (4, 2), that is NEAR, between two that are farther apart.

    None if the edge is not there.
    """
    apart = pair[:, 1] - pair[:, 0]
    size = float(np.abs(apart).max())
    if size <= NEAR:
        return pair
    first = pair[:, :1] + apart[:, None] * _BEYOND[0]
    found = thresholds(wheel, first, apart[:, None], _BEYOND[1:] - _BEYOND[0], NEAR / size)
    if not np.isfinite(found.above[0]):
        return None
    return np.asarray(first + apart[:, None] * np.array([found.below[0], found.above[0]]))


def departures(wheel: Wheel, path: EdgePath, memories: float) -> Iterator[tuple[Array, Array]]:
    """The courses of both sides of the edge from the end of a path on.

    Args:
        wheel: The wheel's constants.
        path: The path.
        memories: For how long after they have parted, in units of the wheel's memory.

    Yields:
        Times from the path's start, s, (points,), and states, (4, points): forward, then backward.
    """
    step_s = _STEP_MEMORIES * memory_s(wheel)
    pair = np.stack([path.forward, path.backward], axis=1)
    states, parted = [pair], 0
    while parted * _STEP_MEMORIES < memories and len(states) * _STEP_MEMORIES < _LONGEST:
        states.append(advance(states[-1], wheel.columns(2), step_s))
        parted += bool(np.abs(states[-1][:, 1] - states[-1][:, 0]).max() > PARTED)
    courses = np.stack(states, axis=2)
    times = path.times[-1] + step_s * np.arange(len(states))
    yield from ((times, courses[:, side]) for side in (0, 1))
