"""Cycles of a wheel followed in one of its constants, and their bifurcations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis.fixpoints import NDComplex
from host.theory.model.wheel import Array, Wheel
from host.theory.studies import branch as study
from host.theory.studies.branch_rows import Cycle, CyclePoint, HopfPoint, MergingPoint, Part
from host.theory.studies.registry import TABLE
from host.util.arguments import wrong
from kickctl.theory._values import Result, need_smooth, need_symmetric, need_wheel

_FAMILIES: dict[Part, str] = {"fixpoints": "rest", "merging": "saddles", "FB": "FB", "LLM": "LLM"}


@dataclass(frozen=True, eq=False, repr=False)
class Branch(Result):
    """Cycles along a curve, in their order; all arrays are (cycles,).

    >>> swings = branch(Wheel(), to=5).branches[0]
    >>> swings.family, bool(swings.stable.all()), swings.period[[0, -1]].round(2).tolist()  # s
    ('FB', True, [2.05, 12.91])

    Attributes:
        family: 'FB', forth-and-back cycles around phi = 0, or 'LLM', rotations forward.
        end: why the curve ends: 'merging', 'hopf', 'range', 'lost' or 'long'.
        value: of the constant that is followed, in its unit.
        stable: whether every small disturbance dies out.
        period: s; of a rotation that of a full turn.
        omega_mean: mean of omega, rad/s.
        omega_std: standard deviation of omega, rad/s.
        omega_max: greatest abs(omega), rad/s.
        amplitude: greatest abs(phi), rad; nan for rotations.
        multipliers: Floquet multipliers without the trivial one, (cycles, 3).
    """

    family: str
    end: str
    value: Array
    stable: NDArray[np.bool_]
    period: Array
    omega_mean: Array
    omega_std: Array
    omega_max: Array
    amplitude: Array
    multipliers: NDComplex


@dataclass(frozen=True)
class SpecialPoint:
    """A bifurcation.

    >>> branch(Wheel(), to=5).points[1]
    SpecialPoint(type='merging', family='saddles', value=1.7773..., period=None)

    Attributes:
        type: 'hopf', 'merging', 'fold', 'pitchfork' or 'neimark-sacker'.
        family: 'rest', 'FB', 'LLM', or 'saddles' for a merging (a heteroclinic connection).
        value: of the constant that is followed, in its unit.
        period: of the cycle, s; None for a merging, where it is infinite.
    """

    type: str
    family: str
    value: float
    period: float | None


@dataclass(frozen=True, eq=False, repr=False)
class Branches(Result):
    """What `branch` finds.

    >>> found = branch(Wheel(), to=5)
    >>> found.along, len(found.branches), len(found.points)
    ('k', 3, 2)

    Attributes:
        along: the constant that is followed, by its letter.
        branches: the curves of cycles.
        points: the bifurcations, ascending in value.
    """

    along: str
    branches: tuple[Branch, ...]
    points: tuple[SpecialPoint, ...]


def branch(wheel: Wheel, along: str = "k", to: float | None = None) -> Branches:
    """Follow forth-and-back cycles and rotations in a constant of the wheel. Takes seconds.

    >>> found = branch(Wheel(), to=5)
    >>> for point in found.points:
    ...     print(point.type, point.family, round(point.value, 6))
    hopf rest 1.587277
    merging saddles 1.777312
    >>> [(curve.family, curve.end) for curve in found.branches]
    [('FB', 'merging'), ('LLM', 'merging'), ('LLM', 'range')]

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        along: The constant: 'k', 'tau', 'a', 'f' or 'I'.
        to: The greatest value of the constant, in its unit; by default 20 for k, and twelve times
            the wheel's own value for the others.

    Returns:
        Curves of cycles, stable and unstable, and the bifurcations on them and at rest.

    Raises:
        WrongUse: An argument is none of these, or the wheel cannot be followed.
    """
    wheel = need_wheel(wheel)
    need_smooth(wheel, "branches")
    need_symmetric(wheel, "branches")
    given = {**wheel.options(), "along": along, "to": to, "dry": 0.0}
    options = complete_options("branch", TABLE["branch"], given) | {"own": wheel.own}
    if isinstance(options["to"], list):
        raise wrong("to", to, "one number: the greatest value of the constant")
    study.cells(options)
    setting = Setting(0, options)
    curves: list[Branch] = []
    points: list[SpecialPoint] = []
    cycles: list[Cycle] = []
    for part in _FAMILIES:
        for row in study.simulate({"part": part}, setting):
            if row["kind"] == "cycle":
                cycles.append(row)
            elif row["kind"] == "special":
                points.append(_point(part, row))
            elif row["kind"] == "end" and row["type"] != "none":
                curves.append(_curve(part, row["type"], cycles))
                cycles = []
    return Branches(along, tuple(curves), tuple(sorted(points, key=lambda point: point.value)))


def _point(part: Part, row: HopfPoint | MergingPoint | CyclePoint) -> SpecialPoint:
    period = None if row["type"] == "merging" else row["period"]
    return SpecialPoint(row["type"], _FAMILIES[part], row["value"], period)


def _curve(part: Part, end: str, cycles: list[Cycle]) -> Branch:
    def column(name: str) -> Array:
        return np.array([row[name] for row in cycles], dtype=np.float64)  # type: ignore[literal-required]

    multipliers = [[complex(*pair) for pair in row["multipliers"]] for row in cycles]
    return Branch(
        part,
        end,
        column("value"),
        column("stable") > 0.0,
        column("period"),
        column("omega_mean"),
        column("omega_std"),
        column("omega_max"),
        column("amplitude"),
        np.array(multipliers),
    )
