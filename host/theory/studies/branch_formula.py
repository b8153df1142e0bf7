"""The constant-velocity formula and the potentials of a turning wheel: the claims M6 and M9."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, TypedDict

from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.theory.analysis.hopf import estimate, hopf
from host.theory.model.turning import constant_velocity
from host.theory.model.wheel import Wheel
from host.theory.studies.branch_tables import BranchRow, TurnedRow, stable_of, turned_at

# The formula holds if it is off by less than this (relative).
NEAR = 0.05
# How stable rotations end, by the type of the bifurcation.
_END = {
    "neimark-sacker": "the end of its stable part, at a Neimark-Sacker point",
    "fold": "the end of its stable part, at a fold",
    "pitchfork": "the end of its stable part, at a pitchfork",
}


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


class Deviation(NamedTuple):
    """How far the formula is off at one stable rotation.

    Attributes:
        value: of the followed constant.
        off: relative error of the formula.
        end: the type of bifurcation at which the stable rotations end here; empty elsewhere.
    """

    value: float
    off: float
    end: str


def deviations_of(rows: list[BranchRow]) -> list[Deviation]:
    """The errors of the formula along the stable rotations, ascending in value."""
    return [
        Deviation(
            row["value"],
            row["formula"] / row["omega_mean"] - 1,
            row["type"] if row["kind"] == "special" else "",
        )
        for row in stable_of(rows, "LLM")
        if row["formula"] is not None
    ]


def near_ranges(deviations: list[Deviation], edges: list[float]) -> list[list[float]]:
    """The ranges of values in which the formula is within NEAR.

    Args:
        deviations: Along the stable rotations, ascending in value.
        edges: Where a rotation is just NEAR, ascending.
    """
    ranges: list[list[float]] = []
    last, inside = float("-inf"), False
    for value, off, _ in deviations:
        if (abs(off) < NEAR) != inside:
            edge = next((edge for edge in edges if last <= edge <= value), value)
            inside = not inside
            if inside:
                ranges.append([edge])
            else:
                ranges[-1].append(edge)
        last = value
    if inside:
        ranges[-1].append(last)
    return ranges


def claim_m6(
    deviations: list[Deviation],
    turned: list[Turning],
    near: list[list[float]],
    along: str,
    wheel: Wheel,
) -> Claim:
    """M6: the formula holds at the end of the branch."""
    claim = Claim(
        "M6",
        SENTENCES["M6"],
        "omega = +- sqrt((a k tau - 2 f) / (2 f tau^2)), beside the numeric branch",
        None,
        "1",
        None,
        holds=False,
    )
    if not deviations:
        return replace(claim, note=f"as no stable rotation was found on the branch in {along}")
    value, last, end = deviations[-1]
    name = _END.get(end, "the end of the branch")
    where = " and ".join(f"{low:.6g} to {high:.6g}" for low, high in near) or "nowhere"
    return replace(
        claim,
        measured=last,
        holds=any(high == value for _, high in near),
        note=f"the formula's relative error at {along} = {value:.8g}, {name}; below"
        f" 5 % for {along} = {where}; {_shown(turned, wheel)}. {_begin(along, wheel)}",
    )


def _shown(turned: list[Turning], wheel: Wheel) -> str:
    """The formula's errors for wheels that roll, at their k and the wheel's other constants."""
    errors = [
        f"{_formula(entry, wheel) / entry['omega'] - 1:+.1%} at k = {entry['k']:g}"
        for entry in turned
        if entry["rolling_wheel_off_by"] is not None
    ]
    return ", ".join(errors) or "no wheel rolls at the k that were tried"


def _begin(along: str, wheel: Wheel) -> str:
    """Where the formula begins along a constant, in words."""
    if along == "k":
        return (
            f"The formula begins at k = {estimate(wheel):.4g},"
            f" {estimate(wheel) / hopf(wheel).k:.2f} of the Hopf line's, where no rotation exists"
        )
    if along == "I":
        return "The formula is the same for all I"
    if along == "f":
        return f"The formula ends at f = a k tau / 2 = {wheel.a * wheel.k * wheel.tau / 2:.4g}"
    least = 2 * wheel.f / (wheel.k * (wheel.tau if along == "a" else wheel.a))
    return f"The formula begins at {along} = {least:.4g}, where a k tau = 2 f"


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
        SENTENCES["M9"],
        "numeric against formula",
        worst,
        "1",
        None,
        worst < 1e-8,
        note,
    )
