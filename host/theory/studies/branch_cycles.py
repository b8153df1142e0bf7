"""Cycles in numbers: rows of a table for a curve of them, and for some of them what a run of the equations says instead."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from host.runs.contract import Row
from host.theory.analysis.bifurcations import Followed
from host.theory.analysis.continuation import Point
from host.theory.analysis.cycles import Shooting
from host.theory.engine.ensemble import averages
from host.theory.model.turning import constant_velocity
from host.theory.model.wheel import OMEGA, PHI

# A disturbance is given until it has died out so far.
_DIED = 1e-11
_CHECKED = 6


def pairs(numbers: Any) -> list[list[float]]:
    """Complex numbers as (real, imaginary), which survive JSON."""
    return [[float(z.real), float(z.imag)] for z in np.asarray(numbers, dtype=complex)]


def cycle_row(shooting: Shooting, point: Point) -> Row:
    """A cycle in numbers: period (s), omega (rad/s), amplitude of phi (rad), multipliers of the reduced map and of the whole period."""
    unknowns, family = point.unknowns, shooting.family
    path = shooting.path(unknowns)[:, :, 0]
    omega, times = path[:, OMEGA], np.linspace(0.0, unknowns[3], len(path))
    mean = family.turn / unknowns[3]
    swing = CubicHermiteSpline(times, path[:, PHI], omega)
    turns = [t for t in swing.derivative().roots(extrapolate=False) if 0.0 <= t <= unknowns[3]]
    reduced = shooting.multipliers(unknowns)
    return {
        "value": float(unknowns[4]),
        "x1": float(unknowns[0]),
        "x2": float(unknowns[1]),
        "omega": float(unknowns[2]),
        "period": float(family.power * unknowns[3]),
        "omega_mean": float(mean),
        # The trapezoidal rule over a period is exact to the order of rounding.
        "omega_std": float(np.sqrt(max(0.0, np.mean(omega[:-1] ** 2) - mean**2))),
        "omega_min": float(omega.min() if family.turn else -np.abs(omega).max()),
        "omega_max": float(np.abs(omega).max()),
        "formula": constant_velocity(shooting.wheel_at(unknowns)),
        "amplitude": float(np.abs(swing(turns)).max()) if turns and not family.turn else None,
        "stable": bool(np.abs(reduced[0]) < 1.0),
        "reduced_multipliers": pairs(reduced),
        "multipliers": pairs(reduced**family.power),
        "off_by": shooting.product_off_by(unknowns),
    }


def branch_rows(followed: Followed, shooting: Shooting) -> list[Row]:
    """The cycles in their order, each bifurcation between its neighbours, and the end."""
    before: dict[int, list[Row]] = {special.before: [] for special in followed.specials}
    for special in followed.specials:
        found = {
            "kind": "special",
            "type": special.type,
            **cycle_row(shooting, special.point),
            "off_by": special.off_by,
        }
        before[special.before].append(found)
    rows = []
    for index, point in enumerate(followed.points):
        rows += before.get(index, [])
        rows.append({"kind": "cycle", **cycle_row(shooting, point)})
    return [
        *rows,
        {
            "kind": "end",
            "type": followed.end,
            "value": rows[-1]["value"],
            "period": rows[-1]["period"],
        },
    ]


def checks(followed: Followed, shooting: Shooting) -> list[Row]:
    """Stable cycles against time stepping.

    A wheel that begins 5 % off, after the disturbance has died out.
    """
    rows = [cycle_row(shooting, point) for point in followed.points]
    stable = [
        index
        for index, row in enumerate(rows)
        if row["stable"] and 0.01 < abs(complex(*row["multipliers"][0])) < 0.9
    ]
    found = []
    for index in (
        [stable[i] for i in np.linspace(0, len(stable) - 1, _CHECKED + 1).astype(int)[1:]]
        if stable
        else []
    ):
        row = rows[index]
        start = np.array([row["x1"], row["x2"], 0.0, row["omega"]]) * 1.05
        periods = np.ceil(np.log(_DIED) / np.log(abs(complex(*row["multipliers"][0]))))
        wheel = shooting.wheel_at(followed.points[index].unknowns)
        stepped = averages(
            start[:, None], wheel.columns(1), periods * row["period"], 10 * row["period"]
        )
        kept = {name: row[name] for name in ("value", "period", "omega_mean", "omega_std")}
        mean, std = float(stepped.omega_mean[0]), float(stepped.omega_std[0])
        off_by = max(abs(mean - row["omega_mean"]), abs(std - row["omega_std"]))
        found.append(
            {"kind": "check", **kept, "stepped_mean": mean, "stepped_std": std, "off_by": off_by}
        )
    return found
