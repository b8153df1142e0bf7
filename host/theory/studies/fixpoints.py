"""The fixpoints of one wheel, with their eigenvalues, and the resting states of two."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.fixpoints import fixpoints, growth_by_time_course
from host.theory.model.symbolic import jacobian_at, jacobian_by_differences
from host.theory.model.wheel import wheel_of
from host.theory.studies.registry import PAPER

# The k of the paper's portrait of a wheel that rests.
PAPER_K = 1.4


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """One wheel, and two. Raises WrongUse if it can rest anywhere."""
    fixpoints(wheel_of(options))
    return [{"part": "one wheel"}, {"part": "two wheels"}]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The fixpoints of one wheel, or of two that do not feel each other."""
    wheel = wheel_of(setting.options)
    found = fixpoints(wheel)
    if cell["part"] == "two wheels":
        return [
            {"phi": left.phi, "right_phi": right.phi, "stable": left.stable and right.stable}
            for left, right in product(found, found)
        ]
    rows = []
    for n, point in enumerate(found):
        values = {
            f"{name}_{i}": part
            for i, z in enumerate(point.eigenvalues)
            for name, part in (("re", z.real), ("im", z.imag))
        }
        difference = np.abs(
            jacobian_at(point.state.tolist(), wheel)
            - jacobian_by_differences(point.state.tolist(), wheel)
        ).max()
        course = growth_by_time_course(point, wheel)
        rows.append(
            {
                "n": n,
                "phi": point.phi,
                "kind": point.kind,
                "stable": point.stable,
                **{name: float(part) for name, part in values.items()},
                "jacobian_off_by": float(difference),
                "growth_off_by": float(abs(course - point.eigenvalues[0].real)),
            }
        )
    return rows


def report(rows: list[Row], setting: Setting) -> Findings:
    """M1 and M2."""
    one, two = (
        [row for row in rows if row["part"] == part] for part in ("one wheel", "two wheels")
    )
    wheel = wheel_of(setting.options)
    numbers = [
        {
            "n": row["n"],
            "phi": row["phi"],
            "kind": row["kind"],
            "stable": row["stable"],
            "eigenvalues": [[row[f"re_{i}"], row[f"im_{i}"]] for i in range(4)],
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
    drive = wheel.a * wheel.k * wheel.tau_s / 2
    ratio = f"{drive / wheel.friction:.2f}" if wheel.friction else "infinite"
    foreign = setting.elsewhere(**PAPER, k=PAPER_K)
    return Findings(
        [
            Claim(
                "M1",
                "eight fixpoints omega = 0, phi = n pi/4, of which the odd n are always unstable",
                "odd n unstable; even n stable for small a k tau / (2 f)",
                float(len(one)),
                "fixpoints",
                None,
                odd_unstable and len(set(even)) == 1,
                f"odd n are saddles, even n {'stable' if even[0] else 'unstable'} at a k tau / (2"
                f" f) = {ratio}; growth rates agree with time courses within"
                f" {max(row['growth_off_by'] for row in one):.0e}/s",
            ).doubted(foreign),
            Claim(
                "M2",
                "two wheels have 16 non-moving states",
                "4 x 4 stable fixpoints",
                float(stable_pairs),
                "stable states",
                None,
                stable_pairs == (16 if all(even) else 0),
                "of 64 pairs of fixpoints; below the Hopf line 16 are stable, above it none: here"
                f" {'below' if all(even) else 'above'}",
            ).doubted(foreign),
        ],
        numbers,
    )
