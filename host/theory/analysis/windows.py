"""Windows: ranges of a constant in which a cycle of several crossings attracts wheels.

Wheels are followed from random states. One that repeats itself on the section phi = 0 after more
than one crossing, up to the symmetries (host.theory.analysis.sections), is on a cycle that neither
the swings nor the rotations of host.theory.analysis.branches show. The cycle is followed both ways
along the constant, to the bifurcations at which it ceases to attract.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from host.errors import NotDone
from host.theory.analysis.attractors import random_starts, settle
from host.theory.analysis.bifurcations import BifurcationType, is_bifurcation, tests_of
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import FORTH_AND_BACK, ROTATION, SECTION, Family, Shooting
from host.theory.analysis.deciding import settle_beside_close
from host.theory.analysis.sections import Points, points, repeat
from host.theory.engine.crossings import crossings
from host.theory.model.wheel import OMEGA, Array, Wheel

# Random states at each value; how long they settle, are watched for close wheels that part, and
# then followed from crossing to crossing, s.
_STARTS, _SETTLE_S, _PART_S, _CROSS_S = 4, 350.0, 50.0, 40.0
_FINENESS = 0.6
# Longer cycles are left out: their windows are narrow.
MOST_CROSSINGS = 20
_SHORTEST_STEP, _LONGEST_STEP, _MOST_POINTS = 1e-6, 0.02, 200
_ALONG = np.array([0.0, 0.0, 0.0, 0.0, 1.0])


class Edge(NamedTuple):
    """Where a cycle ceases to attract.

    Attributes:
        family: the symmetry of the cycle.
        type: of the bifurcation.
        unknowns: the cycle, with those of Shooting, (5,).
    """

    family: Family
    type: BifurcationType
    unknowns: Array


def window_edges(wheel: Wheel, field: str, values: Array, rng: np.random.Generator) -> list[Edge]:
    """The edges of the windows that have one of these values.

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        field: The field of Wheel that varies.
        values: The values that are tried, ascending, (values,).
        rng: The source of chance.

    Returns:
        The edges, both of a window after each other, as far as they were found.

    Raises:
        WrongUse: A wheel is too stiff to be followed.
    """
    edges: list[Edge] = []
    spans: list[tuple[Family, float, float]] = []
    for family, unknowns in attracting_cycles(wheel, field, values, rng):
        value = unknowns[4]
        if any(family.name == other.name and low <= value <= high for other, low, high in spans):
            continue
        try:
            found = _both_ways(Shooting(wheel, family, field), unknowns, values[0], values[-1])
        except NotDone:
            continue
        edges += [edge for edge, _ in found if edge]
        ends = sorted(end for _, end in found)
        spans.append((family, ends[0], ends[1]))
    return edges


def attracting_cycles(
    wheel: Wheel, field: str, values: Array, rng: np.random.Generator
) -> list[tuple[Family, Array]]:
    """Attracting cycles of several crossings, and guesses of their unknowns, (5,)."""
    every = np.repeat(values, _STARTS)
    parameters = wheel.columns(len(every), **{field: every})
    states = settle(random_starts(len(every), rng), parameters, _SETTLE_S, _FINENESS)
    states, chaotic = settle_beside_close(states, parameters, _PART_S)
    every, states = every[~chaotic], states[:, ~chaotic]
    if not len(every):
        return []
    parameters = wheel.columns(len(every), **{field: every})
    found = crossings(states, parameters, _CROSS_S)
    cycles = []
    for value, times_s, crossed in zip(every.tolist(), found.times_s, found.states, strict=True):
        own = points(times_s, crossed, wheel._replace(**{field: value}), "phi")
        cycle = repeat(own) if len(times_s) else None
        if cycle and 1 < cycle.crossings <= MOST_CROSSINGS:
            cycles.append(cycle_of(own, cycle.crossings, value))
    return cycles


def cycle_of(found: Points, length: int, value: float) -> tuple[Family, Array]:
    """A cycle from its points on the section.

    It begins at its fastest crossing, as the symmetry that closes it depends on where it begins.

    Args:
        found: The points, of two periods at least.
        length: After how many crossings they repeat themselves.
        value: The constant in which it may be followed.

    Returns:
        Its family, and its unknowns (see Shooting), (5,).
    """
    whole = len(found.states) - 2 * length
    begin = whole + int(found.states[whole:-length, OMEGA].argmax())
    end = begin + length
    turned = int(found.quarters[end] - found.quarters[begin])
    if found.mirrored[begin]:
        turned = -turned
    seconds = float(found.times_s[end] - found.times_s[begin])
    family = family_of(length, turned, bool(found.mirrored[end] != found.mirrored[begin]))
    return family, np.array([*found.states[begin][SECTION], seconds, value])


def family_of(length: int, quarters: int, mirrored: bool) -> Family:
    """The symmetry of cycles on the section.

    Args:
        length: After how many crossings the cycle repeats itself, up to the symmetries.
        quarters: The quarter turns that it has then made.
        mirrored: Whether it goes on as its mirror image.

    Returns:
        The family. A cycle of power 1 has no symmetry, and may double its period.
    """
    back = np.linalg.matrix_power(ROTATION.back, quarters % 4)
    power = 4 // np.gcd(4, quarters % 4)
    if mirrored:
        back, power = FORTH_AND_BACK.back @ back, 2
    name = f"{length} crossings, {quarters} quarter turns" + mirrored * ", mirrored"
    return Family(name, back, quarters * ROTATION.turn, float(power), length)


def _both_ways(
    shooting: Shooting, unknowns: Array, low: float, high: float
) -> list[tuple[Edge | None, float]]:
    """The edges of a window downward and upward, and the last values of the constant."""
    scales = np.maximum(np.abs(unknowns), [1.0, 1.0, 0.0, 0.0, 0.0])
    curve = Curve(shooting, scales)
    first = curve.solve(unknowns, _ALONG)
    return [
        _edge(shooting, curve, first._replace(tangent=sign * first.tangent), low, high)
        for sign in (-1.0, 1.0)
    ]


def _edge(
    shooting: Shooting, curve: Curve, first: Point, low: float, high: float
) -> tuple[Edge | None, float]:
    before = first
    try:
        for number, point in enumerate(curve.follow(first, _SHORTEST_STEP, _LONGEST_STEP)):
            if number and abs(shooting.multipliers(point.unknowns)[0]) >= 1.0:
                for type_, test in tests_of(shooting).items():
                    if test(before) * test(point) >= 0.0:
                        continue
                    there = curve.locate(before, point, test).unknowns
                    inside = low <= there[4] <= high
                    if inside and is_bifurcation(type_, shooting.multipliers(there)):
                        return Edge(shooting.family, type_, there), float(there[4])
                break
            before = point
            if not low <= point.unknowns[4] <= high or number == _MOST_POINTS:
                break
    except NotDone:
        pass
    return None, float(before.unknowns[4])
