"""Where a resting wheel begins to swing.

The exact line in (k, tau), and the paper's estimate beside it.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.fixpoints import ANGLES
from host.theory.analysis.hopf import adaptive_friction, by_eigenvalues, estimate, hopf, line
from host.theory.model.wheel import wheel_of
from host.theory.studies.registry import PAPER

# The line is drawn over time constants from a hundredth to a hundred times the wheel's.
LINE = 101
# f tau / I at which the estimate, meant for f tau much smaller than I, is held against the exact k.
LIMIT = 0.01


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """The point, the line through it, and the limit for which the estimate is made.

    Raises WrongUse as `hopf` does.
    """
    hopf(wheel_of(options))
    return [{"part": "point"}, {"part": "line"}, {"part": "limit"}]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """k, frequency and coefficient of the bifurcation; at the point, also by eigenvalues."""
    wheel = wheel_of(setting.options)
    parts: dict[str, Any] = {
        "point": wheel.tau_s,
        "line": wheel.tau_s * np.geomspace(0.01, 100.0, LINE),
        "limit": LIMIT * wheel.inertia / wheel.friction,
    }
    taus_s = np.atleast_1d(parts[cell["part"]])
    rows = []
    for tau_s, found in line(wheel, taus_s):
        here = wheel._replace(tau_s=tau_s)
        rows.append(
            {
                "tau": tau_s,
                "k_hopf": found.k,
                "omega_hopf": found.omega,
                "l1": found.l1,
                "k_estimate": estimate(here),
            }
        )
        if cell["part"] == "point":
            rows[-1]["k_by_eigenvalues"] = by_eigenvalues(here)
    return rows


def report(rows: list[Row], setting: Setting) -> Findings:
    """M3."""
    point = next(row for row in rows if row["part"] == "point")
    wheel = wheel_of(setting.options)
    through = [row for row in rows if row["part"] == "line"]
    ratio = point["k_estimate"] / point["k_hopf"]
    slow = wheel.friction * wheel.tau_s / wheel.inertia
    small = next(row for row in rows if row["part"] == "limit")
    changes = [
        row["tau"] for row, after in pairwise(through) if (row["l1"] < 0) != (after["l1"] < 0)
    ]
    off = abs(point["k_by_eigenvalues"] / point["k_hopf"] - 1)
    numbers = {
        "k_hopf": point["k_hopf"],
        "omega_hopf": point["omega_hopf"],
        "l1": point["l1"],
        "k_estimate": point["k_estimate"],
        "supercritical": point["l1"] < 0,
        "l1_changes_sign_at_tau": changes,
        "gamma_at_hopf": {
            f"{angle:.4f}": adaptive_friction(angle, wheel._replace(k=point["k_hopf"]))
            for angle in ANGLES[:2]
        },
        "accuracy": {"closed_form_against_eigenvalues": off},
    }
    claim = Claim(
        "M3",
        "a resting wheel becomes unstable at about k_c = 2 f / (a tau)",
        "the line, beside the numerically exact Hopf line",
        ratio,
        "k_c / exact",
        None,
        abs(small["k_estimate"] / small["k_hopf"] - 1) < 2 * LIMIT,
        f"at tau = {wheel.tau_s:g} s the exact k is {point['k_hopf']:.4f}, the estimate"
        f" {point['k_estimate']:.4f}: it is the limit of f tau << I, and f tau / I is {slow:.2g}"
        f" here; at f tau / I = {LIMIT:g} the ratio is {small['k_estimate'] / small['k_hopf']:.3f};"
        f" cycles are born {'' if point['l1'] < 0 else 'un'}stable (l1 = {point['l1']:.3g})",
    )
    return Findings([claim.doubted(setting.elsewhere(**PAPER))], numbers)
