"""Lines of bifurcations of cycles in the plane of two constants, with what is special on them.

On such a line a cycle is a fixpoint of its reduced map (host.theory.analysis.cycles), and one more
function vanishes: pseudo-arclength continuation follows both (Kuznetsov, Elements of Applied
Bifurcation Theory, section 10.3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi
from typing import Literal, NamedTuple

import numpy as np

from host.errors import NotDone
from host.theory.analysis.bifurcations import FOLD, NEIMARK_SACKER, BifurcationType, vanishing
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import FORTH_AND_BACK, Family, Shooting
from host.theory.analysis.hopf import above_hopf
from host.theory.analysis.merging import saddle
from host.theory.engine.flow import FINENESS
from host.theory.model.wheel import Array, Wheel

# What is special on a line: two folds meet; the Hopf line is crossed; multipliers of the reduced
# map are third or fourth roots of 1.
Mark = Literal["cusp", "crosses Hopf", "resonance 1:3", "resonance 1:4"]
# Where a line ends: at the edge of the range; on the Hopf line, where its cycles vanish; on the
# merging line; where its multipliers are 1 twice, or -1 twice; where it cannot be followed further;
# after too many points. One that runs beside the merging line is not followed at all.
LineEnd = Literal[
    "range", "Hopf line", "merging", "resonance 1:1", "resonance 1:2", "lost", "long", "beside"
]
# The step, relative to an unknown's scale, of the derivatives of the function that vanishes.
_DIFFERENCE = 1e-8
_SHORTEST_STEP, _LONGEST_STEP, _MOST_POINTS = 2e-3, 0.1, 60
# A cycle whose reduced map takes the longest of these times of the saddle's growth is within about
# 1e-5 (relative) of the merging, and its line ends there. Closer to it, shooting cannot follow it;
# a line that is lost beyond the shorter of these times has come to the merging.
_LONG, _LONGEST = 8.0, 11.0
_FINER = 1.5
# A line that is lost where the amplitude of forth-and-back cycles is less than about this (rad) has
# come to the Hopf line. The function that vanishes is rounding for small cycles.
_SMALL = 0.05
_X, _Y = 4, 5


class Window(NamedTuple):
    """A part of the plane: least and greatest x, least and greatest y."""

    x_from: float
    x_to: float
    y_from: float
    y_to: float


class Special(NamedTuple):
    """A special point of a line.

    Attributes:
        type: what is special.
        point: the cycle there.
        off_by: greatest relative difference of x and y if located with shorter time steps.
    """

    type: Mark
    point: Point
    off_by: float


class Traced(NamedTuple):
    """A line: its points, what is special on it, and why it ends."""

    points: list[Point]
    specials: list[Special]
    end: LineEnd


@dataclass(frozen=True)
class CycleLine:
    """A line as a problem (see host.theory.analysis.continuation).

    The unknowns are (x1, x2, omega, time, x, y), (6,): those of Shooting, and the plane's other
    constant.

    Attributes:
        wheel: the wheel; the plane's two constants are replaced.
        family: the symmetry of the cycles.
        type: of the bifurcation.
        fields: the fields of Wheel that are the plane's constants, x and y.
        scales: of the unknowns, (6,).
        fineness: steps per unit of the wheel's rate (see host.theory.engine.flow).
    """

    wheel: Wheel
    family: Family
    type: BifurcationType
    fields: tuple[str, str]
    scales: Array
    fineness: float = FINENESS

    @property
    def curve(self) -> Curve:
        """The curve of its solutions."""
        return Curve(self, self.scales)

    def wheel_at(self, unknowns: Array) -> Wheel:
        """The wheel with the plane's two constants."""
        return self.wheel._replace(**dict(zip(self.fields, unknowns[_X:].tolist(), strict=True)))

    def shooting(self, unknowns: Array, axis: int = 0) -> Shooting:
        """The cycles along one of the plane's axes, through these constants."""
        return Shooting(self.wheel_at(unknowns), self.family, self.fields[axis], self.fineness)

    def cosine(self, point: Point) -> float:
        """The cosine of the angle by which the reduced map turns at a Neimark-Sacker bifurcation.

        Beyond -1 and 1 the two multipliers are real, and it is no bifurcation.
        """
        derivative = self.shooting(point.unknowns).map_derivative(point.unknowns[:_Y])
        return float(np.trace(derivative) - np.linalg.det(derivative)) / 2

    def at(self, guess: Array) -> Point:
        """The point of the line at the y of a guess, (6,). Raises NotDone."""
        return self.curve.solve(guess, np.eye(6)[_Y])

    def _vanishing(self, unknowns: Array) -> float:
        return vanishing(self.type, self.shooting(unknowns).map_derivative(unknowns[:_Y]))

    def __call__(self, unknowns: Array) -> tuple[Array, Array]:
        """The residual, (5,), and its Jacobian, (5, 6).

        Raises NotDone as Shooting does.
        """
        if not unknowns[_X:].min() > 0.0:
            raise NotDone("a line left the plane", "follow it where both constants are above 0")
        residual, by_x = self.shooting(unknowns)(unknowns[:_Y])
        _, by_y = self.shooting(unknowns, axis=1)(np.append(unknowns[:_X], unknowns[_Y]))
        here = self._vanishing(unknowns)
        slopes = [
            (self._vanishing(unknowns + step) - here) / step.max()
            for step in np.diag(_DIFFERENCE * self.scales)
        ]
        return (
            np.append(residual, here),
            np.vstack([np.column_stack([by_x, by_y[:, _X]]), slopes]),
        )


def trace(line: CycleLine, first: Point, window: Window) -> Traced:
    """Follow a line to its end, or to the edge of a window.

    Args:
        line: The line.
        first: Where to begin, and in which direction.
        window: The window.

    Returns:
        The line.
    """
    curve, finer = line.curve, replace(line, fineness=_FINER * line.fineness).curve
    points: list[Point] = []
    specials: list[Special] = []
    try:
        for point in curve.follow(first, _SHORTEST_STEP, _LONGEST_STEP, cubic=True):
            if not points:
                points.append(point)
                continue
            before = points[-1]
            if ended := _ended(line, before, point, window):
                end, vanishes = ended
                if end != "Hopf line":
                    points.append(curve.locate(before, point, vanishes))
                return Traced(points, specials, end)
            for type_, vanishes in _marks(line, before).items():
                if vanishes(before) * vanishes(point) < 0.0:
                    there, again = (one.locate(before, point, vanishes) for one in (curve, finer))
                    off = np.abs(again.unknowns[_X:] / there.unknowns[_X:] - 1).max()
                    specials.append(Special(type_, there, float(off)))
            points.append(point)
            if len(points) == _MOST_POINTS:
                return Traced(points, specials, "long")
    except NotDone:
        pass
    return Traced(points, specials, _lost(line, points[-1].unknowns))


def _lost(line: CycleLine, unknowns: Array) -> LineEnd:
    """Where a line ends that is lost after a cycle, (6,)."""
    amplitude = abs(unknowns[2]) * unknowns[3] / pi
    if line.family is FORTH_AND_BACK and amplitude < _SMALL:
        return "Hopf line"
    return "merging" if _growths(line, unknowns) > _LONG else "lost"


def _marks(line: CycleLine, before: Point) -> dict[Mark, Callable[[Point], float]]:
    """The function that vanishes at each special point behind this one."""

    def forward(point: Point) -> float:
        return float(point.tangent[_X:] @ before.tangent[_X:])

    found: dict[Mark, Callable[[Point], float]] = {
        "crosses Hopf": lambda point: above_hopf(line.wheel_at(point.unknowns))
    }
    if line.type == FOLD:
        found["cusp"] = forward
    if line.type == NEIMARK_SACKER:
        found["resonance 1:3"] = lambda point: line.cosine(point) + 0.5
        found["resonance 1:4"] = line.cosine
    return found


def _growths(line: CycleLine, unknowns: Array) -> float:
    """How many times of the saddle's growth a cycle, (6,), takes from crossing to crossing."""
    left = saddle(line.wheel_at(unknowns))
    assert left is not None  # there is no dry friction
    return float(unknowns[3] * left.eigenvalues[0].real) / line.family.crossings


def joined(line: CycleLine, unknowns: Array) -> bool:
    """Whether a line is too close to the merging line, at a cycle, (6,), to be followed."""
    return _growths(line, unknowns) > _LONGEST


def _ended(
    line: CycleLine, before: Point, point: Point, window: Window
) -> tuple[LineEnd, Callable[[Point], float]] | None:
    """Why the line ends between two points, and the function that vanishes there; None if not."""
    ends: list[tuple[LineEnd, Callable[[Point], float]]] = [
        ("range", lambda point: point.unknowns[_Y] / window.y_from - 1.0),
        ("range", lambda point: 1.0 - point.unknowns[_Y] / window.y_to),
        ("range", lambda point: point.unknowns[_X] / window.x_from - 1.0),
        ("range", lambda point: 1.0 - point.unknowns[_X] / window.x_to),
        ("merging", lambda point: _LONGEST - _growths(line, point.unknowns)),
    ]
    if line.family is FORTH_AND_BACK:
        sign = np.sign(before.unknowns[2])
        ends.append(("Hopf line", lambda point: float(sign * point.unknowns[2])))
    if line.type == NEIMARK_SACKER:
        ends.append(("resonance 1:1", lambda point: 1.0 - line.cosine(point)))
        ends.append(("resonance 1:2", lambda point: 1.0 + line.cosine(point)))
    for end, left in ends:
        if left(point) <= 0.0 < left(before):
            return end, left
    return None
