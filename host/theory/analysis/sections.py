"""Wheels on a Poincare section: their points up to the symmetries, and whether these repeat.

The section phi = 0 stands for all multiples of a quarter turn, crossed in either direction:
quarter turns and the mirror (host.theory.analysis.cycles) bring each crossing to phi = 0 with
omega > 0. So a rotation and a forth-and-back cycle are fixpoints of the return map. The section
omega = 0 stands likewise for a wheel that turns from forward to backward, at -pi/4 to pi/4.
"""

from __future__ import annotations

from math import gcd, pi
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.attractors import KINDS, STILL, Kind
from host.theory.analysis.fixpoints import fixpoint
from host.theory.engine.crossings import Surface
from host.theory.model.laws import array_rates, law_of
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel

MotionKind = Literal[Kind, "quasi-periodic", "undecided"]
REST, BACK, ROLL, CHAOS = KINDS
TORUS: MotionKind = "quasi-periodic"
UNDECIDED: MotionKind = "undecided"
# Points are the same if they differ by less than SAME, potentials in 1 and speeds in units of the
# greatest one; those of a period differ from each other by more than APART. In between, a wheel
# still settles.
SAME, APART = 1e-6, 1e-3
# What still settles comes closer by this factor in the second half of the time.
CLOSER = 0.9
# A wheel that does not repeat itself is chaotic if its largest exponent is above this (1/s).
GROWS = 0.01
# A swing still settles if all of it gets smaller from each of PARTS parts of the time to the next
# one, or larger. It comes to rest if it shrinks as fast as close to rest, to this part of that
# rate.
PARTS, AS_AT_REST = 8, 0.5
# The longest period that is looked for, and the fewest pairs of points by which a wheel is known to
# repeat itself: one that has settled, and one that still settles.
LONGEST, FEWEST, FEWEST_SETTLING = 64, 2, 16


class Points(NamedTuple):
    """The crossings of one wheel, up to the symmetries.

    Attributes:
        times_s: when, s, (crossings,).
        states: the states that stand for them, (crossings, 4).
        quarters: the quarter turns that were taken off the angle, (crossings,).
        mirrored: whether the mirror was applied, (crossings,).
    """

    times_s: Array
    states: Array
    quarters: NDArray[np.int64]
    mirrored: NDArray[np.bool_]


def points(times_s: Array, states: Array, wheel: Wheel, surface: Surface) -> Points:
    """The points on the section that stand for crossings.

    Args:
        times_s: When the wheel crosses the surface, s, (crossings,).
        states: In which states, (crossings, 4).
        wheel: The wheel.
        surface: The surface.

    Returns:
        The points.
    """
    x1, x2, phi, omega = states.T
    quarters = np.round(phi / (pi / 2)).astype(np.int64)
    if surface == "phi":
        mirrored = omega < 0.0
    else:
        mirrored = array_rates(law_of(wheel))(x1, x2, phi, omega, *wheel)[OMEGA] > 0.0
    sign = np.where(mirrored, -1.0, 1.0)
    turned = (x1 + 1j * x2) * np.array([1, -1j, -1, 1j])[quarters % 4]
    rest = phi - quarters * (pi / 2)
    found = np.array([turned.real, sign * turned.imag, sign * rest, sign * omega]).T
    found[:, PHI if surface == "phi" else OMEGA] = 0.0
    return Points(times_s, found, quarters, mirrored)


class Repeat(NamedTuple):
    """A motion that repeats itself.

    Attributes:
        crossings: the number after which the points on the section repeat themselves.
        period_s: after this time (s) the wheel repeats itself, whole turns apart.
        quarters: by how many quarter turns it has then turned.
        off_by: the greatest difference between points that are the same.
    """

    crossings: int
    period_s: float
    quarters: int
    off_by: float


def repeat(found: Points, *, settling: bool = False) -> Repeat | None:
    """How a motion repeats itself at its end.

    Args:
        found: Its points.
        settling: Whether points are the same, too, that come closer and are APART at most.

    Returns:
        The shortest period, of at most LONGEST crossings and a half of all; None if there is none.
    """
    fastest = max(float(np.abs(found.states[:, OMEGA]).max(initial=0.0)), STILL)
    scaled = found.states / [1.0, 1.0, 1.0, fastest]
    for length in range(1, min(LONGEST, len(scaled) // 2) + 1):
        pairs = max(length, FEWEST_SETTLING if settling else FEWEST)
        if length + pairs > len(scaled):
            return None
        differences = np.abs(scaled[length:] - scaled[:-length]).max(axis=1)
        first_half, last_half = np.array_split(differences, 2)
        off_by = float(differences[-pairs:].max())
        comes_closer = bool(last_half.max() < CLOSER * first_half.max())
        if off_by < SAME or (settling and comes_closer and off_by < APART):
            return _repeat(found, length, off_by)
        # A spiral towards a shorter period nearly repeats itself with a longer one, too.
        if off_by < APART or comes_closer:
            return None
    return None


def _repeat(found: Points, length: int, off_by: float) -> Repeat:
    quarters = int(found.quarters[-1] - found.quarters[-1 - length])
    seconds = float(found.times_s[-1] - found.times_s[-1 - length])
    # The symmetry that has brought the wheel back is a mirror, or a number of quarter turns.
    if found.mirrored[-1] != found.mirrored[-1 - length]:
        times, quarters = 2, 0
    else:
        times = 4 // gcd(4, quarters % 4)
    return Repeat(length, times * seconds, times * quarters, off_by)


class Motion(NamedTuple):
    """What a wheel does in the end.

    Attributes:
        kind: at rest, forth-and-back, rolling, chaotic, quasi-periodic, or undecided.
        repeat: how it repeats itself; None if it does not, or has no points on the section.
    """

    kind: MotionKind
    repeat: Repeat | None


def motion(found: Points, ended: Array, *, settling: bool = False) -> Motion | None:
    """What a wheel does, as far as its points show it.

    Args:
        found: Its points on the section.
        ended: The state after them, (4,).
        settling: As in `repeat`.

    Returns:
        The motion; None if it does not repeat itself (see `irregular`).
    """
    if not len(found.times_s):
        return Motion(REST if abs(ended[OMEGA]) < STILL else ROLL, None)
    sizes = _sizes(found)
    if sizes[-1] < STILL:
        return Motion(REST, None) if sizes[-1] <= sizes[0] else None
    cycle = repeat(found, settling=settling)
    if settling and cycle and cycle.crossings == 1 and sizes[-1] < CLOSER * sizes[0]:
        return None  # it may come to rest
    return cycle and Motion(ROLL if cycle.quarters else BACK, cycle)


def irregular(found: Points, exponent: float, wheel: Wheel) -> Motion:
    """The motion of a wheel that does not repeat itself.

    A torus has a largest exponent of 0, but so have a cycle and a rest that are close to a Hopf
    bifurcation, to which a wheel takes long to settle.

    Args:
        found: Its points on the section.
        exponent: Its largest exponent, 1/s.
        wheel: The wheel.

    Returns:
        At rest, chaotic, quasi-periodic or undecided.
    """
    if exponent > GROWS:
        return Motion(CHAOS, None)
    if not _still_settles(found):
        return Motion(TORUS, None)
    at_rest = float(fixpoint(0.0, wheel).eigenvalues[0].real)
    rests = at_rest < 0.0 and abs(exponent - at_rest) < AS_AT_REST * -at_rest
    return Motion(REST if rests else UNDECIDED, None)


def _still_settles(found: Points) -> bool:
    """Whether a wheel swings in one well, and ever less or ever more."""
    if len(found.times_s) < 2 * PARTS or np.ptp(found.quarters):
        return False
    parts = np.array_split(_sizes(found), PARTS)
    least, most = (np.array([limit(part) for part in parts]) for limit in (np.min, np.max))
    return bool((most[1:] < least[:-1]).all() or (least[1:] > most[:-1]).all())


def _sizes(found: Points) -> Array:
    """How far from rest each point is, (crossings,)."""
    return np.asarray(np.abs(found.states[:, [PHI, OMEGA]]).max(axis=1))
