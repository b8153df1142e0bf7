"""Cycles in numbers: rows for the cycles of a branch, and some of them against time stepping."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from host.errors import NotDone
from host.theory.analysis.bifurcations import Followed
from host.theory.analysis.branches import Branch
from host.theory.analysis.continuation import Point
from host.theory.analysis.cycles import Shooting
from host.theory.engine.ensemble import averages
from host.theory.model.turning import constant_velocity
from host.theory.model.wheel import OMEGA, PHI, Wheel
from host.theory.studies.branch_formula import NEAR
from host.theory.studies.branch_rows import (
    BranchEnd,
    Cycle,
    CycleColumns,
    CycleMeasured,
    CyclePoint,
    FormulaEdge,
    SteppedCycle,
    Way,
    pairs,
)

# A disturbance is followed until it has died out to this part of its size.
_DIED = 1e-11
# Cycles of a branch that are compared with time stepping, and how far off (relative) they start.
_CHECKED, _OFF = 6, 0.05
# Only cycles with a leading multiplier between these attract fast enough, and not at once.
_FASTEST, _SLOWEST = 0.01, 0.9


def rows_of_branches(
    find: Callable[[Wheel, str, float, float], list[Branch]],
    wheel: Wheel,
    field: str,
    low: float,
    high: float,
) -> list[CycleMeasured]:
    """The rows of the branches that `find` finds; one that says why there is none."""
    try:
        branches = find(wheel, field, low, high)
    except NotDone as lost:
        return [{"kind": "end", "type": "none", "why": str(lost)}]
    rows: list[CycleMeasured] = []
    for branch in branches:
        ways: tuple[Way, ...] = ("down", "up") if len(branch.ways) == 2 else (None,)
        for way, followed in zip(ways, branch.ways, strict=True):
            rows += branch_rows(way, followed, branch.shooting)
            rows += _formula_edges(way, followed, branch)
            rows += stepped_rows(way, followed, branch.shooting)
    return rows


def cycle_columns(shooting: Shooting, point: Point) -> CycleColumns:
    """A cycle in numbers."""
    unknowns, family = point.unknowns, shooting.family
    path = shooting.path(unknowns)[:, :, 0]
    omega, times = path[:, OMEGA], np.linspace(0.0, unknowns[3], len(path))
    mean = family.turn / unknowns[3]
    # The trapezoidal rule over a period is exact to the order of rounding.
    variance = np.mean(omega[:-1] ** 2) - mean**2
    amplitude = None
    if not family.turn:
        swing = CubicHermiteSpline(times, path[:, PHI], omega)
        turns = [t for t in swing.derivative().roots(extrapolate=False) if 0.0 <= t <= unknowns[3]]
        amplitude = float(np.abs(swing(turns)).max()) if turns else None
    reduced = shooting.multipliers(unknowns)
    return {
        "value": float(unknowns[4]),
        "x1": float(unknowns[0]),
        "x2": float(unknowns[1]),
        "omega": float(unknowns[2]),
        "period": float(family.power * unknowns[3]),
        "omega_mean": float(mean),
        "omega_std": float(np.sqrt(max(0.0, variance))),
        "omega_min": float(omega.min() if family.turn else -np.abs(omega).max()),
        "omega_max": float(np.abs(omega).max()),
        "formula": constant_velocity(shooting.wheel_at(unknowns)),
        "amplitude": amplitude,
        "stable": bool(np.abs(reduced[0]) < 1.0),
        "reduced_multipliers": pairs(reduced),
        "multipliers": pairs(reduced**family.power),
        "off_by": shooting.product_off_by(unknowns),
    }


def branch_rows(
    way: Way, followed: Followed, shooting: Shooting
) -> list[Cycle | CyclePoint | BranchEnd]:
    """The cycles in their order, each bifurcation between its neighbours, and the end."""
    found: dict[int, list[CyclePoint]] = {}
    for one in followed.bifurcations:
        columns = cycle_columns(shooting, one.point)
        columns["off_by"] = one.off_by
        point_row: CyclePoint = {"way": way, "kind": "special", "type": one.type, **columns}
        found.setdefault(one.before, []).append(point_row)
    rows: list[Cycle | CyclePoint | BranchEnd] = []
    for index, point in enumerate(followed.points):
        rows += found.get(index, [])
        last: Cycle = {"way": way, "kind": "cycle", **cycle_columns(shooting, point)}
        rows.append(last)
    end: BranchEnd = {
        "way": way,
        "kind": "end",
        "type": followed.end,
        "value": last["value"],
        "period": last["period"],
    }
    return [*rows, end]


def _formula_edges(way: Way, followed: Followed, branch: Branch) -> list[FormulaEdge]:
    """Where the constant-velocity formula begins and ceases to be NEAR the mean speed."""
    turn = branch.shooting.family.turn
    if not turn:
        return []

    def beyond(point: Point) -> float:
        formula = constant_velocity(branch.shooting.wheel_at(point.unknowns)) or 0.0
        return abs(formula * float(point.unknowns[3]) / turn - 1) - NEAR

    edges = [branch.curve.between(*points, beyond) for points in pairwise(followed.points)]
    return [
        {"way": way, "kind": "edge", "value": float(edge.unknowns[4])} for edge in edges if edge
    ]


def stepped_rows(way: Way, followed: Followed, shooting: Shooting) -> list[SteppedCycle]:
    """Some stable cycles against time stepping.

    A wheel starts beside the cycle and is followed until the disturbance has died out.
    """
    cycles = [(point, cycle_columns(shooting, point)) for point in followed.points]
    stable = [
        (point, columns)
        for point, columns in cycles
        if columns["stable"] and _FASTEST < _leading(columns) < _SLOWEST
    ]
    if not stable:
        return []
    chosen = np.linspace(0, len(stable) - 1, _CHECKED + 1).astype(int)[1:]
    return [_stepped(way, stable[index][0], stable[index][1], shooting) for index in chosen]


def _leading(columns: CycleColumns) -> float:
    """The modulus of the leading multiplier."""
    return abs(complex(*columns["multipliers"][0]))


def _stepped(way: Way, point: Point, columns: CycleColumns, shooting: Shooting) -> SteppedCycle:
    wheel = shooting.wheel_at(point.unknowns)
    start = np.array([columns["x1"], columns["x2"], 0.0, columns["omega"]]) * (1 + _OFF)
    periods = np.ceil(np.log(_DIED) / np.log(_leading(columns)))
    period_s = columns["period"]
    stepped = averages(start[:, None], wheel.columns(1), periods * period_s, 10 * period_s)
    mean, std = float(stepped.omega_mean[0]), float(stepped.omega_std[0])
    return {
        "way": way,
        "kind": "check",
        "value": columns["value"],
        "period": period_s,
        "omega_mean": columns["omega_mean"],
        "omega_std": columns["omega_std"],
        "stepped_mean": mean,
        "stepped_std": std,
        "off_by": max(abs(mean - columns["omega_mean"]), abs(std - columns["omega_std"])),
    }
