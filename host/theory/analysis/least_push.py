"""The least push that reverses a rolling wheel, over the phase and the push's direction.

A push moves the state of a wheel at once: both membrane potentials (a frozen kick of any direction
in their plane), or the speed. Its amplitude is the distance that it moves them.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.edge import Pair, thresholds
from host.theory.analysis.outcomes import QUARTER, rolling_states
from host.theory.engine.kicked import Continuous
from host.theory.model.wheel import OMEGA, Array, Wheel

Whole = NDArray[np.int64]
PushKind = Literal["potentials", "speed"]
POTENTIALS: PushKind = "potentials"
SPEED: PushKind = "speed"
KINDS: tuple[PushKind, ...] = (POTENTIALS, SPEED)
# Moments of a quarter turn of rolling; how many of them, and of directions, a search begins with.
# The speed has two directions only, and so as many more moments.
MOMENTS, PHASES, DIRECTIONS, MORE = 1024, 16, 32, 8
# At how many amplitudes a push is tried first, the closer the smaller they are. The greatest is
# MOST times the size of the potentials, or the speed, of the wheel that rolls.
LEVELS, MOST = 16, 4.0
# Around the best of the grid there are _ROUNDS finer ones, with _LINES lines to either side; each
# has 1/_FINER of the spacing before. The amplitudes that are tried are multiples of the least so
# far, and include it, so that it cannot get lost. They are sought to _WITHIN of themselves.
_LINES, _FINER, _ROUNDS, _WITHIN = 2, 4, 3, 1e-7
_AROUND = np.linspace(0.5, 1.1, 37)
# On the grid they are sought to this part of the greatest one.
_COARSE = 1e-3


class Least(NamedTuple):
    """The least push.

    Attributes:
        amplitude: its size: without unit, or in rad/s.
        error: how far it may be off, in the same unit: the misfit of a parabola near the least;
            where there is none, the difference to the next value, or to a coarser grid's; and half
            of the last bisection's interval.
        moment: the number of the moment, from 0 to MOMENTS, with a fraction.
        angle: its direction in the plane of the potentials, rad; for the speed 0 is forward and pi
            backward.
        below: the wheel at the nearest moment of the grid after a push that just fails, (4,).
        above: after one that just reverses it, (4,).
    """

    amplitude: float
    error: float
    moment: float
    angle: float
    below: Array
    above: Array


class Pushes(NamedTuple):
    """Pushes at several moments and in several directions.

    Attributes:
        moments: the numbers of the moments, (pushes,); beyond MOMENTS in the next quarter turn.
        angles: the directions, rad, (pushes,).
        starts: the wheel at these moments, (4, pushes).
        ways: where the pushes go, as unit vectors, (4, pushes).
    """

    moments: Whole
    angles: Array
    starts: Array
    ways: Array


def rolling(wheel: Wheel) -> Array | None:
    """A wheel at MOMENTS of its first quarter turn of rolling forward, in order, (4, MOMENTS).

    None if it does not roll. Raises WrongUse if it cannot be followed.
    """
    found = rolling_states(Continuous(), wheel, MOMENTS)
    if found is None:
        return None
    x1, x2, phi, omega = found
    # A wheel looks the same after a quarter turn, if its potentials are turned back by as much.
    turned = np.floor(phi / QUARTER) * QUARTER
    cosine, sine = np.round(np.cos(turned)), np.round(np.sin(turned))
    return np.array([cosine * x1 + sine * x2, cosine * x2 - sine * x1, phi - turned, omega])


def pushes(kind: PushKind, cycle: Array, moments: Whole, angles: Array) -> Pushes:
    """Pushes of a kind at these moments and in these directions (rad), (pushes,) each."""
    ways = np.zeros((4, len(angles)))
    if kind == POTENTIALS:
        in_quarter = angles - moments // MOMENTS * QUARTER
        ways[0], ways[1] = np.cos(in_quarter), np.sin(in_quarter)
    else:
        ways[OMEGA] = np.cos(angles)
    return Pushes(moments, angles, cycle[:, moments % MOMENTS], ways)


def grid(kind: PushKind, cycle: Array, moments: Whole) -> Pushes:
    """Pushes of a kind at some moments, in all directions."""
    count = DIRECTIONS if kind == POTENTIALS else 2
    angles = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    return pushes(kind, cycle, np.repeat(moments, count), np.tile(angles, len(moments)))


def levels(kind: PushKind, cycle: Array) -> Array:
    """The amplitudes at which a push is tried first, (LEVELS,)."""
    size = np.hypot(cycle[0], cycle[1]) if kind == POTENTIALS else cycle[OMEGA]
    return np.asarray(MOST * size.max() * np.linspace(0.0, 1.0, LEVELS + 1)[1:] ** 2)


def amplitudes(wheel: Wheel, of: Pushes, tried: Array) -> Pair:
    """The amplitudes around which pushes begin to reverse, to a thousandth of the greatest one.

    Raises WrongUse if wheels cannot be followed.
    """
    return thresholds(wheel, of.starts, of.ways, tried, _COARSE * tried[-1])


def least(kind: PushKind, wheel: Wheel, cycle: Array) -> Least | None:
    """The least push of a kind that reverses a wheel.

    Args:
        kind: What is pushed.
        wheel: The wheel's constants.
        cycle: The wheel at all moments, (4, MOMENTS).

    Returns:
        The push; None if none that is tried reverses.

    Raises:
        WrongUse: Wheels cannot be followed.
    """
    spacing = MOMENTS // (PHASES if kind == POTENTIALS else MORE * PHASES)
    all_ways = grid(kind, cycle, np.arange(0, MOMENTS, spacing, dtype=np.int64))
    tried = levels(kind, cycle)
    rough = thresholds(wheel, all_ways.starts, all_ways.ways, tried, np.inf)
    if not np.isfinite(rough.above.min()):
        return None
    hopeful = np.flatnonzero(rough.below < rough.above.min())
    ways = pushes(kind, cycle, all_ways.moments[hopeful], all_ways.angles[hopeful])
    found = amplitudes(wheel, ways, tried)
    turn = all_ways.angles[1]
    lines = np.arange(-_LINES, _LINES + 1)
    for _ in range(_ROUNDS):
        best = int(found.above.argmin())
        spacing, turn = max(1, spacing // _FINER), turn / _FINER
        asides = turn * (lines if kind == POTENTIALS else np.zeros(1))
        ways = pushes(
            kind,
            cycle,
            np.repeat(ways.moments[best] + spacing * lines, len(asides)),
            np.tile(ways.angles[best] + asides, len(lines)),
        )
        near = float(found.above[best])
        found = thresholds(wheel, ways.starts, ways.ways, near * _AROUND, _WITHIN * near)
    return _lowest(kind, ways, found, near)


def _lowest(kind: PushKind, ways: Pushes, found: Pair, before: float) -> Least:
    """The least push from the finest grid, and from the least amplitude of the grid before."""
    best = int(found.above.argmin())
    moment, angle = float(ways.moments[best]), float(ways.angles[best])
    # Without a parabola, where two folds of the edge meet, the least is known to the next value, or
    # to the distance of the amplitudes that were tried.
    heights = (found.below + found.above) / 2
    amplitude, next_one = np.partition(heights, 1)[:2].tolist()
    error = min(next_one - amplitude, before * float(_AROUND[1] - _AROUND[0]))
    later, turned = ways.moments - ways.moments[best], ways.angles - angle
    fitted = _vertex(later.astype(float), turned, heights)
    if fitted is not None:
        amplitude, error, by_moment, by_angle = fitted
        moment, angle = moment + by_moment, angle + by_angle
    # The grid before may have met a thin reach of the other basin that this one has missed.
    error = max(error, amplitude - before) + float(found.above[best] - found.below[best]) / 2
    if kind == POTENTIALS:
        angle -= moment // MOMENTS * QUARTER
    start, way = ways.starts[:, best], ways.ways[:, best]
    return Least(
        amplitude,
        error,
        moment % MOMENTS,
        angle % (2 * np.pi),
        start + found.below[best] * way,
        start + found.above[best] * way,
    )


def _vertex(
    later: Array, turned: Array, heights: Array
) -> tuple[float, float, float, float] | None:
    """The lowest point of the parabola through amplitudes.

    Returns:
        Its height, the greatest misfit, and where it is; None if it is none of the given ones'.
    """
    used = [offsets for offsets in (later, turned) if np.ptp(offsets) > 0.0]
    scales = [np.ptp(offsets) for offsets in used]
    scaled = [offsets / scale for offsets, scale in zip(used, scales, strict=True)]
    count = len(scaled)
    products = [scaled[i] * scaled[j] for i in range(count) for j in range(i, count)]
    matrix = np.stack([np.ones_like(heights), *scaled, *products], axis=1)
    if not np.isfinite(heights).all():
        return None
    solved = np.linalg.lstsq(matrix, heights, rcond=None)[0]
    slope, bend = solved[1 : count + 1], np.zeros((count, count))
    bend[np.triu_indices(count)] = solved[count + 1 :]
    bend += bend.T
    if np.linalg.eigvalsh(bend).min() <= 0.0:
        return None
    place = -np.linalg.solve(bend, slope)
    if np.abs(place).max() > 0.5:
        return None
    misfit = float(np.abs(matrix @ solved - heights).max())
    offsets = [*(place * scales).tolist(), 0.0]
    return float(solved[0] + slope @ place / 2), misfit, offsets[0], offsets[1]
