"""The study `branch`: fixpoints, cycles and rotations followed in one constant (M5, M6, M9).

Forth-and-back cycles (FB) around phi = 0 and rotations forward (LLM); the others follow by
symmetry. With dry friction only rotations are followed, as long as the wheel goes forward all the
time: friction holds a wheel that stops, and its equations are no longer smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from host.errors import NotDone
from host.runs.contract import Setting
from host.theory.analysis.branches import (
    hopf_values,
    rotation,
    rotations,
    swings,
    turning_state,
    with_constant,
)
from host.theory.analysis.cycles import ROTATION, Shooting
from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.analysis.merging import NEAR, merging_line, mergings, neutral_tau_s
from host.theory.engine.flow import FINENESS, steps_for
from host.theory.model.turning import constant_velocity, driven, potentials
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, wheel_of
from host.theory.studies.branch_cycles import rows_of_branches
from host.theory.studies.branch_report import report
from host.theory.studies.branch_rows import (
    BranchCell,
    HopfPoint,
    LinePoint,
    Measured,
    MergingPoint,
    NeutralPoint,
    Part,
    Rest,
    Turned,
    pairs,
)
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

# The constant is followed from this part of its greatest value on.
_SPAN = 1e-3
# The k of locomotion in the paper's portraits, and of its robot.
SHOWN_K = (1.85, 8.0)
_FIXPOINTS, _TAUS, _ANGLES = 121, 25, 73


def cells(options: dict[str, Any], *, batch: bool = True) -> list[BranchCell]:
    """The branches, the merging and its line over tau, and the turning wheel.

    Raises WrongUse if no resting wheel begins to swing, or the wheel cannot be followed.
    """
    require_two_rods(options)
    wheel = wheel_of(options)
    hopf(wheel)
    field, _, high = span(options)
    last = with_constant(wheel, field, high)
    fixpoint(0.0, last)
    steps_for(1.0, last)  # as the search for a rotation takes them
    parts: list[Part] = ["fixpoints", "merging", "FB", "LLM"]
    if options["dry"] > 0.0:
        parts.append("dry")
    parts += ["line", "turning"]
    return [{"part": part} for part in parts]


def span(options: dict[str, Any]) -> tuple[str, float, float]:
    """The field of Wheel that is followed, its least value and its greatest value."""
    field = options["along"]
    high = options["to"] or (20.0 if field == "k" else 12.0 * getattr(wheel_of(options), field))
    return field, _SPAN * high, high


def simulate(cell: BranchCell, setting: Setting) -> Sequence[Measured]:
    """The rows of a part."""
    options = setting.options
    wheel, along = wheel_of(options), span(options)
    match cell["part"]:
        case "fixpoints":
            return [*_rests(wheel, *along), *_hopf_points(wheel, *along)]
        case "merging":
            return _merging_points(wheel, *along)
        case "FB" | "LLM" as family:
            return rows_of_branches(swings if family == "FB" else rotations, wheel, *along)
        case "dry":
            dry = wheel._replace(dry_friction=options["dry"])
            return [*_merging_points(dry, *along), *rows_of_branches(rotations, dry, *along)]
        case "line":
            return _line(wheel)
        case "turning":
            ks = SHOWN_K if options["k"] is None else (wheel.k,)
            return [row for k in ks for row in _turning(wheel._replace(k=k))]


def _rests(wheel: Wheel, field: str, low: float, high: float) -> list[Rest]:
    """The fixpoint at 0 and the saddle at pi/4."""
    rows: list[Rest] = []
    for value in np.geomspace(low, high, _FIXPOINTS).tolist():
        there = with_constant(wheel, field, value)
        for phi in (0.0, pi / 4):
            found = fixpoint(phi, there)
            rows.append(
                {
                    "kind": "fixpoint",
                    "value": value,
                    "phi": phi,
                    "stable": found.stable,
                    "eigenvalues": pairs(found.eigenvalues),
                    "formula": constant_velocity(there),
                }
            )
    return rows


def _hopf_points(wheel: Wheel, field: str, low: float, high: float) -> list[HopfPoint]:
    rows: list[HopfPoint] = []
    for value in hopf_values(wheel, field, low, high):
        there = with_constant(wheel, field, value)
        found = hopf(there)
        period_s = 2 * pi / found.omega
        rows.append(
            {
                "kind": "special",
                "type": "hopf",
                "value": value,
                "period": period_s,
                "omega_mean": 0.0,
                "amplitude": 0.0,
                "l1": found.l1,
                "multipliers": pairs(np.exp(period_s * fixpoint(0.0, there).eigenvalues[1:])),
                "off_by": abs(there.k / found.k - 1),
            }
        )
    return rows


def _merging_points(wheel: Wheel, field: str, low: float, high: float) -> list[MergingPoint]:
    """The mergings, each also with another start on the manifold and shorter steps."""
    rows: list[MergingPoint] = []
    for found in mergings(wheel, low, high, field):
        value = getattr(found.wheel, field)
        low, high = 0.999 * value, 1.001 * value
        near, fineness = 10 * NEAR, 1.5 * FINENESS
        others = mergings(wheel, low, high, field, points=2, near=near, fineness=fineness)
        again = next(others, None)
        rows.append(
            {
                "kind": "special",
                "type": "merging",
                "value": value,
                "omega_mean": 0.0,
                "multipliers": [],
                "saddle_quantity": found.saddle_quantity,
                "eigenvalues": pairs(found.eigenvalues),
                "passes_above": found.passes_above,
                "off_by": abs(getattr(again.wheel, field) / value - 1) if again else None,
            }
        )
    return rows


def _line(wheel: Wheel) -> list[LinePoint | NeutralPoint]:
    """The merging over tau, and where its saddle quantity vanishes."""
    points: list[LinePoint] = [
        {
            "kind": "line",
            "tau": tau_s,
            "k": found.k,
            "k_hopf": hopf(found.wheel).k,
            "saddle_quantity": found.saddle_quantity,
        }
        for tau_s, found in merging_line(wheel, wheel.tau * np.geomspace(0.1, 10.0, _TAUS))
    ]
    neutral: list[NeutralPoint] = [
        {"kind": "neutral", "tau": neutral_tau_s(wheel, one["tau"], next_one["tau"])}
        for one, next_one in pairwise(points)
        if (one["saddle_quantity"] < 0) != (next_one["saddle_quantity"] < 0)
    ]
    return [*points, *neutral]


def _turning(wheel: Wheel) -> list[Turned]:
    """The potentials of a wheel that is turned, by formula and by integration.

    Beside them those of the wheel that rolls by itself, if it does, at its mean speed.
    """
    angles, omega = np.linspace(0.0, 2 * pi, _ANGLES), float(turning_state(wheel)[OMEGA])
    rolled: Array | None = None
    try:
        own = rotation(wheel, turning_state(wheel)).unknowns
    except NotDone:
        pass
    else:
        angles, rolled = _whole_turn(Shooting(wheel, ROTATION).path(own)[:-1, :, 0])
        omega = pi / 2 / float(own[3])
    exact = np.array(potentials(angles, omega, wheel.tau))
    numeric = driven(angles, omega, wheel.tau)
    return [
        {
            "kind": "turning",
            "k": wheel.k,
            "omega_mean": omega,
            "phi": phi,
            "x1": float(exact[0, i]),
            "x1_numeric": float(numeric[0, i]),
            "x1_rolling": None if rolled is None else float(rolled[0, i]),
            "x2": float(exact[1, i]),
            "x2_numeric": float(numeric[1, i]),
            "x2_rolling": None if rolled is None else float(rolled[1, i]),
        }
        for i, phi in enumerate(angles.tolist())
    ]


def _whole_turn(quarter: Array) -> tuple[Array, Array]:
    """Angles, (times,), and potentials, (2, times), of a whole turn from states of a quarter."""
    forward = ROTATION.back.T[:2, :2]
    x = [np.linalg.matrix_power(forward, n) @ quarter[:, :2].T for n in range(4)]
    return np.concatenate([quarter[:, PHI] + n * pi / 2 for n in range(4)]), np.hstack(x)
