"""The study `portrait`: portraits of a wheel in (phi, nu = omega / 2 pi).

Fixpoints, manifolds of the saddles, limit cycles and trajectories (M4). The flow has four
dimensions: trajectories, cycles and the unstable manifolds are curves, drawn in projection. Of the
stable manifolds, which have three dimensions, the portrait shows a cut (see
host.theory.analysis.manifolds): on either side of that line a wheel ends on another attractor.
"""

from __future__ import annotations

from math import pi
from typing import Any, TypedDict

import numpy as np

from host.runs.answers import Answer
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Setting
from host.theory.analysis.fixpoints import fixpoint, fixpoints
from host.theory.analysis.hopf import critical_k
from host.theory.analysis.manifolds import stable_manifolds, unstable_manifolds
from host.theory.analysis.phases import Phase
from host.theory.analysis.trajectories import limit_cycle, phase_of_cycle, trajectory
from host.theory.engine.flow import FINENESS, steps_for
from host.theory.model.laws import require_friction
from host.theory.model.turning import turning
from host.theory.model.wheel import OMEGA, PHI, Array, wheel_of
from host.theory.studies.portrait_rows import (
    LinePart,
    Point,
    PortraitCell,
    PortraitRow,
    Summary,
    SummaryRow,
    summaries,
)
from host.theory.studies.registry import PAPER
from host.theory.studies.variants import require_two_rods

_NAMES: dict[Phase, str] = {
    "S": "S, at rest",
    "FB": "FB, forth and back",
    "LLM": "LLM, rolling",
    "C": "C, irregular",
}
PAPERS_K: dict[float, Phase] = {1.4: "S", 1.65: "FB", 1.85: "LLM"}
# How long trajectories and unstable manifolds are followed, s.
FOLLOWED_S = 14.0
# The saddle whose unstable manifolds are drawn, and the next one forward.
SADDLE, NEXT_SADDLE = -pi / 4, pi / 4
# Where the trajectories start: angles (rad), and speeds as parts of the greatest speed shown.
TRAJECTORIES = (
    (-3.0, 0.9),
    (3.0, -0.9),
    (-1.3, 0.6),
    (1.3, -0.6),
    (0.1, 0.05),
    (1.7, 0.1),
    (-1.5, -0.1),
)
# The unstable manifolds are computed again with steps shorter by this.
FINER = 2.0
# The greatest speed shown, in units of the unstable manifolds' greatest speed.
REACH = 2.5


def cells(options: dict[str, Any], *, batch: bool = True) -> list[PortraitCell]:
    """One portrait each.

    Raises WrongUse if the wheel can rest at any angle, never settles, or is too stiff to be
    followed.
    """
    require_two_rods(options)
    require_friction(wheel_of(options))
    ks = PAPERS_K if options["k"] is None else (options["k"],)
    for k in ks:
        wheel = wheel_of(options)._replace(k=k)
        fixpoint(0.0, wheel)
        steps_for(FOLLOWED_S, wheel, FINER * FINENESS)
    return [{"k": k} for k in ks]


def simulate(cell: PortraitCell, setting: Setting) -> list[Point | Summary]:
    """The points of a portrait, and its summary."""
    wheel = wheel_of(setting.options)._replace(k=cell["k"])
    rows: list[Point | Summary] = [
        {"part": point.kind, "line": n, "phi": point.phi, "omega": 0.0}
        for n, point in enumerate(fixpoints(wheel))
    ]
    unstable = unstable_manifolds(SADDLE, wheel, FOLLOWED_S)
    finer = unstable_manifolds(SADDLE, wheel, FOLLOWED_S, fineness=FINER * FINENESS)
    off = float(np.abs(unstable - finer)[:, : unstable.shape[1] // 2, PHI].max())
    for line, states in enumerate(unstable):
        rows += _points("unstable manifold", line, states[:, [PHI, OMEGA]])
    fastest = REACH * float(np.abs(unstable[:, :, OMEGA]).max())
    cycle = limit_cycle(wheel)
    if cycle is not None:  # basins of irregular wheels have no boundaries that could be drawn
        rows += _points("limit cycle", 0, cycle[:, [PHI, OMEGA]])
        rows += _points("stable manifold", 0, stable_manifolds(wheel, fastest).T)
    phi, omega = np.array(TRAJECTORIES).T
    for line, state in enumerate(turning(phi, fastest * omega, wheel).T):
        rows += _points("trajectory", line, trajectory(state, wheel, FOLLOWED_S)[:, [PHI, OMEGA]])
    rows.append(
        {
            "part": "found",
            "kind": phase_of_cycle(cycle),
            "fastest": fastest,
            "manifold_off_by": off,
            "crosses": bool(unstable[0, :, PHI].max() > NEXT_SADDLE),
        }
    )
    return rows


def _points(part: LinePart, line: int, points: Array) -> list[Point]:
    """Rows for points (phi, omega), (points, 2)."""
    return [
        {"part": part, "line": line, "phi": phi, "omega": omega} for phi, omega in points.tolist()
    ]


class Portrait(TypedDict):
    """One portrait: its phase, and what the saddle's unstable manifold does."""

    k: float
    phase: Phase
    k_hopf: float
    unstable_manifold_passes_the_next_saddle: bool


class Accuracy(TypedDict):
    """How much the manifold moves with half the step."""

    unstable_manifold_halved_step_rad: float


class Numbers(TypedDict):
    """All numbers of the study."""

    portraits: list[Portrait]
    accuracy: Accuracy


def report(rows: list[PortraitRow], setting: Setting) -> Findings:
    """M4."""
    found = summaries(rows)
    k_hopf = critical_k(wheel_of(setting.options))
    numbers: Numbers = {
        "portraits": [
            {
                "k": row["k"],
                "phase": row["kind"],
                "k_hopf": k_hopf,
                "unstable_manifold_passes_the_next_saddle": row["crosses"],
            }
            for row in found
        ],
        "accuracy": {
            "unstable_manifold_halved_step_rad": max(row["manifold_off_by"] for row in found)
        },
    }
    of_three = "" if len(found) == len(PAPERS_K) else "the claim is made for k = 1.4, 1.65 and 1.85"
    claim = _claim(found, k_hopf).doubted(setting.elsewhere(**PAPER), of_three)
    answers = [Answer("rest is unstable from k", k_hopf)]
    answers += [Answer(f"phase at k = {row['k']:g}", _NAMES[row["kind"]]) for row in found]
    return Findings([claim], numbers, answers=answers)


def _claim(found: list[SummaryRow], k_hopf: float) -> Claim:
    """M4: the paper's phase, by limit cycles and also by eigenvalues and manifolds."""
    agreed = 0
    for row in found:
        expected = _phase_by_manifolds(row, k_hopf)
        agreed += row["kind"] == expected == PAPERS_K.get(row["k"], expected)
    kinds = ", ".join(f"k = {row['k']:g}: {row['kind']}" for row in found)
    manifolds = ", ".join(
        f"{'pass' if row['crosses'] else 'do not pass'} the next saddle at {row['k']:g}"
        for row in found
    )
    return Claim(
        "M4",
        SENTENCES["M4"],
        "the three portraits",
        float(agreed),
        f"of {len(found)} portraits",
        None,
        agreed == len(found),
        f"as in the paper; {kinds}. Rest is unstable from k = {k_hopf:.4f} on; the saddles'"
        f" unstable manifolds {manifolds}",
    )


def _phase_by_manifolds(row: SummaryRow, k_hopf: float) -> Phase:
    """The phase by the Hopf line and the saddle's unstable manifold."""
    if row["k"] < k_hopf:
        return "S"
    return "LLM" if row["crosses"] else "FB"
