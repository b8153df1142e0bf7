"""What the branches show: bifurcations, mergings, ends of branches, and how accurate they are."""

from __future__ import annotations

from typing import TypedDict

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.model.wheel import Wheel, wheel_of
from host.theory.studies import branch_tables as tables
from host.theory.studies.branch_formula import (
    Turning,
    claim_m6,
    claim_m9,
    deviations_of,
    near_ranges,
    turning,
)
from host.theory.studies.branch_merging import (
    Coexistence,
    DryNumbers,
    PeriodLaw,
    claim_m5,
    coexistence,
    dry_branch,
    extrapolated,
    period_law,
)
from host.theory.studies.branch_rows import CyclePart, Part
from host.theory.studies.branch_tables import BranchRow, EndRow, MergingRow, SpecialRow
from host.theory.studies.registry import PAPER

# Far above the onset of locomotion, where the constant-velocity formula is claimed.
FAR_K = 20.0
_NAMES: dict[Part, str] = {
    "fixpoints": "rest",
    "FB": "forth and back",
    "LLM": "rotation",
    "merging": "saddles",
    "dry": "rotation with dry friction",
}


class Accuracy(TypedDict):
    """The greatest differences between methods; None where nothing was compared."""

    hopf_closed_form_against_eigenvalues: float | None
    merging_with_other_begin_and_shorter_steps: float | None
    merging_against_extrapolated_branches: dict[CyclePart, float]
    bifurcations_of_cycles_with_shorter_steps: float | None
    cycles_against_time_stepping_rad_per_s: float | None
    product_of_multipliers: float | None


class Numbers(TypedDict):
    """All numbers of the study.

    Special points, ends and errors of the formula name the constant that is followed by itself.
    """

    k_merge: float | None
    special_points: list[dict[str, object]]
    along: str
    mergings: list[float]
    merging_by_extrapolation: dict[CyclePart, float | None]
    period_law: dict[CyclePart, PeriodLaw | None]
    saddle_quantity: float | None
    saddle_quantity_vanishes_at_tau: list[float | None]
    coexistence_with_rotations: Coexistence | None
    period_doublings: str
    formula_within_5_percent: list[list[float]]
    formula_off_by: list[dict[str, float]]
    dry: DryNumbers | None
    turning: list[Turning]
    ends: list[dict[str, object]]
    accuracy: Accuracy


def report(rows: list[BranchRow], setting: Setting) -> Findings:
    """M5, M6 and M9. Bifurcations are listed in the order of the branches."""
    wheel, along = wheel_of(setting.options), setting.options["along"]
    hopfs, mergings = tables.hopfs(rows), tables.mergings(rows, "merging")
    first_hopf = hopfs[0] if hopfs else None
    merging = mergings[0] if mergings else None
    deviations, turned = deviations_of(rows), turning(rows)
    second: dict[CyclePart, float | None] = {}
    laws: dict[CyclePart, PeriodLaw | None] = {}
    if merging:
        second = {
            "FB": extrapolated(rows, "FB", merging),
            "LLM": extrapolated(rows, "LLM", merging),
        }
        laws = {
            "FB": period_law(rows, "FB", merging),
            "LLM": period_law(rows, "LLM", merging),
        }
    both = coexistence(rows, first_hopf, merging) if along == "k" else None
    near = near_ranges(deviations, tables.formula_edges(rows))
    numbers: Numbers = {
        "k_merge": merging["value"] if merging and along == "k" else None,
        "special_points": [
            _special_point(row, along, wheel) for row in tables.special_points(rows)
        ],
        "along": along,
        "mergings": [row["value"] for row in mergings],
        "merging_by_extrapolation": second,
        "period_law": laws,
        "saddle_quantity": merging["saddle_quantity"] if merging else None,
        "saddle_quantity_vanishes_at_tau": [row["tau"] for row in tables.neutral_points(rows)],
        "coexistence_with_rotations": both,
        "period_doublings": (
            "none: multipliers of these symmetric cycles are squares; -1 of the reduced map would"
            " be a pitchfork"
        ),
        "formula_within_5_percent": near,
        "formula_off_by": [
            {along: one.value, "relative": one.off}
            for one in deviations[:: max(1, len(deviations) // 12)]
        ],
        "dry": dry_branch(rows),
        "turning": turned,
        "ends": _ends(rows, along),
        "accuracy": _accuracy(rows, merging, second),
    }
    other = setting.elsewhere(along="k")
    # A branch in another constant may end anywhere.
    far = "" if other else setting.short_of(to=FAR_K)
    m5 = claim_m5(rows, merging, first_hopf, second, both, along)
    m6 = claim_m6(deviations, turned, near, along, wheel)
    claims = [
        m5.doubted(other, "" if merging and first_hopf else far),
        m6.doubted(other, far),
        claim_m9(turned),
    ]
    foreign = setting.elsewhere(**PAPER)
    answers = _answers(rows, numbers, near)
    return Findings([claim.doubted(foreign) for claim in claims], numbers, answers=answers)


def _answers(rows: list[BranchRow], numbers: Numbers, near: list[list[float]]) -> list[Answer]:
    """The special points, and where the formula fits."""
    letter = numbers["along"]
    answers = [
        Answer(f"{row['type']}, {_NAMES[row['part']]}, at {letter}", row["value"])
        for row in tables.special_points(rows)
    ]
    for part, law in numbers["period_law"].items():
        if law:
            limit = Answer("", law["limit_s"], law["limit_error_s"], "s").in_words()
            if law["limit_s"] is None:
                limit = (
                    "not to be extrapolated, as the saddle's rates differ by"
                    f" {100 * law['power']:.2g} % only"
                )
            words = (
                f"{law['slope_s']:.5g} s per ln(distance), in the limit {limit};"
                f" predicted {law['predicted_s']:.5g} s. The saddle's second rate explains"
                f" {law['explained_s']:.5g} s at these distances; what it adds falls as"
                f" distance^{law['power']:.3g}"
            )
            answers.append(Answer(f"period near the merging, {_NAMES[part]}", words))
    both = numbers["coexistence_with_rotations"]
    if both:
        answers.append(
            Answer("rotations beside rest or swinging", f"{both['from']:.9g} to {both['to']:.9g}")
        )
    fits = ", ".join(f"{low:.9g} to {high:.9g}" for low, high in near) or "nowhere"
    return [*answers, Answer(f"constant-velocity formula within 5 % for {letter}", fits)]


def _special_point(row: SpecialRow, along: str, wheel: Wheel) -> dict[str, object]:
    """A bifurcation as plain data, without what is unknown."""
    found: dict[str, object] = {
        "type": row["type"],
        "k": row["value"] if along == "k" else wheel.k,
        along: row["value"],
        "branch": _NAMES[row["part"]],
        "omega_mean": row["omega_mean"],
        "multipliers": row["multipliers"],
    }
    if row["type"] == "hopf":
        return found | {"period": row["period"], "amplitude": row["amplitude"], "l1": row["l1"]}
    if row["type"] == "merging":
        return found | {
            "saddle_quantity": row["saddle_quantity"],
            "eigenvalues": row["eigenvalues"],
        }
    found |= {"reduced_multipliers": row["reduced_multipliers"], "period": row["period"]}
    return found if row["amplitude"] is None else found | {"amplitude": row["amplitude"]}


def _ends(rows: list[BranchRow], along: str) -> list[dict[str, object]]:
    """Where branches end, or why there is none."""
    found: list[dict[str, object]] = []
    for row in tables.ends(rows):
        if row["type"] == "none":
            found.append({"branch": row["part"], "way": None, "end": row["why"], along: None})
        else:
            value = _limit(rows, row)
            found.append(
                {"branch": row["part"], "way": row["way"], "end": row["type"], along: value}
            )
    return found


def _limit(rows: list[BranchRow], end: EndRow) -> float:
    """The value to which a branch goes: its last cycle is only near a merging or a Hopf point."""
    limits: list[float] = []
    if end["type"] == "merging":
        part: Part = "dry" if end["part"] == "dry" else "merging"
        limits = [row["value"] for row in tables.mergings(rows, part)]
    elif end["type"] == "hopf":
        limits = [row["value"] for row in tables.hopfs(rows)]
    return min(limits, key=lambda limit: abs(limit - end["value"]), default=end["value"])


def _accuracy(
    rows: list[BranchRow], merging: MergingRow | None, second: dict[CyclePart, float | None]
) -> Accuracy:
    """The greatest differences between methods; None where nothing was compared."""
    again = [row["off_by"] for row in tables.mergings(rows, "merging")]
    bifurcations = [row["off_by"] for row in tables.cycle_points(rows)]
    bifurcations += [
        row["off_by"] for row in tables.mergings(rows, "dry") if row["off_by"] is not None
    ]
    return {
        "hopf_closed_form_against_eigenvalues": max(
            (row["off_by"] for row in tables.hopfs(rows)), default=None
        ),
        "merging_with_other_begin_and_shorter_steps": max(
            (off_by for off_by in again if off_by is not None), default=None
        ),
        "merging_against_extrapolated_branches": {
            part: abs(value / merging["value"] - 1)
            for part, value in second.items()
            if merging and value
        },
        "bifurcations_of_cycles_with_shorter_steps": max(bifurcations, default=None),
        "cycles_against_time_stepping_rad_per_s": max(
            (row["off_by"] for row in tables.stepped_cycles(rows)), default=None
        ),
        "product_of_multipliers": max((row["off_by"] for row in tables.cycles(rows)), default=None),
    }
