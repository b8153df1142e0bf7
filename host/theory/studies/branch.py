"""The study `branch`: fixpoints, forth-and-back cycles (FB) and rotations (LLM) in one constant of the wheel (M5, M6, M9).

With dry friction only rotations are followed, while the wheel goes forward all the time: a wheel
that stops is held, and no longer smooth. Backward rotations are the mirror image of those forward,
the other forth-and-back cycles those around phi = 0, turned.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from host.errors import NotDone
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.branches import (
    FIELDS,
    Branch,
    hopf_values,
    rotation,
    rotations,
    swings,
    turned,
    with_constant,
)
from host.theory.analysis.cycles import ROTATION, Shooting
from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.analysis.merging import NEAR, Merging, merging_line, mergings, neutral_tau_s
from host.theory.engine.flow import FINENESS
from host.theory.model.turning import constant_velocity, driven, potentials
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, wheel_of
from host.theory.studies.branch_cycles import branch_rows, checks, pairs
from host.theory.studies.branch_report import findings

# The constant is followed from this part of the end's value on.
_SPAN = 1e-3
# The paper's k of locomotion: beside a portrait, and of the robot.
SHOWN_K = (1.85, 8.0)
_FIXPOINTS, _TAUS, _ANGLES = 121, 25, 73


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """A branch each, the global bifurcation, its line over tau, and the turning wheel."""
    parts = [
        "fixpoints",
        "merging",
        "FB",
        "LLM",
        *(["dry"] if options["dry"] > 0.0 else []),
        "line",
        "turning",
    ]
    return [{"part": part} for part in parts]


def span(options: dict[str, Any]) -> tuple[str, float, float]:
    """The field of Wheel that is followed, and from where to where."""
    field = FIELDS[options["along"]]
    high = options["to"] or (20.0 if field == "k" else 12.0 * getattr(wheel_of(options), field))
    return field, _SPAN * high, high


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The rows of a part; `kind` tells them apart.

    Fixpoint, cycle, special (a bifurcation), end, check (by time stepping), and others.
    """
    options, part = setting.options, cell["part"]
    wheel, along = wheel_of(options), span(options)
    if part == "line":
        return _line(wheel)
    if part == "turning":
        return [
            row
            for k in (SHOWN_K if options["k"] is None else (wheel.k,))
            for row in _turning(wheel._replace(k=k))
        ]
    if part == "fixpoints":
        return [*_fixpoints(wheel, *along), *_hopf_rows(wheel, *along)]
    if part == "FB":
        return _cycles(swings, wheel, along)
    if part == "dry":
        wheel = wheel._replace(dry_friction=options["dry"])
    return [
        *(_merging_rows(wheel, *along) if part != "LLM" else []),
        *(_cycles(rotations, wheel, along) if part != "merging" else []),
    ]


def _fixpoints(wheel: Wheel, field: str, low: float, high: float) -> list[Row]:
    rows = []
    for value in np.geomspace(low, high, _FIXPOINTS).tolist():
        there = with_constant(wheel, field, value)
        for phi in (0.0, pi / 4):
            found = fixpoint(phi, there)
            row = {
                "kind": "fixpoint",
                "value": value,
                "phi": phi,
                "stable": found.stable,
                "eigenvalues": pairs(found.eigenvalues),
            }
            rows.append({**row, "formula": constant_velocity(there)})
    return rows


def _hopf_rows(wheel: Wheel, field: str, low: float, high: float) -> list[Row]:
    rows = []
    for value in hopf_values(wheel, field, low, high):
        there = with_constant(wheel, field, value)
        found = hopf(there)
        rows.append(
            {
                "kind": "special",
                "type": "hopf",
                "value": value,
                "period": 2 * pi / found.omega,
                "omega_mean": 0.0,
                "amplitude": 0.0,
                "l1": found.l1,
                # Of the cycles of vanishing amplitude.
                "multipliers": pairs(
                    np.exp(2 * pi / found.omega * fixpoint(0.0, there).eigenvalues[1:])
                ),
                "off_by": abs(there.k / found.k - 1),
            }
        )
    return rows


def _merging_rows(wheel: Wheel, field: str, low: float, high: float) -> list[Row]:
    """The mergings; each found again from another begin on the manifold, with shorter steps."""
    rows = []
    for found in mergings(wheel, low, high, field):
        value = getattr(found.wheel, field)
        again = next(
            mergings(
                wheel,
                0.999 * value,
                1.001 * value,
                field,
                points=2,
                near=10 * NEAR,
                fineness=1.5 * FINENESS,
            ),
            None,
        )
        rows.append(
            {
                **_merging_row(found, value),
                "off_by": again and abs(getattr(again.wheel, field) / value - 1),
            }
        )
    return rows


def _merging_row(found: Merging, value: float) -> Row:
    return {
        "kind": "special",
        "type": "merging",
        "value": value,
        "omega_mean": 0.0,
        "multipliers": [],
        "saddle_quantity": found.saddle_quantity,
        "eigenvalues": pairs(found.eigenvalues),
        "passes_above": found.passes_above,
    }


def _cycles(
    find: Callable[..., list[Branch]], wheel: Wheel, along: tuple[str, float, float]
) -> list[Row]:
    try:
        branches = find(wheel, *along)
    except NotDone as lost:
        return [{"kind": "end", "type": "none", "why": str(lost)}]
    return [
        {"way": name, **row}
        for branch in branches
        for name, way in zip(
            ("down", "up") if len(branch.ways) == 2 else (None,), branch.ways, strict=True
        )
        for row in (*branch_rows(way, branch.shooting), *checks(way, branch.shooting))
    ]


def _line(wheel: Wheel) -> list[Row]:
    """The merging over tau, and where its saddle quantity vanishes."""
    rows: list[Row] = [
        {
            "kind": "line",
            "tau": tau_s,
            "k": found.k,
            "k_hopf": hopf(found.wheel).k,
            "saddle_quantity": found.saddle_quantity,
        }
        for tau_s, found in merging_line(wheel, wheel.tau_s * np.geomspace(0.1, 10.0, _TAUS))
    ]
    changes = [
        (row["tau"], then["tau"])
        for row, then in pairwise(rows)
        if (row["saddle_quantity"] < 0) != (then["saddle_quantity"] < 0)
    ]
    return [*rows, *({"kind": "neutral", "tau": neutral_tau_s(wheel, *ends)} for ends in changes)]


def _turning(wheel: Wheel) -> list[Row]:
    """Potentials of a wheel that is turned, by formula and by numbers, beside those of the wheel that rolls by itself, if it does."""
    angles, omega = np.linspace(0.0, 2 * pi, _ANGLES), float(turned(wheel)[OMEGA])
    rolled: Array | None = None
    try:
        own = rotation(wheel, turned(wheel)).unknowns
    except NotDone:
        pass
    else:
        quarter = Shooting(wheel, ROTATION).path(own)[:-1, :, 0]
        forward = ROTATION.back.T[:2, :2]
        rolled = np.hstack(
            [np.linalg.matrix_power(forward, n) @ quarter[:, :2].T for n in range(4)]
        )
        angles, omega = (
            np.concatenate([quarter[:, PHI] + n * pi / 2 for n in range(4)]),
            pi / 2 / float(own[3]),
        )
    exact, numeric = (
        np.array(potentials(angles, omega, wheel.tau_s)),
        driven(angles, omega, wheel.tau_s),
    )
    rows = []
    for i, phi in enumerate(angles.tolist()):
        row = {"kind": "turning", "k": wheel.k, "omega_mean": omega, "phi": phi}
        for j, name in enumerate(("x1", "x2")):
            row |= {name: float(exact[j, i]), f"{name}_numeric": float(numeric[j, i])}
            row[f"{name}_rolling"] = None if rolled is None else float(rolled[j, i])
        rows.append(row)
    return rows


def report(rows: list[Row], setting: Setting) -> Findings:
    """M5, M6 and M9."""
    return findings(rows, setting)
