"""What the pieces of the studies `section` and `orbit` share: wheels that settle on a section."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np

from host.theory.analysis.hopf import hopf
from host.theory.analysis.sections import SAME, Motion, Points, irregular, motion, points
from host.theory.analysis.spectrum import largest_exponents
from host.theory.engine.crossings import Surface, crossings
from host.theory.model.wheel import Array, Wheel
from host.theory.studies.section_rows import MotionColumns
from sim_motor.compiled import on_one_core

# Looks at a wheel that neither repeats itself nor has an exponent above SURE (1/s): SWINGS
# slowest swings long at first, each then twice as long as the one before.
LOOKS, SWINGS, SURE = 5, 20.0, 0.1
# How long the largest exponent of wheels that do not repeat themselves is measured, s, with steps
# that are fine enough for it (host.theory.engine.ensemble).
EXPONENT_S, FINENESS = 150.0, 0.6


class Settled(NamedTuple):
    """A wheel on the section.

    Attributes:
        points: its points.
        crossed: the crossings that they stand for, (crossings, 4).
        ended: the state after them, (4,).
        motion: what it does; None if it does not repeat itself.
    """

    points: Points
    crossed: Array
    ended: Array
    motion: Motion | None


def swing_s(wheel: Wheel) -> float:
    """The period of the slowest swings, s: those at the Hopf bifurcation. Raises WrongUse."""
    return 2 * pi / hopf(wheel).omega


def follow_wheels(
    wheels: list[Wheel], states: Array, seconds: float, surface: Surface, fineness: float
) -> list[Settled]:
    """Follow wheels from their states, (4, wheels), for some seconds.

    A rolling wheel never turns round: its motion is then that on the other section.
    """
    parameters = np.array(wheels).T
    found = crossings(states, parameters, seconds, surface, fineness=fineness)
    settled = []
    for number, (wheel, times_s, crossed, ended) in enumerate(
        zip(wheels, found.times_s, found.states, found.ended.T, strict=True)
    ):
        own = points(times_s, crossed, wheel, surface)
        what = motion(own, ended)
        if surface != "phi" and not len(times_s):
            what = follow_wheels([wheel], states[:, [number]], seconds, "phi", fineness)[0].motion
            if what and what.repeat:
                what = Motion(what.kind, what.repeat._replace(crossings=0))
        settled.append(Settled(own, crossed, ended, what))
    return settled


def motions_of(wheels: list[Wheel], settled: list[Settled]) -> list[MotionColumns]:
    """What wheels do in the end, with the exponents of those that do not repeat themselves."""
    whats = [one.motion or motion(one.points, one.ended, settling=True) for one in settled]
    odd = [number for number, what in enumerate(whats) if what is None]
    exponents: dict[int, float] = {}
    if odd:
        states = np.array([settled[number].ended for number in odd]).T
        parameters = np.array([wheels[number] for number in odd]).T
        moving = np.ones(len(odd), dtype=bool)
        with on_one_core():
            found = largest_exponents(states, parameters, EXPONENT_S, moving, FINENESS)
        exponents = dict(zip(odd, found.tolist(), strict=True))
    rows: list[MotionColumns] = []
    for number, known in enumerate(whats):
        what = known or irregular(settled[number].points, exponents[number], wheels[number])
        cycle = what.repeat
        rows.append(
            {
                "kind": what.kind,
                "period": (cycle.crossings or None) if cycle else None,
                "period_s": cycle.period_s if cycle else None,
                "exponent": exponents.get(number),
            }
        )
    return rows


def settle_longer(
    wheels: list[Wheel],
    settled: list[Settled],
    surface: Surface,
    fineness: float,
    exact: float = SAME,
) -> list[MotionColumns]:
    """What wheels do in the end; those that settle slowly are followed for longer.

    Args:
        wheels: The wheels.
        settled: What they did so far; replaced for those that are followed for longer.
        surface: The section.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.flow).
        exact: How close points have to be that are the same (see Repeat).
    """
    found = motions_of(wheels, settled)
    for number, wheel in enumerate(wheels):
        exponent = found[number]["exponent"]
        if _is_exact(settled[number], exact) or (exponent is not None and exponent > SURE):
            continue
        for look in range(LOOKS):
            seconds, state = SWINGS * 2.0**look * swing_s(wheel), settled[number].ended[:, None]
            (settled[number],) = follow_wheels([wheel], state, seconds, surface, fineness)
            if _is_exact(settled[number], exact):
                break
        (found[number],) = motions_of([wheel], [settled[number]])
    return found


def _is_exact(settled: Settled, exact: float) -> bool:
    """Whether a wheel rests, or repeats itself so closely."""
    what = settled.motion
    return what is not None and (what.repeat is None or what.repeat.off_by < exact)
