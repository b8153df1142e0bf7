"""What the phase diagram shows: shares of the phases, hysteresis, accuracy, and the claim M7."""

from __future__ import annotations

from collections import Counter
from typing import NotRequired, TypedDict

import numpy as np

from host.runs.answers import Answer
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Setting
from host.theory.analysis.deciding import STILL
from host.theory.analysis.hopf import critical_k, estimate
from host.theory.analysis.phases import PHASES
from host.theory.model.wheel import Wheel, wheel_of
from host.theory.studies.phase_diagram_rows import (
    PANELS,
    PhaseDiagramRow,
    PointRow,
    StepCheckRow,
    Way,
    of_panel,
    points,
    step_checks,
)
from host.theory.studies.registry import PAPER

# Close to the line, decay takes longer than the transient: this share may be on the wrong side.
MISJUDGED = 0.01


class Constants(TypedDict):
    """The constants of all wheels, by the paper's letters; bounded is None without a bound."""

    a: float
    f: float
    I: float  # noqa: E741
    rods: int
    bounded: float | None


class Accuracy(TypedDict):
    """By how much averages change with finer steps (rad/s), at points that are not chaotic."""

    points: int
    median_rad_s: float | None
    p90_rad_s: float | None
    share_not_reproduced: float | None


class Numbers(TypedDict):
    """All numbers of the study.

    Attributes:
        constants: of all wheels.
        shares: shares of the phases, by panel and way, as in "plane, up".
        rest_misjudged: the share of points at which each line misjudges rest, by panel and way;
            empty for one rod, which can rest at 0° and 180° for all k.
        accuracy: of the averages.
        hysteresis: the shares of points that are in other phases up than down, by panel.
    """

    constants: Constants
    shares: dict[str, dict[str, float]]
    rest_misjudged: dict[str, dict[str, float]]
    accuracy: Accuracy
    hysteresis: NotRequired[dict[str, dict[str, float]]]


def report(rows: list[PhaseDiagramRow], setting: Setting) -> Findings:
    """M7."""
    options = setting.options
    wheel = wheel_of(options)
    diagram = points(rows)
    ways: tuple[Way, ...] = ("up", "down") if options["start"] == "sweep" else (options["start"],)
    numbers: Numbers = {
        "constants": {
            "a": options["a"],
            "f": options["f"],
            "I": options["I"],
            "rods": options["rods"],
            "bounded": options["bounded"],
        },
        "shares": {},
        "rest_misjudged": {},
        "accuracy": _accuracy(step_checks(rows)),
    }
    for panel in PANELS:
        for way in ways:
            own = of_panel(diagram, panel, way)
            counts = Counter(row["phase"] for row in own)
            numbers["shares"][f"{panel}, {way}"] = {
                name: counts[name] / len(own) for name in PHASES
            }
            if wheel.rods == 2:
                numbers["rest_misjudged"][f"{panel}, {way}"] = _misjudged(own, wheel)
    if options["start"] == "sweep":
        numbers["hysteresis"] = {panel: _hysteresis(of_panel(diagram, panel)) for panel in PANELS}
    constants = {name: value for name, value in PAPER.items() if name in options}
    foreign = setting.elsewhere(**constants, k_to=20.0, tau_to=1.5, start="sweep")
    coarse = setting.short_of(points=200, transient=100.0, seconds=100.0)
    answers = [
        Answer(f"{name} in the {where}", 100 * share, None, "%")
        for where, shares in numbers["shares"].items()
        for name, share in shares.items()
        if share or name != "undecided"
    ]
    claim = _claim(numbers, ways[0]).doubted(foreign, coarse)
    return Findings([claim], numbers, answers=answers)


def _misjudged(rows: list[PointRow], wheel: Wheel) -> dict[str, float]:
    """The share of points at which a wheel rests above the line or moves below it."""
    by_hopf, by_estimate = 0, 0
    for row in rows:
        there = wheel._replace(tau=row["tau"])
        rests = row["phase"] == "S"
        by_hopf += (row["k"] < critical_k(there)) != rests
        by_estimate += (row["k"] < estimate(there)) != rests
    return {
        "by the Hopf line": by_hopf / len(rows),
        "by 2 f / (a tau)": by_estimate / len(rows),
    }


def _accuracy(sample: list[StepCheckRow]) -> Accuracy:
    """By how much averages change with finer steps.

    Chaotic wheels are left out, as they never repeat, and those that have not settled.
    """
    changes = np.array(
        [
            max(row["mean_off_by"], row["std_off_by"])
            for row in sample
            if row["phase"] in ("S", "FB", "LLM")
        ]
    )
    regular = len(changes) > 0
    return {
        "points": len(changes),
        "median_rad_s": float(np.median(changes)) if regular else None,
        "p90_rad_s": float(np.quantile(changes, 0.9)) if regular else None,
        "share_not_reproduced": float(np.mean(changes > STILL)) if regular else None,
    }


def _hysteresis(rows: list[PointRow]) -> dict[str, float]:
    """The share of points that are in one phase with k going up and in another with k going down.

    By the names of the two phases.
    """
    phases: dict[tuple[float, float], dict[Way, str]] = {}
    for row in rows:
        phases.setdefault((row["tau"], row["k"]), {})[row["way"]] = row["phase"]
    changes = Counter(
        f"{found['up']} up, {found['down']} down"
        for found in phases.values()
        if found["up"] != found["down"]
    )
    return {name: count / len(phases) for name, count in sorted(changes.items())}


def _claim(numbers: Numbers, way: Way) -> Claim:
    shares, misjudged = numbers["shares"], numbers["rest_misjudged"].get(f"inset, {way}")
    expected = {"plane": ("S", "FB", "LLM", "C"), "inset": ("S", "FB", "LLM")}
    missing = [
        f"{name} in the {panel}"
        for panel, names in expected.items()
        for name in names
        if not shares[f"{panel}, {way}"][name]
    ]
    by_hopf, lines = None, "one rod can rest at 0° and 180° for all k"
    if misjudged:
        by_hopf = misjudged["by the Hopf line"]
        lines = (
            "the share of the inset's points that the exact Hopf line misjudges, as resting or not;"
            f" k tau = 2 f / a misjudges {misjudged['by 2 f / (a tau)']:.2%}"
        )
    not_found = f"not found: {', '.join(missing)}; " if missing else ""
    in_plane = ", ".join(f"{share:.1%} {name}" for name, share in shares[f"plane, {way}"].items())
    return Claim(
        "M7",
        SENTENCES["M7"],
        "std(omega), |mean(omega)|, the inset, the numeric and the analytic line",
        by_hopf,
        "1",
        None,
        not missing and by_hopf is not None and by_hopf < MISJUDGED,
        f"{lines}; {not_found}of the plane {in_plane}",
    )
