"""The study `hopf`: the exact line in (k, tau) above which rest is unstable (M3).

The paper's estimate stands beside it.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any, TypedDict

import numpy as np

from host.runs.answers import Answer
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Setting
from host.theory.analysis.fixpoints import ANGLES
from host.theory.analysis.hopf import (
    adaptive_friction,
    bautin_tau_s,
    by_eigenvalues,
    estimate,
    hopf,
)
from host.theory.model.wheel import Wheel, wheel_of
from host.theory.studies.hopf_rows import (
    Bifurcation,
    CheckedBifurcation,
    HopfCell,
    HopfRow,
    limit_of,
    line_of,
    point_of,
)
from host.theory.studies.registry import PAPER

# Points of the line, whose tau goes from a hundredth to a hundred times the wheel's own.
LINE = 101
# The estimate is meant for f tau much smaller than I: here f tau / I is LIMIT.
LIMIT = 0.01


def cells(options: dict[str, Any], *, batch: bool = True) -> list[HopfCell]:
    """The wheel, the line through it, and the limit for which the estimate is made.

    Raises WrongUse if there is no Hopf bifurcation.
    """
    hopf(wheel_of(options))
    return [{"part": "point"}, {"part": "line"}, {"part": "limit"}]


def simulate(cell: HopfCell, setting: Setting) -> list[Bifurcation] | list[CheckedBifurcation]:
    """The bifurcations of one part; for the wheel itself also by eigenvalues."""
    wheel = wheel_of(setting.options)
    if cell["part"] == "point":
        return [_checked_bifurcation(wheel)]
    if cell["part"] == "limit":
        return [_bifurcation(wheel._replace(tau=LIMIT * wheel.I / wheel.f))]
    taus_s = wheel.tau * np.geomspace(0.01, 100.0, LINE)
    return [_bifurcation(wheel._replace(tau=tau_s)) for tau_s in taus_s.tolist()]


def _bifurcation(wheel: Wheel) -> Bifurcation:
    found = hopf(wheel)
    return {
        "tau": wheel.tau,
        "k_hopf": found.k,
        "omega_hopf": found.omega,
        "l1": found.l1,
        "k_estimate": estimate(wheel),
    }


def _checked_bifurcation(wheel: Wheel) -> CheckedBifurcation:
    return {**_bifurcation(wheel), "k_by_eigenvalues": by_eigenvalues(wheel)}


class Accuracy(TypedDict):
    """The relative difference between two ways to k_hopf."""

    closed_form_against_eigenvalues: float


class Numbers(TypedDict):
    """The bifurcation of the wheel itself, and where along tau cycles are born unstable."""

    k_hopf: float
    omega_hopf: float
    l1: float
    k_estimate: float
    supercritical: bool
    l1_changes_sign_at_tau: list[float]
    gamma_at_hopf: dict[str, float]
    accuracy: Accuracy


def report(rows: list[HopfRow], setting: Setting) -> Findings:
    """M3."""
    wheel = wheel_of(setting.options)
    point, through, small = point_of(rows), line_of(rows), limit_of(rows)
    ratio = point["k_estimate"] / point["k_hopf"]
    slow = wheel.f * wheel.tau / wheel.I
    found = [
        bautin_tau_s(wheel, row["tau"], after["tau"])
        for row, after in pairwise(through)
        if (row["l1"] < 0) != (after["l1"] < 0)
    ]
    changes = [tau_s for tau_s in found if tau_s is not None]
    off = abs(point["k_by_eigenvalues"] / point["k_hopf"] - 1)
    numbers: Numbers = {
        "k_hopf": point["k_hopf"],
        "omega_hopf": point["omega_hopf"],
        "l1": point["l1"],
        "k_estimate": point["k_estimate"],
        "supercritical": point["l1"] < 0,
        "l1_changes_sign_at_tau": changes,
        "gamma_at_hopf": {
            f"{angle:.4f}": adaptive_friction(angle, wheel._replace(k=point["k_hopf"]))
            for angle in (ANGLES[:2] if wheel.rods == 2 else ())
        },
        "accuracy": {"closed_form_against_eigenvalues": off},
    }
    claim = Claim(
        "M3",
        SENTENCES["M3"],
        "the line, beside the numerically exact Hopf line",
        ratio,
        "1",
        None,
        abs(small["k_estimate"] / small["k_hopf"] - 1) < 2 * LIMIT,
        f"the ratio of this estimate, {point['k_estimate']:.4f}, to the exact k,"
        f" {point['k_hopf']:.4f}, at tau = {wheel.tau:g} s. The estimate is made for f tau << I:"
        f" here f tau / I = {slow:.2g}, and at {LIMIT:g} the ratio is"
        f" {small['k_estimate'] / small['k_hopf']:.3f}. Limit cycles are born"
        f" {'' if point['l1'] < 0 else 'un'}stable (l1 = {point['l1']:.3g})",
    )
    answers = [
        Answer("Hopf bifurcation at k", point["k_hopf"]),
        Answer("the paper's estimate of k", point["k_estimate"]),
        Answer("wheels swing with", point["omega_hopf"] / (2 * pi), None, "Hz"),
        Answer("cycles are born", "stable" if point["l1"] < 0 else "unstable"),
        Answer("first Lyapunov coefficient l1", point["l1"]),
        *(Answer("l1 changes its sign at tau", tau_s, None, "s") for tau_s in changes),
    ]
    claims = [claim.doubted(setting.elsewhere(**PAPER))]
    return Findings(claims, numbers, answers=answers)
