"""The paper's car between four slopes, for ten minutes.

Whether it stays inside and on its wheels, and where it goes (B1).

Drag on the body does not brake a car that spins on the spot, its wheels turning opposite ways. That
is another of its steady motions, into which a slope may throw it, and in which it stays where it
is.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.experiments.bodies.stage import EDGE_M, headed, made, ran
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import fraction, wilson
from sim_motor.bodies.measures import FALLEN_RAD, STILL_RAD_S, reversals_s
from sim_motor.bodies.presets import PUSHED, preset

# The slopes of the authors' programs are of 0.3 rad, in a funnel, and of 0.37 rad; the claim is
# tried on both, and shallower ones shown.
ANGLES, THEIRS = (0.2, 0.3, 0.37), (0.3, 0.37)
EVERY_S = 0.2
CLAIMED_S = 600.0
# A car that goes more slowly (m/s), on the mean over so long (s), is not on its way any more: it
# rests, or turns on the spot.
TRAVELS_M_S, MEAN_S = 0.1, 2.0
# The floor is counted in squares of this side (m).
SQUARE_M = 0.5


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A car each; its chance is its heading at the start."""
    return [
        {"angle": angle, "number": number} for angle in ANGLES for number in range(options["seeds"])
    ]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The run in a row, and the car's way, every EVERY_S.

    last_s: until when it was on its way. travelled, spun: for what part of the time it was, and its
    wheels turned opposite ways. squares: how many of SQUARE_M it was in.
    """
    seed, own = setting.seed_of({"number": cell["number"]}), preset("paper")
    heading = float(np.random.default_rng(seed).uniform(0.0, 2 * np.pi))
    phases = np.full(2, PUSHED)
    body = made(
        own, "slopes", 1, seed=seed, angle=cell["angle"], phases=phases, prepare=headed(heading)
    )
    did = ran(body, setting.options["seconds"])
    t, centre = did.moved.t_s, did.moved.centre_m
    span = round(MEAN_S / float(t[1]))
    travels = np.linalg.norm(centre[span:] - centre[:-span], axis=1) > TRAVELS_M_S * MEAN_S
    run: Row = {
        "inside": did.broke_s is None and float(np.abs(centre[:, :2]).max()) < EDGE_M,
        "flipped": bool((did.moved.lean_rad > FALLEN_RAD).any()),
        "reach_m": float(np.abs(centre[:, :2]).max()),
        "lean_rad": float(did.moved.lean_rad.max()),
        "reversals": len(reversals_s(did.moved)),
        "path_m": float(np.linalg.norm(np.diff(centre, axis=0), axis=1).sum()),
        "travelled": float(travels.mean()),
        "spun": float((did.moved.omega.prod(axis=1) < -(STILL_RAD_S**2)).mean()),
        "last_s": float(t[span:][travels][-1]) if travels.any() else 0.0,
        "squares": len(np.unique(np.floor(centre[:, :2] / SQUARE_M), axis=0)),
    }
    return [
        run,
        *(
            {"t_s": float(t[at]), "x_m": float(centre[at, 0]), "y_m": float(centre[at, 1])}
            for at in did.every(EVERY_S)
        ),
    ]


def runs_of(rows: list[Row]) -> list[Row]:
    """The rows that tell of a whole run."""
    return [row for row in rows if "inside" in row]


def report(rows: list[Row], setting: Setting) -> Findings:
    """B1."""
    runs = runs_of(rows)
    tried = [row for row in runs if row["angle"] in THEIRS]
    seconds = setting.options["seconds"]
    good = sum(row["inside"] and not row["flipped"] for row in tried)
    numbers = [_angle([row for row in runs if row["angle"] == angle], angle) for angle in ANGLES]
    notes = [
        f"slopes of {told['angle']:g} rad: {told['inside']} of {told['cars']} inside,"
        f" {told['flipped']} flipped, on their way until {told['last_s_median']:.0f} s (median),"
        f" for {told['travelled']:.0%} of the time, spinning on the spot for {told['spun']:.0%}, at"
        f" most {told['reach_m']:.1f} m away"
        for told in numbers
    ]
    claim = Claim(
        "B1",
        "a car with one rod for each wheel follows intricate trajectories inside confining slopes",
        "all stay inside for 10 min, and do not flip",
        fraction(good, len(tried)),
        "1",
        wilson(good, len(tried)),
        good == len(tried) > 0,
        "; ".join([f"{good} of {len(tried)} for {seconds:g} s", *notes]),
    )
    return Findings([claim.doubted(setting.short_of(seconds=CLAIMED_S))], {"angles": numbers})


def _angle(runs: list[Row], angle: float) -> dict[str, Any]:
    return {
        "angle": angle,
        "cars": len(runs),
        "inside": sum(row["inside"] for row in runs),
        "flipped": sum(row["flipped"] for row in runs),
        "last_s_median": float(np.median([row["last_s"] for row in runs])),
        "travelled": float(np.mean([row["travelled"] for row in runs])),
        "spun": float(np.mean([row["spun"] for row in runs])),
        "reach_m": max(row["reach_m"] for row in runs),
        "lean_rad": max(row["lean_rad"] for row in runs),
        "reversals": [row["reversals"] for row in runs],
        "path_m": [row["path_m"] for row in runs],
        "last_s": [row["last_s"] for row in runs],
        "squares": [row["squares"] for row in runs],
    }
