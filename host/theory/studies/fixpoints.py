"""The eight angles at which a wheel can rest (eq. trivial_fixpoints), their eigenvalues, and the resting states of two wheels.

That there are no others: at rest the rods balance if g(cos phi) = g(sin phi), or if one of the two is 0, where g(u) = x_t(u) / u is even
and falls with |u|.
"""

from __future__ import annotations

from itertools import product
from math import e, pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from host.claims import Claim
from host.errors import WrongUse
from host.experiments.experiment import Cell, Findings, Row, Setting
from host.theory.model import Array, Wheel, rates, resting
from host.theory.run import wheel_of
from host.theory.symbolic import jacobian_at, jacobian_by_differences

NDComplex = NDArray[np.complex128]

ANGLES = tuple(n * pi / 4 for n in range(8))
# The time course that is held against the eigenvalues begins so near to the fixpoint, and grows or shrinks by this factor.
NEAR, FACTOR = 1e-6, e


class Fixpoint(NamedTuple):
    """A resting wheel: its angle (rad), state (4,), eigenvalues (4,) in 1/s, the greatest real part first, and their vectors (4, 4)."""

    phi: float
    state: Array
    eigenvalues: NDComplex
    eigenvectors: NDComplex

    @property
    def stable(self) -> bool:
        """Whether every small disturbance dies out."""
        return bool(self.eigenvalues.real.max() < 0.0)

    @property
    def kind(self) -> str:
        """A saddle has one direction in which a disturbance grows without turning; a focus turns about."""
        if self.eigenvalues[0].imag == 0.0 and not self.stable:
            return "saddle"
        return ("stable " if self.stable else "unstable ") + ("focus" if np.any(self.eigenvalues.imag != 0.0) else "node")


def fixpoint(phi: float, wheel: Wheel) -> Fixpoint:
    """The fixpoint at one of ANGLES. Raises WrongUse if the rods do not pull, so that a wheel can rest anywhere."""
    for name in ("k", "a"):
        if getattr(wheel.checked(), name) == 0.0:
            raise WrongUse(f"with {name} = 0 the rods do not pull, and a wheel rests at any angle", f"give {name} above 0")
    state = resting(np.array([phi]))[:, 0]
    values, vectors = np.linalg.eig(jacobian_at(state.tolist(), wheel))
    order = np.argsort(-values.real, kind="stable")
    return Fixpoint(phi, state, values[order].astype(complex), vectors[:, order].astype(complex))


def fixpoints(wheel: Wheel) -> list[Fixpoint]:
    """All eight, in the order of their angles."""
    return [fixpoint(phi, wheel) for phi in ANGLES]


def growth_by_time_course(found: Fixpoint, wheel: Wheel) -> float:
    """The rate (1/s) of the fixpoint's leading eigenvalue, measured in a run of the equations that begins NEAR it."""
    leading, vector = found.eigenvalues[0], found.eigenvectors[:, 0]
    left = np.linalg.inv(found.eigenvectors)[0]
    seconds = np.log(FACTOR) / abs(leading.real) if leading.real else 1.0 / abs(leading)
    constants = list(wheel)
    start = found.state + NEAR * (vector / np.abs(vector).max()).real
    run = solve_ivp(lambda _, state: rates(*state, *constants), (0.0, seconds), start, method="LSODA", rtol=1e-11, atol=1e-15)
    along = [abs(left @ (state - found.state)) for state in (start, run.y[:, -1])]
    return float(np.log(along[1] / along[0]) / seconds)


def cells(options: dict[str, Any]) -> list[Cell]:
    """One wheel, and two. Raises WrongUse if it can rest anywhere."""
    fixpoints(wheel_of(options))
    return [{"part": "one wheel"}, {"part": "two wheels"}]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The fixpoints of one wheel, or of two that do not feel each other."""
    wheel = wheel_of(setting.options)
    found = fixpoints(wheel)
    if cell["part"] == "two wheels":
        return [{"phi": left.phi, "right_phi": right.phi, "stable": left.stable and right.stable} for left, right in product(found, found)]
    rows = []
    for n, point in enumerate(found):
        values = {f"{name}_{i}": part for i, z in enumerate(point.eigenvalues) for name, part in (("re", z.real), ("im", z.imag))}
        difference = np.abs(jacobian_at(point.state.tolist(), wheel) - jacobian_by_differences(point.state.tolist(), wheel)).max()
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
    one, two = ([row for row in rows if row["part"] == part] for part in ("one wheel", "two wheels"))
    wheel = wheel_of(setting.options)
    numbers = [
        {
            "n": row["n"],
            "phi": row["phi"],
            "kind": row["kind"],
            "stable": row["stable"],
            "eigenvalues": [[row[f"re_{i}"], row[f"im_{i}"]] for i in range(4)],
            "accuracy": {"jacobian_against_differences": row["jacobian_off_by"], "growth_against_time_course": row["growth_off_by"]},
        }
        for row in one
    ]
    odd_unstable = all(row["kind"] == "saddle" for row in one if row["n"] % 2)
    even = [row["stable"] for row in one if row["n"] % 2 == 0]
    stable_pairs = sum(row["stable"] for row in two)
    drive = wheel.a * wheel.k * wheel.tau_s / 2
    ratio = f"{drive / wheel.friction:.2f}" if wheel.friction else "infinite"
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
                f"odd n are saddles, even n {'stable' if even[0] else 'unstable'} at a k tau / (2 f) = {ratio}; growth rates agree with "
                f"time courses within {max(row['growth_off_by'] for row in one):.0e}/s",
            ),
            Claim(
                "M2",
                "two wheels have 16 non-moving states",
                "4 x 4 stable fixpoints",
                float(stable_pairs),
                "stable states",
                None,
                stable_pairs == (16 if all(even) else 0),
                f"of 64 pairs of fixpoints; below the Hopf line 16 are stable, above it none: here {'below' if all(even) else 'above'}",
            ),
        ],
        numbers,
    )
