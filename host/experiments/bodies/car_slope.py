"""The paper's car between four slopes, for ten minutes.

Does it stay inside and on its wheels, and where does it go? (B1)

A car whose wheels turn opposite ways spins on the spot. Drag on the body does not brake that, so it
is another steady motion: a slope may throw the car into it, and then the car stays where it is.
"""

from __future__ import annotations

from typing import TypedDict, final

import numpy as np

from host.experiments.bodies.simulation import EDGE_M, Position, build_body, run_body, set_heading
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import fraction, wilson
from sim_motor.bodies.measures import FALLEN_RAD, STILL_RAD_S, reversals_s
from sim_motor.bodies.presets import PUSHED, preset

# The authors' programs have slopes of 0.3 rad, in a funnel, and of 0.37 rad: the claim is tested on
# these. Shallower slopes are shown beside them.
ANGLES, AUTHORS_ANGLES = (0.2, 0.3, 0.37), (0.3, 0.37)
EVERY_S = 0.2
# The claim is about this time (s).
CLAIMED_S = 600.0
# A car travels if its mean speed over MEAN_S (s) is higher than this (m/s). A slower car rests, or
# spins on the spot.
TRAVELS_M_S, MEAN_S = 0.1, 2.0
# The floor that a car has seen is counted in squares with this side (m).
SQUARE_M = 0.5


class Cell(TypedDict):
    """One car.

    Attributes:
        angle: of the slopes (rad).
        number: of its random heading at the start.
    """

    angle: float
    number: int


class Drive(TypedDict):
    """The whole drive.

    Attributes:
        inside: whether the car stayed on the floor and slopes.
        flipped: whether it fell over.
        reach_m: how far it got from the middle, along x or y (m).
        lean_rad: how far it leaned at most (rad).
        reversals: how often it reversed.
        path_m: length of its path (m).
        travelled: part of the time in which it travelled (1).
        spun: part of the time in which its wheels turned opposite ways (1).
        last_s: when it last travelled (s).
        squares: how many squares of the floor it was in.
    """

    inside: bool
    flipped: bool
    reach_m: float
    lean_rad: float
    reversals: int
    path_m: float
    travelled: float
    spun: float
    last_s: float
    squares: int


@final
class DriveRow(Cell, Drive):
    """A line of the table about a whole drive."""


@final
class PositionRow(Cell, Position):
    """A line of the table about where the car's middle is at one time."""


Row = DriveRow | PositionRow


class AngleNumbers(TypedDict):
    """All cars on slopes of one angle (rad).

    Numbers of cars, their median or mean or largest value, or the value of each car; see `Drive`.
    """

    angle: float
    cars: int
    inside: int
    flipped: int
    last_s_median: float
    travelled: float
    spun: float
    reach_m: float
    lean_rad: float
    reversals: list[int]
    path_m: list[float]
    last_s: list[float]
    squares: list[int]


class Numbers(TypedDict):
    """What the experiment found: an entry for each angle."""

    angles: list[AngleNumbers]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is one car; chance decides its heading at the start."""
    return [
        {"angle": angle, "number": number} for angle in ANGLES for number in range(options["seeds"])
    ]


def simulate(cell: Cell, setting: Setting) -> list[Drive | Position]:
    """The drive, and the car's positions, every EVERY_S."""
    seed = setting.seed_of({"number": cell["number"]})
    heading = float(np.random.default_rng(seed).uniform(0.0, 2 * np.pi))
    body = build_body(
        preset("paper"),
        "slopes",
        cars=1,
        seed=seed,
        angle=cell["angle"],
        phases=np.full(2, PUSHED),
        edit=set_heading(heading),
    )
    run = run_body(body, setting.options["seconds"])
    t, centre = run.course.t_s, run.course.centre_m
    span = round(MEAN_S / float(t[1]))
    travels = np.linalg.norm(centre[span:] - centre[:-span], axis=1) > TRAVELS_M_S * MEAN_S
    reach = float(np.abs(centre[:, :2]).max())
    rows: list[Drive | Position] = [
        {
            "inside": run.unstable_s is None and reach < EDGE_M,
            "flipped": bool((run.course.lean_rad > FALLEN_RAD).any()),
            "reach_m": reach,
            "lean_rad": float(run.course.lean_rad.max()),
            "reversals": len(reversals_s(run.course)),
            "path_m": float(np.linalg.norm(np.diff(centre, axis=0), axis=1).sum()),
            "travelled": float(travels.mean()),
            "spun": float((run.course.omega.prod(axis=1) < -(STILL_RAD_S**2)).mean()),
            "last_s": float(t[span:][travels][-1]) if travels.any() else 0.0,
            "squares": len(np.unique(np.floor(centre[:, :2] / SQUARE_M), axis=0)),
        }
    ]
    rows += run.positions(centre, EVERY_S)
    return rows


def drives(rows: list[Row]) -> list[DriveRow]:
    """The rows about whole drives."""
    return [row for row in rows if "inside" in row]


def positions(rows: list[Row]) -> list[PositionRow]:
    """The rows about single moments."""
    return [row for row in rows if "t_s" in row]


def report(rows: list[Row], setting: Setting) -> Findings:
    """B1."""
    whole = drives(rows)
    tried = [row for row in whole if row["angle"] in AUTHORS_ANGLES]
    seconds = setting.options["seconds"]
    good = sum(row["inside"] and not row["flipped"] for row in tried)
    angles = [
        _summarize_angle([row for row in whole if row["angle"] == angle], angle) for angle in ANGLES
    ]
    notes = [
        f"slopes of {cars['angle']:g} rad: {cars['inside']} of {cars['cars']} inside,"
        f" {cars['flipped']} flipped, on their way until {cars['last_s_median']:.0f} s (median),"
        f" for {cars['travelled']:.0%} of the time, spinning on the spot for {cars['spun']:.0%}, at"
        f" most {cars['reach_m']:.1f} m away"
        for cars in angles
    ]
    claim = Claim(
        "B1",
        SENTENCES["B1"],
        "all stay inside for 10 min, and do not flip",
        fraction(good, len(tried)),
        "1",
        wilson(good, len(tried)),
        good == len(tried) > 0,
        "; ".join(
            [f"the share of cars that stay upright inside: {good} of {len(tried)}, {seconds:g} s"]
            + notes
        ),
    )
    numbers: Numbers = {"angles": angles}
    return Findings([claim.doubted(setting.short_of(seconds=CLAIMED_S))], numbers)


def _summarize_angle(cars: list[DriveRow], angle: float) -> AngleNumbers:
    return {
        "angle": angle,
        "cars": len(cars),
        "inside": sum(row["inside"] for row in cars),
        "flipped": sum(row["flipped"] for row in cars),
        "last_s_median": float(np.median([row["last_s"] for row in cars])),
        "travelled": float(np.mean([row["travelled"] for row in cars])),
        "spun": float(np.mean([row["spun"] for row in cars])),
        "reach_m": max(row["reach_m"] for row in cars),
        "lean_rad": max(row["lean_rad"] for row in cars),
        "reversals": [row["reversals"] for row in cars],
        "path_m": [row["path_m"] for row in cars],
        "last_s": [row["last_s"] for row in cars],
        "squares": [row["squares"] for row in cars],
    }
