"""Where the branches merge, by two methods, and whether there is hysteresis: the claim M5."""

from __future__ import annotations

from dataclasses import replace
from typing import TypedDict

import numpy as np
from scipy.optimize import minimize_scalar

from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.theory.model.wheel import Array
from host.theory.studies.branch_rows import WAYS, CyclePart
from host.theory.studies.branch_tables import (
    BranchRow,
    CycleRow,
    HopfRow,
    MergingRow,
    cycles_along,
    cycles_of,
    folds,
    mergings,
)

# Passages by a saddle in a period of each family.
_PASSAGES: dict[CyclePart, int] = {"FB": 2, "LLM": 4, "dry": 4}
# A merging is extrapolated from this many last cycles of a branch that ends close to it (relative).
_LAST, _CLOSE = 25, 1e-2
# A line for the period is fitted to this number of them.
_CLOSEST = 8
# The limit of the period's slope is off by up to three times what its highest term changes, and is
# not given if this is more than a part of it.
SAFE, _SMALL = 3.0, 0.03
# Nor is it given if the saddle's rates differ by less than this part.
_NEARLY_EQUAL = 0.03
# Two values of a merging that differ by less (relative) are the same.
_SAME = 1e-6
# Where the paper's portraits find a wheel forth and back, and rolling.
_SWINGS_K, _ROLLS_K = 1.65, 1.85


# `from` is a word of the language.
Coexistence = TypedDict("Coexistence", {"from": float, "to": float})


class PeriodLaw(TypedDict):
    """How the period grows towards a merging: by this much (s) for each unit of ln(distance).

    The distance falls with the period as the slower of the saddle's leading rates says: that of
    growth if cycles are stable there, else that of decay.

    Attributes:
        slope_s: of a line through the last cycles.
        limit_s: of the law itself, from a fit to the last cycles that takes the saddle's second
            rate into account; None if its error is not small, or both rates nearly agree.
        limit_error_s: its error: SAFE times what the fit's highest term changes.
        predicted_s: minus the passages by a saddle in a period, divided by this rate.
        explained_s: the slope of a line through the same cycles by the law with both rates of the
            saddle, none of them fitted: what is left between slope_s and predicted_s is due to the
            second one.
        power: the slope's relative difference from predicted_s falls as this power of the distance.
    """

    slope_s: float
    limit_s: float | None
    limit_error_s: float | None
    predicted_s: float
    explained_s: float
    power: float


class FoldNumbers(TypedDict):
    """A fold of rotations: where it is, and their mean speed there (rad/s)."""

    value: float
    omega_mean: float


class DryNumbers(TypedDict):
    """The branch of rotations with dry friction."""

    folds: list[FoldNumbers]
    merging: float | None
    merging_by_extrapolation: float | None


def extrapolated(rows: list[BranchRow], part: CyclePart, merging: MergingRow) -> float | None:
    """Where a branch would reach an infinite period: a second value of the merging.

    With the time T for a passage by one saddle, the followed constant approaches its limit as
    exp(-lambda_u T) and exp(lambda_s T) (Kuznetsov, section 6.2). None if the branch does not go
    there.
    """
    cycles = _last_cycles(rows, part, merging["value"])
    if len(cycles) < _LAST:
        return None
    times = np.array([row["period"] for row in cycles]) / _PASSAGES[part]
    values = np.array([row["value"] for row in cycles])
    (rising, _), (falling, _) = merging["eigenvalues"][:2]
    decays = [np.exp(-rate * (times - times[0])) for rate in (rising, -falling, 2 * rising)]
    solution = np.linalg.lstsq(
        np.column_stack([np.ones_like(times), *decays]), values - merging["value"], rcond=None
    )[0]
    return float(merging["value"] + solution[0])


def period_law(rows: list[BranchRow], part: CyclePart, merging: MergingRow) -> PeriodLaw | None:
    """The logarithmic law of the period near the merging; None if the branch does not go there."""
    cycles = _last_cycles(rows, part, merging["value"])
    if len(cycles) < _LAST:
        return None
    (growth, _), (decay, _), *_ = merging["eigenvalues"]
    slower, faster = sorted((growth, -decay))
    distances = np.array([row["value"] - merging["value"] for row in cycles])
    periods = np.array([row["period"] for row in cycles])
    times = periods / _PASSAGES[part]

    def fitted(rate: float, count: int) -> Array:
        """Distances by the law with `count` terms, in units of those of the cycles."""
        decays = np.exp(np.outer(times - times[0], [-rate, -faster, -2 * rate][:count]))
        terms = decays / distances[:, None]
        return np.asarray(terms @ np.linalg.lstsq(terms, np.ones_like(times), rcond=None)[0])

    def limit(count: int) -> float:
        low, high = 0.8 * slower, 1.2 * slower
        rate = minimize_scalar(
            lambda rate: np.sum((fitted(rate, count) - 1) ** 2),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-9},
        ).x
        return -_PASSAGES[part] / float(rate)

    def slope(distances: Array) -> float:
        close = slice(-_CLOSEST, None)
        return float(np.polyfit(np.log(np.abs(distances[close])), periods[close], 1)[0])

    power = faster / slower - 1.0
    found = limit(3)
    error = SAFE * abs(found - limit(2))
    known = power > _NEARLY_EQUAL and error < _SMALL * abs(found)
    return {
        "slope_s": slope(distances),
        "limit_s": found if known else None,
        "limit_error_s": error if known else None,
        "predicted_s": -_PASSAGES[part] / slower,
        "explained_s": slope(fitted(slower, 3) * distances),
        "power": power,
    }


def _last_cycles(rows: list[BranchRow], part: CyclePart, value: float) -> list[CycleRow]:
    """The last cycles of the branch whose period grows towards this value of the constant."""
    found: list[CycleRow] = []
    for way in WAYS:
        branch = cycles_along(rows, part, way)
        if not branch or abs(branch[-1]["value"] / value - 1) >= _CLOSE:
            continue
        if branch[-1]["period"] == max(row["period"] for row in branch):
            found = branch[-_LAST:]
    return found


def coexistence(
    rows: list[BranchRow], first_hopf: HopfRow | None, merging: MergingRow | None
) -> Coexistence | None:
    """The range of k where stable rotations coexist with stable rest or forth-and-back cycles."""
    if not merging or not first_hopf or not cycles_of(rows, "LLM"):
        return None
    k_merge = merging["value"]
    least = min([*(row["value"] for row in folds(rows, "LLM")), k_merge])
    most = max([first_hopf["value"], *(row["value"] for row in folds(rows, "FB")), k_merge])
    return {"from": least, "to": most} if most > least else None


def dry_branch(rows: list[BranchRow]) -> DryNumbers | None:
    """The rotations with dry friction; None if there are none."""
    cycles = cycles_of(rows, "dry")
    if not cycles:
        return None
    found = mergings(rows, "dry")
    return {
        "folds": [
            {"value": row["value"], "omega_mean": row["omega_mean"]} for row in folds(rows, "dry")
        ],
        "merging": found[0]["value"] if found else None,
        "merging_by_extrapolation": extrapolated(rows, "dry", found[0]) if found else None,
    }


def claim_m5(
    rows: list[BranchRow],
    merging: MergingRow | None,
    first_hopf: HopfRow | None,
    second: dict[CyclePart, float | None],
    both: Coexistence | None,
    along: str,
) -> Claim:
    """M5: cycles are born stable, and both branches reach the merging.

    Args:
        rows: The branches.
        merging: Where cycles and rotations merge; None if no merging was found.
        first_hopf: The first Hopf bifurcation; None if there was none.
        second: The merging by extrapolation of each branch.
        both: The range of k with hysteresis, if any.
        along: The constant that is followed.
    """
    claim = Claim(
        "M5",
        SENTENCES["M5"],
        "amplitude of the cycle against k up to the merging; merging value located",
        merging["value"] if merging else None,
        "1",
        None,
        holds=False,
    )
    if not merging or not first_hopf:
        missing = "merging" if first_hopf else "Hopf bifurcation"
        return replace(claim, note=f"as there is no {missing} on the branch in {along}")
    at_merging, at_hopf = merging["value"], first_hopf["value"]
    born_stable = first_hopf["l1"] < 0.0
    joined = all(value and abs(value / at_merging - 1) < _SAME for value in second.values())
    amplitude = max((row["amplitude"] or 0.0 for row in cycles_of(rows, "FB")), default=0.0)
    notes = [f"saddle quantity {merging['saddle_quantity']:.3g}/s"]
    if along == "k":
        notes.append(
            f"hysteresis from k = {both['from']:.9g} to {both['to']:.9g}"
            if both
            else "no hysteresis"
        )
        if at_hopf < _SWINGS_K < at_merging < _ROLLS_K:
            notes.append(f"k = {_SWINGS_K} swings, k = {_ROLLS_K} rolls, as in its portraits")
    return replace(
        claim,
        holds=born_stable and joined,
        note=f"the {along} of the merging, more exactly {at_merging:.12g}, which"
        f" {'both' if joined else 'not both'} cycles and rotations reach. Cycles are born"
        f" {'stable' if born_stable else 'unstable'} at {along} = {at_hopf:.9g} and grow to"
        f" {amplitude:.4f} rad (pi/4: 0.7854). They merge in a heteroclinic ring of four saddles;"
        f" {'; '.join(notes)}",
    )
