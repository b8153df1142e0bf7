"""The study `fixpoints`: the fixpoints of one wheel, and the resting states of two (M1, M2)."""

from __future__ import annotations

from itertools import product
from math import degrees, inf, pi
from typing import Any, TypedDict

import numpy as np

from host.runs.answers import Answer
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Setting
from host.theory.analysis.fixpoints import Fixpoint, Kind, fixpoints, growth_by_time_course
from host.theory.model.laws import rates_of
from host.theory.model.symbolic import jacobian_at, jacobian_by_differences
from host.theory.model.wheel import OMEGA, Wheel, resting, wheel_of
from host.theory.studies.fixpoints_rows import (
    FixpointsCell,
    FixpointsRow,
    Force,
    PairOfRests,
    Rest,
    eigenvalues,
    of_one_kind,
    of_one_wheel,
    of_two_wheels,
)
from host.theory.studies.registry import PAPER

# The k of the paper's portrait of a wheel that rests.
PAPER_K = 1.4
# The angles (rad) at which the force is shown, and how many.
DRAWN, SAMPLES = (-0.2, 2 * pi + 0.2), 1000


def cells(options: dict[str, Any], *, batch: bool = True) -> list[FixpointsCell]:
    """One wheel, two, and the force. Raises WrongUse if a wheel can rest at any angle."""
    fixpoints(wheel_of(options))
    return [{"part": "one wheel"}, {"part": "two wheels"}, {"part": "force"}]


def simulate(cell: FixpointsCell, setting: Setting) -> list[Rest] | list[PairOfRests] | list[Force]:
    """The fixpoints of one wheel, of two that do not act on each other, or the force."""
    wheel = wheel_of(setting.options)
    if cell["part"] == "force":
        return _force(wheel)
    found = fixpoints(wheel)
    if cell["part"] == "two wheels":
        return [_pair(left, right) for left, right in product(found, found)]
    return [_rest(n, point, wheel) for n, point in enumerate(found)]


def _rest(n: int, point: Fixpoint, wheel: Wheel) -> Rest:
    """The fixpoint number n."""
    state = point.state.tolist()
    differences = jacobian_at(state, wheel) - jacobian_by_differences(state, wheel)
    first, second, third, fourth = (complex(value) for value in point.eigenvalues)
    growth_per_s = growth_by_time_course(point, wheel)
    return {
        "n": n,
        "phi": point.phi,
        "kind": point.kind,
        "stable": point.stable,
        "re_0": first.real,
        "im_0": first.imag,
        "re_1": second.real,
        "im_1": second.imag,
        "re_2": third.real,
        "im_2": third.imag,
        "re_3": fourth.real,
        "im_3": fourth.imag,
        "jacobian_off_by": float(np.abs(differences).max()),
        "growth_off_by": abs(growth_per_s - first.real),
    }


def _force(wheel: Wheel) -> list[Force]:
    """The force of the rods, which no friction and no bound of the motor changes."""
    unit = wheel._replace(k=1.0, I=1.0, f=0.0, bounded=inf)
    own_rates, angles = rates_of(unit), np.linspace(*DRAWN, SAMPLES)
    states = resting(angles).T.tolist()
    return [
        {"phi": phi, "force": float(own_rates(*state, *unit)[OMEGA])}
        for phi, state in zip(angles.tolist(), states, strict=True)
    ]


def _pair(left: Fixpoint, right: Fixpoint) -> PairOfRests:
    return {"phi": left.phi, "right_phi": right.phi, "stable": left.stable and right.stable}


class Accuracy(TypedDict):
    """The greatest differences between two ways to the same number."""

    jacobian_against_differences: float
    growth_against_time_course: float


class Numbers(TypedDict):
    """One of the fixpoints."""

    n: int
    phi: float
    kind: Kind
    stable: bool
    eigenvalues: list[list[float]]
    accuracy: Accuracy


def report(rows: list[FixpointsRow], setting: Setting) -> Findings:
    """M1 and M2."""
    one, two = of_one_wheel(rows), of_two_wheels(rows)
    wheel = wheel_of(setting.options)
    numbers: list[Numbers] = [
        {
            "n": row["n"],
            "phi": row["phi"],
            "kind": row["kind"],
            "stable": row["stable"],
            "eigenvalues": eigenvalues(row),
            "accuracy": {
                "jacobian_against_differences": row["jacobian_off_by"],
                "growth_against_time_course": row["growth_off_by"],
            },
        }
        for row in one
    ]
    odd_unstable = all(row["kind"] == "saddle" for row in one if row["n"] % 2)
    even = [row["stable"] for row in one if row["n"] % 2 == 0]
    stable_pairs = sum(row["stable"] for row in two)
    drive = wheel.a * wheel.k * wheel.tau / 2
    ratio = f"{drive / wheel.f:.2f}" if wheel.f else "infinite"
    foreign = setting.elsewhere(**PAPER, k=PAPER_K)
    kinds = (
        f"with odd n {'saddles' if odd_unstable else 'not all saddles'}, with even n"
        f" {'stable' if even[0] else 'unstable'}, at a k tau / (2 f) = {ratio}"
    )
    pairs = (
        f"among {len(two)} pairs of fixpoints, {'below' if all(even) else 'above'} the Hopf line;"
        " below it 16 are stable, above it none"
    )
    if wheel.rods == 1:  # not the angles n pi/4 of the claims
        kinds = f"with one rod {sum(row['stable'] for row in one)} of them are stable"
        pairs = f"among {len(two)} pairs of fixpoints of wheels with one rod"
    answers = []
    for alike in of_one_kind(one):
        first, places = alike[0], ", ".join(f"{degrees(row['phi']):.4g}°" for row in alike)
        answers.append(Answer(f"at {places}", first["kind"]))
        for number, (real, imaginary) in enumerate(eigenvalues(first), 1):
            answers.append(Answer(f"  eigenvalue {number}, real part", real, None, "/s"))
            if imaginary:
                answers.append(
                    Answer(f"  eigenvalue {number}, imaginary part", imaginary, None, "rad/s")
                )
    return Findings(
        [
            Claim(
                "M1",
                SENTENCES["M1"],
                "odd n unstable; even n stable for small a k tau / (2 f)",
                float(len(one)),
                "fixpoints",
                None,
                odd_unstable and len(set(even)) == 1,
                f"{kinds}; growth rates agree with time courses within"
                f" {max(row['growth_off_by'] for row in one):.0e}/s",
            ).doubted(foreign),
            Claim(
                "M2",
                SENTENCES["M2"],
                "4 x 4 stable fixpoints",
                float(stable_pairs),
                "stable states",
                None,
                stable_pairs == (16 if all(even) else 0),
                pairs,
            ).doubted(foreign),
        ],
        numbers,
        answers=answers,
    )
