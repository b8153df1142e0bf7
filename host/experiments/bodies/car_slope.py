"""The paper's car between four slopes, for ten minutes.

Does it stay inside and on its wheels, and where does it go? (B1)

A car whose wheels turn opposite ways spins on the spot. Drag on the body does not brake that, so it
is another steady motion: a slope may throw the car into it, and then the car stays where it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypedDict, final

import numpy as np

from host.experiments.bodies.simulation import EDGE_M, Position, build_body, run_body, set_heading
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Part, Setting, as_rows
from host.runs.contract import Row as PlainRow
from host.util.intervals import fraction, wilson
from sim_motor.bodies.measures import FALLEN_RAD, STILL_RAD_S, Course
from sim_motor.bodies.presets import PUSHED, preset
from sim_motor.bodies.running_summary import Reversals

if TYPE_CHECKING:
    from sim_motor.bodies.body import Body

# The authors' programs have slopes of 0.3 rad, in a funnel, and of 0.37 rad: the claim is tested on
# these. Shallower slopes are shown beside them.
ANGLES, AUTHORS_ANGLES = (0.2, 0.3, 0.37), (0.3, 0.37)
EVERY_S = 0.2
# The part of a drive that is computed at once (s): a second or two.
PART_S = 100.0
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
        number: number of the random heading at the start.
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


def simulate(cell: Cell, setting: Setting) -> list[PlainRow]:
    """The car's positions, every EVERY_S, and the drive."""
    return [row for part in parts(cell, setting, None) for row in part.rows]


def parts(cell: Cell, setting: Setting, begun: Part | None) -> Iterator[Part]:
    """The same, PART_S at a time."""
    while begun is None or begun.share < 1.0:
        begun = _go_on(cell, setting, begun)
        yield begun


def _go_on(cell: Cell, setting: Setting, begun: Part | None) -> Part:
    """The next part of a drive."""
    body, way = _build(cell, setting), Way()
    if begun is not None:
        body.resume(begun.state["body"])
        way = Way.of(begun.state["way"])
    seconds = setting.options["seconds"]
    left_s = seconds - body.time_s
    run = run_body(body, min(PART_S, left_s))
    rows = as_rows(way.add(run.course, body.record_s))
    if run.unstable_s is None and left_s > PART_S:
        return Part(rows, {"body": body.state, "way": way.state}, body.time_s / seconds)
    return Part([*rows, dict(way.drive(stable=run.unstable_s is None))])


def _build(cell: Cell, setting: Setting) -> Body:
    seed = setting.seed_of({"number": cell["number"]})
    heading = float(np.random.default_rng(seed).uniform(0.0, 2 * np.pi))
    return build_body(
        preset("paper"),
        "slopes",
        cars=1,
        seed=seed,
        angle=cell["angle"],
        phases=np.full(2, PUSHED),
        edit=set_heading(heading),
    )


@dataclass
class Way:
    """A drive so far. All of it but `reversals` is plain data.

    Attributes:
        rows: number of rows, which are the car's states.
        reach_m: see `Drive`; so are lean_rad, path_m and last_s.
        windows: number of rows MEAN_S or more after the start.
        travels: number of these in which it travelled.
        spins: number of rows in which its wheels turned opposite ways.
        squares: the squares of the floor in which it was, (squares, 2).
        latest_m: where its middle was in the last MEAN_S, (rows, 3).
        reversals: when it reversed.
    """

    rows: int = 0
    reach_m: float = 0.0
    lean_rad: float = 0.0
    path_m: float = 0.0
    last_s: float = 0.0
    windows: int = 0
    travels: int = 0
    spins: int = 0
    squares: list[list[float]] = field(default_factory=list)
    latest_m: list[list[float]] = field(default_factory=list)
    reversals: Reversals = field(default_factory=Reversals)

    @classmethod
    def of(cls, state: dict[str, Any]) -> Way:
        """Go on from a `state`."""
        return cls(**{**state, "reversals": Reversals.of(state["reversals"])})

    @property
    def state(self) -> dict[str, Any]:
        """All of it as plain data."""
        return {**vars(self), "reversals": self.reversals.state}

    def add(self, course: Course, every_s: float) -> list[Position]:
        """Take the rows that follow.

        Args:
            course: The rows. All parts but the first begin with the last row of the part before.
            every_s: Time between rows, s.

        Returns:
            The new ones of the car's positions, EVERY_S apart.
        """
        new = slice(1 if self.rows else 0, None)
        t_s, omega, centre = course.t_s[new], course.omega[new], course.centre_m[new]
        span, step = round(MEAN_S / every_s), round(EVERY_S / every_s)
        known = np.array([*self.latest_m, *centre])
        travels = np.linalg.norm(known[span:] - known[:-span], axis=1) > TRAVELS_M_S * MEAN_S
        if travels.any():
            self.last_s = float(t_s[-len(travels) :][travels][-1])
        self.windows += len(travels)
        self.travels += int(travels.sum())
        self.spins += int((omega.prod(axis=1) < -(STILL_RAD_S**2)).sum())
        self.reach_m = max(self.reach_m, float(np.abs(course.centre_m[:, :2]).max()))
        self.lean_rad = max(self.lean_rad, float(course.lean_rad.max()))
        self.path_m += float(np.linalg.norm(np.diff(course.centre_m, axis=0), axis=1).sum())
        seen = np.array([*self.squares, *np.floor(centre[:, :2] / SQUARE_M)])
        self.squares = np.unique(seen, axis=0).tolist()
        self.latest_m = known[-span:].tolist()
        before_s = np.append(course.t_s[:1], course.t_s[:-1])[new].tolist()
        for mean, time_s in zip(omega.mean(axis=1).tolist(), before_s, strict=True):
            self.reversals.add(mean, time_s)
        shown = range(-self.rows % step, len(t_s), step)
        self.rows += len(t_s)
        return [
            {"t_s": float(t_s[at]), "x_m": float(centre[at, 0]), "y_m": float(centre[at, 1])}
            for at in shown
        ]

    def drive(self, *, stable: bool) -> Drive:
        """The whole drive."""
        return {
            "inside": stable and self.reach_m < EDGE_M,
            "flipped": self.lean_rad > FALLEN_RAD,
            "reach_m": self.reach_m,
            "lean_rad": self.lean_rad,
            "reversals": len(self.reversals.times_s()),
            "path_m": self.path_m,
            "travelled": fraction(self.travels, self.windows),
            "spun": self.spins / self.rows,
            "last_s": self.last_s,
            "squares": len(self.squares),
        }


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
