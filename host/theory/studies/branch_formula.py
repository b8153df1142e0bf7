"""The constant-velocity formula and the potentials of a turning wheel: the claims M6 and M9."""

from __future__ import annotations

from dataclasses import replace
from typing import TypedDict

from host.runs.claims import Claim
from host.theory.analysis.hopf import estimate, hopf
from host.theory.model.turning import constant_velocity
from host.theory.model.wheel import Wheel
from host.theory.studies.branch_tables import BranchRow, TurnedRow, cycles_of, turned_at

# The formula holds if it is off by less than this (relative).
NEAR = 0.05


class Turning(TypedDict):
    """How well the formula for potentials fits at one k.

    Attributes:
        k: spring constant.
        omega: speed at which the wheel is turned (rad/s).
        numeric_off_by: greatest difference to integration (1).
        rolling_wheel_off_by: greatest difference to the wheel that rolls by itself, relative to the
            amplitude; None if it does not roll.
    """

    k: float
    omega: float
    numeric_off_by: float
    rolling_wheel_off_by: float | None


def turning(rows: list[BranchRow]) -> list[Turning]:
    """How well the formula for potentials fits, at each k."""
    return [_turning_at(k, points) for k, points in turned_at(rows).items()]


def _turning_at(k: float, points: list[TurnedRow]) -> Turning:
    numeric, rolling, amplitude = 0.0, [], 0.0
    for row in points:
        numeric = max(
            numeric, abs(row["x1"] - row["x1_numeric"]), abs(row["x2"] - row["x2_numeric"])
        )
        amplitude = max(amplitude, abs(row["x1"]), abs(row["x2"]))
        if row["x1_rolling"] is not None and row["x2_rolling"] is not None:
            rolling += [abs(row["x1"] - row["x1_rolling"]), abs(row["x2"] - row["x2_rolling"])]
    return {
        "k": k,
        "omega": points[0]["omega_mean"],
        "numeric_off_by": numeric,
        "rolling_wheel_off_by": max(rolling) / amplitude if rolling else None,
    }


def deviations_of(rows: list[BranchRow]) -> list[tuple[float, float]]:
    """(value, relative deviation of the formula) along the stable rotations, ascending in value."""
    stable = [row for row in cycles_of(rows, "LLM") if row["stable"]]
    stable.sort(key=lambda row: row["value"])
    return [
        (row["value"], row["formula"] / row["omega_mean"] - 1)
        for row in stable
        if row["formula"] is not None
    ]


def near_ranges(deviations: list[tuple[float, float]]) -> list[list[float]]:
    """The ranges of values in which the formula is within NEAR; their ends are interpolated."""
    ranges: list[list[float]] = []
    inside = False
    for index, (value, off) in enumerate(deviations):
        if (abs(off) < NEAR) == inside:
            continue
        edge = value
        if index:
            before, off_before = deviations[index - 1]
            part = (NEAR - abs(off_before)) / (abs(off) - abs(off_before))
            edge = before + (value - before) * part
        inside = not inside
        if inside:
            ranges.append([edge])
        else:
            ranges[-1].append(edge)
    if inside:
        ranges[-1].append(deviations[-1][0])
    return ranges


def claim_m6(
    deviations: list[tuple[float, float]],
    turned: list[Turning],
    near: list[list[float]],
    along: str,
    wheel: Wheel,
) -> Claim:
    """M6: the formula holds at the end of the branch."""
    claim = Claim(
        "M6",
        "far above the onset, locomotion has the speed of the constant-velocity formula",
        "omega = +- sqrt((a k tau - 2 f) / (2 f tau^2)), beside the numeric branch",
        None,
        "1",
        None,
        holds=False,
    )
    if not deviations:
        return replace(claim, note=f"as no stable rotation was found on the branch in {along}")
    value, last = deviations[-1]
    where = " and ".join(f"{low:.4g} to {high:.4g}" for low, high in near) or "nowhere"
    shown = ", ".join(
        f"{_formula(entry, wheel) / entry['omega'] - 1:+.1%} at k = {entry['k']:g}"
        for entry in turned
        if entry["rolling_wheel_off_by"] is not None
    )
    return replace(
        claim,
        measured=last,
        holds=any(high == value for _, high in near),
        note=f"the formula's relative error at {along} = {value:g}, the end of the branch; below"
        f" 5 % for {along} = {where}; {shown}. The formula begins at k = {estimate(wheel):.4g},"
        f" {estimate(wheel) / hopf(wheel).k:.2f} of the Hopf line's, where no rotation exists",
    )


def _formula(entry: Turning, wheel: Wheel) -> float:
    """Omega of the formula, rad/s; 0 where it has none."""
    return constant_velocity(wheel._replace(k=entry["k"])) or 0.0


def claim_m9(turned: list[Turning]) -> Claim:
    """M9: the formula for the potentials agrees with integration."""
    worst = max(entry["numeric_off_by"] for entry in turned)
    own = ", ".join(
        f"{entry['rolling_wheel_off_by']:.1%} of the amplitude at k = {entry['k']:g}"
        for entry in turned
        if entry["rolling_wheel_off_by"] is not None
    )
    note = "the greatest difference between the formula and integration"
    if own:
        note += f"; a wheel that rolls by itself has no steady speed, and differs by {own}"
    return Claim(
        "M9",
        "the membrane potentials of a wheel that turns steadily are those of eq. x-t",
        "numeric against formula",
        worst,
        "1",
        None,
        worst < 1e-8,
        note,
    )
