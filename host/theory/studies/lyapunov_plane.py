"""The study `lyapunov-plane`: attractors and the largest exponent over the plane (k, tau)."""

from __future__ import annotations

from typing import Any

import numpy as np

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.attractors import CHAOS, KINDS
from host.theory.model.wheel import wheel_of
from host.theory.studies import lyapunov_pieces as pieces
from host.theory.studies.lyapunov_numbers import HalvedSteps, PlaneNumbers
from host.theory.studies.lyapunov_rows import (
    ANY,
    ROLLS,
    GridPoint,
    PlaneCell,
    PlaneRow,
    StartKind,
    StepCheck,
    StepCheckRow,
    plane_of,
    step_checks,
)
from host.theory.studies.route_to_chaos import tally

# Values of k, and of tau, and values of tau in a cell.
POINTS, BAND = 60, 4
_STARTS: dict[StartKind, str] = {ANY: "random states", ROLLS: "rolling"}


def cells(options: dict[str, Any], *, batch: bool = True) -> list[PlaneCell]:
    """Bands of tau, and a check. Raises WrongUse if wheels are too fast for long."""
    least_tau = pieces.midpoints(options["tau_to"], POINTS)[0]
    pieces.require_slow(wheel_of(options)._replace(k=options["k_to"], tau=float(least_tau)))
    found: list[PlaneCell] = [{"part": "plane", "first": first} for first in range(0, POINTS, BAND)]
    return [*found, {"part": "check"}]


def simulate(cell: PlaneCell, setting: Setting) -> list[GridPoint] | list[StepCheck]:
    """A band of the plane, or the check."""
    options, rng = setting.options, np.random.default_rng(setting.seed_of(cell))
    wheel = wheel_of(options)
    ks, taus = (pieces.midpoints(options[name], POINTS) for name in ("k_to", "tau_to"))
    if cell["part"] == "check":
        return pieces.step_check(wheel, ks, taus, rng)
    own = taus[cell["first"] : cell["first"] + BAND]
    parameters = wheel.columns(
        len(ks) * len(own), k=np.tile(ks, len(own)), tau=np.repeat(own, len(ks))
    )
    return pieces.from_both_starts(parameters, 1, rng)


def report(rows: list[PlaneRow], setting: Setting) -> Findings:
    """Shares of the plane. The paper claims nothing about them in numbers."""
    numbers: PlaneNumbers = {
        **tally(plane_of(rows)),
        "accuracy": halved_steps(step_checks(rows)),
    }
    answers = [
        Answer(f"{kind}, from {_STARTS[start]}", 100 * share, None, "%")
        for start, shares in numbers["shares"].items()
        for kind, share in shares.items()
    ]
    return Findings([], numbers, answers=answers)


def halved_steps(rows: list[StepCheckRow]) -> HalvedSteps:
    """What changes with half the step. Chaotic wheels are compared by their kind only."""
    regular = [row for row in rows if row["kind"] == row["kind_finer"] != KINDS[CHAOS]]
    changes = [abs(row["exponent"] - row["exponent_finer"]) for row in regular]
    speeds = [row["speed_off_by"] for row in regular]
    return {
        "points": len(rows),
        "same_kind": sum(row["kind"] == row["kind_finer"] for row in rows),
        "median_exponent_off_by": float(np.median(changes)) if regular else None,
        "median_speed_off_by_rad_s": float(np.median(speeds)) if regular else None,
    }
