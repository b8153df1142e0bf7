"""Portraits of a wheel in (phi, nu = omega / 2 pi).

Fixpoints, manifolds of the saddles, limit cycles and trajectories.

The flow has four dimensions. Trajectories, cycles and the unstable manifolds, which are curves, are
seen from the side. The stable manifolds of the saddles have three dimensions; shown is where they
meet the plane of `turning` states, in which the potentials are those of a wheel that has turned
with its present speed. On either side of such a line a wheel comes to something else.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.fixpoints import fixpoint, fixpoints
from host.theory.analysis.hopf import critical_k
from host.theory.engine.ensemble import advance
from host.theory.engine.flow import FINENESS, plain, run, steps_for
from host.theory.model.turning import turning
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, wheel_of
from host.theory.studies.registry import PAPER

PAPERS_K = {1.4: "S", 1.65: "FB", 1.85: "LLM"}
# Unstable manifolds begin so far from the saddle (in its eigenvector's units) and are followed for
# so long, sampled so often.
NEAR, FOLLOWED_S, SAMPLE_S = 1e-5, 14.0, 0.02
# What a wheel comes to is seen after so long.
FATE_S, SETTLED_S = 60.0, 300.0
# States this near are the same, in potentials and as part of the greatest speed (of at least
# SLOWEST, rad/s); a cycle must repeat itself within this time.
SAME, SLOWEST, WATCHED_S = 0.05, 0.01, 40.0
# Lines of the fate's grid over a quarter turn, and over the speeds of one sign; then each edge is
# halved so often.
GRID, HALVINGS = 160, 20
# Where the trajectories begin: angles, and speeds as parts of the fastest that is shown, which is
# so many times the manifolds' fastest.
TRAJECTORIES = (
    (-3.0, 0.9),
    (3.0, -0.9),
    (-1.3, 0.6),
    (1.3, -0.6),
    (0.1, 0.05),
    (1.7, 0.1),
    (-1.5, -0.1),
)
REACH = 2.5
ROLLING_MEAN = 0.1
QUARTER = pi / 2


def path(state: Array, wheel: Wheel, seconds: float, fineness: float = FINENESS) -> Array:
    """States every SAMPLE_S, (samples, 4), `state` (4,) included."""
    samples = round(seconds / SAMPLE_S)
    each = -(-steps_for(seconds, wheel, fineness) // samples)
    found: Array = run(
        plain, np.array(state)[:, None], tuple(wheel), samples * SAMPLE_S, samples * each
    )[::each, :, 0]
    return found


def unstable_manifolds(
    phi: float, wheel: Wheel, seconds: float = FOLLOWED_S, fineness: float = FINENESS
) -> Array:
    """Both branches of a saddle's unstable manifold, (2, samples, 4).

    First the one that leaves it forward.
    """
    saddle = fixpoint(phi, wheel)
    vector = saddle.eigenvectors[:, 0].real
    vector = vector * np.sign(vector[PHI])
    return np.array(
        [
            path(saddle.state + sign * NEAR * vector, wheel, seconds, fineness)
            for sign in (1.0, -1.0)
        ]
    )


def fates(phi: Array, omega: Array, wheel: Wheel) -> NDArray[np.int64]:
    """What becomes of wheels that begin in `turning` states.

    The well (quarter turns from angle 0) that they end in, or the way they roll.

    A wheel that rolls on has a fate far from any well: plus or minus 1e6.
    """
    parameters = wheel.columns(len(phi))
    half = advance(turning(phi, omega, wheel), parameters, FATE_S / 2)
    full = advance(half, parameters, FATE_S / 2)
    mean = (full[PHI] - half[PHI]) / (FATE_S / 2)
    wells = np.rint((half[PHI] + full[PHI]) / 2 / QUARTER)
    return np.asarray(
        np.where(np.abs(mean) > ROLLING_MEAN, 1e6 * np.sign(mean), wells).astype(np.int64)
    )


def stable_manifolds(wheel: Wheel, fastest: float) -> Array:
    """Points (phi, omega) of the edges between fates, (2, points), with phi within a quarter turn and omega from 0 to `fastest`.

    The others follow by quarter turns, and by reflection of both phi and omega.
    """
    phis, omegas = (
        np.linspace(-QUARTER / 2, QUARTER / 2, GRID + 1),
        np.linspace(0.0, fastest, GRID + 1),
    )
    grid = np.array(np.meshgrid(phis, omegas))
    found = fates(grid[0].ravel(), grid[1].ravel(), wheel).reshape(grid.shape[1:])
    ends = []
    for here, there in (
        ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
        ((slice(None, -1),), (slice(1, None),)),
    ):
        differ = found[here] != found[there]
        ends.append(np.array([grid[:, *here][:, differ], grid[:, *there][:, differ]]))
    one, other = np.concatenate(ends, axis=2)
    before = fates(one[0], one[1], wheel)
    for _ in range(HALVINGS):
        middle = (one + other) / 2
        same = fates(middle[0], middle[1], wheel) == before
        one, other = np.where(same, middle, one), np.where(same, other, middle)
    return np.asarray((one + other) / 2)


def cycle(wheel: Wheel) -> Array | None:
    """The limit cycle, (samples, 4), that a wheel pushed off the angle 0 comes to.

    Of none samples if it rests, None if it is irregular.
    """
    start = turning(np.array([0.01]), np.array([0.0]), wheel)
    states = path(advance(start, wheel.columns(1), SETTLED_S)[:, 0], wheel, WATCHED_S)
    x1, x2, phi, omega = states.T
    seen = np.array([x1, x2, np.cos(phi), np.sin(phi), omega / np.abs(omega).max(initial=SLOWEST)])
    distance = np.abs(seen - seen[:, :1]).max(axis=0)
    away = np.flatnonzero(distance > SAME)
    if not len(away):
        return states[:0]
    returned = np.flatnonzero(distance[away[0] :] < SAME)
    if not len(returned):
        return None
    back = away[0] + returned[0]
    back += int(np.argmin(distance[back : back + away[0]]))
    again = np.abs(seen[:, back : 2 * back] - seen[:, : seen[:, back : 2 * back].shape[1]]).max()
    return states[: back + 1] if again < 2 * SAME else None


def kind_of(found: Array | None) -> str:
    """S, FB or LLM, by the limit cycle that a wheel comes to; C if there is none."""
    if found is None:
        return "C"
    if not len(found):
        return "S"
    return "LLM" if abs(found[-1, PHI] - found[0, PHI]) > pi else "FB"


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """One portrait each. Raises WrongUse as `fixpoint` does."""
    ks = PAPERS_K if options["k"] is None else (options["k"],)
    for k in ks:
        fixpoint(0.0, wheel_of(options)._replace(k=k))
    return [{"k": k} for k in ks]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """A portrait, as points with phi and omega; `line` tells lines apart."""
    wheel = wheel_of(setting.options)._replace(k=cell["k"])
    rows: list[Row] = [
        {"part": point.kind, "line": n, "phi": point.phi, "omega": 0.0}
        for n, point in enumerate(fixpoints(wheel))
    ]
    unstable = unstable_manifolds(-QUARTER / 2, wheel)
    finer = unstable_manifolds(-QUARTER / 2, wheel, fineness=2 * FINENESS)
    off = float(np.abs(unstable - finer)[:, : unstable.shape[1] // 2, PHI].max())
    for line, states in enumerate(unstable):
        rows += _points("unstable manifold", line, states[:, [PHI, OMEGA]])
    fastest = REACH * float(np.abs(unstable[:, :, OMEGA]).max())
    found = cycle(wheel)
    if found is not None:  # between irregular wheels' fates there are no lines
        rows += _points("limit cycle", 0, found[:, [PHI, OMEGA]])
        rows += _points("stable manifold", 0, stable_manifolds(wheel, fastest).T)
    phi, omega = np.array(TRAJECTORIES).T
    for line, state in enumerate(turning(phi, fastest * omega, wheel).T):
        rows += _points("trajectory", line, path(state, wheel, FOLLOWED_S)[:, [PHI, OMEGA]])
    rows += [
        {
            "part": "found",
            "kind": kind_of(found),
            "fastest": fastest,
            "manifold_off_by": off,
            "crosses": _crosses(unstable),
        }
    ]
    return rows


def _points(part: str, line: int, points: Array) -> list[Row]:
    return [
        {"part": part, "line": line, "phi": phi, "omega": omega} for phi, omega in points.tolist()
    ]


def _crosses(unstable: Array) -> bool:
    """Whether the saddle's forward branch passes the next saddle."""
    return bool(unstable[0, :, PHI].max() > QUARTER / 2)


def report(rows: list[Row], setting: Setting) -> Findings:
    """M4."""
    wheel = wheel_of(setting.options)
    found = [row for row in rows if row["part"] == "found"]
    k_hopf = critical_k(wheel)
    numbers = {
        "portraits": [
            {
                "k": row["k"],
                "phase": row["kind"],
                "k_hopf": k_hopf,
                "unstable_manifold_passes_the_next_saddle": row["crosses"],
            }
            for row in found
        ],
        "accuracy": {
            "unstable_manifold_halved_step_rad": max(row["manifold_off_by"] for row in found)
        },
    }
    # By two ways each: what a wheel comes to, and what eigenvalues and the unstable manifold say.
    by_manifolds = [
        "S" if row["k"] < k_hopf else "LLM" if row["crosses"] else "FB" for row in found
    ]
    agreed = sum(
        row["kind"] == expected == PAPERS_K.get(row["k"], expected)
        for row, expected in zip(found, by_manifolds, strict=True)
    )
    claim = Claim(
        "M4",
        "tau = 0.25 s: k = 1.4 stationary, k = 1.65 forth-and-back, k = 1.85 locomotion",
        "the three portraits",
        float(agreed),
        f"of {len(found)} portraits",
        None,
        agreed == len(found),
        ", ".join(f"k = {row['k']:g}: {row['kind']}" for row in found)
        + f"; rest is unstable from k = {k_hopf:.4f}, and the saddles' unstable manifolds "
        + ", ".join(
            f"{'pass' if row['crosses'] else 'do not pass'} the next saddle at {row['k']:g}"
            for row in found
        ),
    )
    of_three = "" if len(found) == len(PAPERS_K) else "the claim is made for k = 1.4, 1.65 and 1.85"
    return Findings([claim.doubted(setting.elsewhere(**PAPER), of_three)], numbers)
