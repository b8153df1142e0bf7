"""A train between two walls, which no sensor reports to it.

How often does it reverse as a whole? (B3) Beside it, a train whose wheels have a constant torque
instead of a controller. A train that hits a wall at an angle may turn along it, and leave sideways,
where there is no wall; or it rests at a wall, its rods at their dead centres. Walls are dead or
bouncy, as in LPZRobots.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from typing import TypedDict, final

import numpy as np

from host.experiments.bodies.simulation import ORDERED, BodyRun, build_body, run_body
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from sim_motor.bodies.measures import reversals_s
from sim_motor.bodies.presets import Preset, preset

# The constant force at a wheel's rim, as a part of k: "calculated from mean angular velocity" in
# the program of 2019.
CONSTANT = 0.162
# The claim wants this many reversals.
LEAST = 5
# A median takes this many trains of each kind, and that many reversals this time (s).
LEAST_TRAINS, LEAST_S = 3, 60.0
# Positions are this far apart (s).
EVERY_S = 0.05
# A reversal counts as one of the whole train if its wheels are ordered in this time after it (s).
WHOLE_S = (0.5, 1.5)
# A train that stays within STUCK_M (m) in the last END_S (s) is stuck.
END_S, STUCK_M = 5.0, 0.25
STUCK, RUNS, LOST = "stuck", "runs", "could not be followed"


class Train(TypedDict):
    """One kind of train.

    Attributes:
        preset: name of the preset.
        drag: of the wheels (N s/rad); None is the preset's.
    """

    preset: str
    drag: float | None


class Kind(Train):
    """One kind of train between one kind of walls.

    Attributes:
        bouncy: whether the walls throw the train back.
    """

    bouncy: bool


class DrivenKind(Kind):
    """One kind of train between one kind of walls.

    Attributes:
        controller: whether a controller drives the train; otherwise a constant torque does.
    """

    controller: bool


class Cell(DrivenKind):
    """One train.

    Attributes:
        number: of its wheels' random phases at the start.
    """

    number: int


class Run(TypedDict):
    """The whole run.

    Attributes:
        reversals_s: when most wheels reversed (s).
        whole: how many of these times all wheels went one way soon after.
        aside_m: how far the train is along the walls in the end (m).
        ended: 'stuck', 'runs' or 'could not be followed'.
    """

    reversals_s: list[float]
    whole: int
    aside_m: float
    ended: str


class Moment(TypedDict):
    """The train at one time.

    Attributes:
        t_s: time since the start (s).
        x_m: x of its middle (m).
        omega_rad_s: mean omega of its wheels (rad/s).
    """

    t_s: float
    x_m: float
    omega_rad_s: float


@final
class RunRow(Cell, Run):
    """A line of the table about a whole run."""


@final
class MomentRow(Cell, Moment):
    """A line of the table about one moment of a run."""


Row = RunRow | MomentRow


class ConstantTorque(TypedDict):
    """The run with a constant torque: how often most wheels reversed, and how it ended."""

    reversals: int
    ended: str


class KindNumbers(Kind):
    """All runs of one kind.

    Attributes:
        reversals: of the whole train, for each run.
        not_whole: how many other reversals there were in all.
        ended: how many runs ended in each way.
        aside_m: for each run (m).
        leg_s_median: median time between reversals (s), or None.
    """

    reversals: list[int]
    not_whole: int
    ended: dict[str, int]
    aside_m: list[float]
    leg_s_median: float | None
    constant_torque: ConstantTorque


class Numbers(TypedDict):
    """What the experiment found: an entry for each kind."""

    kinds: list[KindNumbers]


# The presets', and that of 2019 with the drag (N s/rad) with which its authors' program was also
# run.
TRAINS: tuple[Train, ...] = (
    {"preset": "paper", "drag": None},
    {"preset": "snake2019", "drag": None},
    {"preset": "snake2019", "drag": 0.005},
)
KINDS: tuple[Kind, ...] = tuple(
    {"preset": train["preset"], "drag": train["drag"], "bouncy": bouncy}
    for train in TRAINS
    for bouncy in (False, True)
)


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is one train; one with a constant torque starts from one set of phases only."""
    numbers = range(options["seeds"])
    found: list[Cell] = []
    found += [
        {**kind, "controller": True, "number": number} for kind in KINDS for number in numbers
    ]
    found += [{**kind, "controller": False, "number": 0} for kind in KINDS]
    return found


def simulate(cell: Cell, setting: Setting) -> list[Run | Moment]:
    """The run, and for number 0 also its moments, every EVERY_S."""
    own = _train_preset(cell)
    torque = None if cell["controller"] else CONSTANT * own.k * own.wheel_radius
    seed = setting.seed_of({"number": cell["number"]})  # the same start between all walls
    body = build_body(own, "walls", seed=seed, bouncy=cell["bouncy"], torque=torque)
    run = run_body(body, setting.options["seconds"])
    rows: list[Run | Moment] = [summarize_run(run)]
    if cell["number"] == 0:
        omega = run.course.omega.mean(axis=1)
        rows += [
            {
                "t_s": float(run.course.t_s[at]),
                "x_m": float(run.course.centre_m[at, 0]),
                "omega_rad_s": float(omega[at]),
            }
            for at in run.every(EVERY_S)
        ]
    return rows


def _train_preset(train: Train) -> Preset:
    own = preset(train["preset"])
    return own if train["drag"] is None else own.with_drag(train["drag"])


def summarize_run(run: BodyRun) -> Run:
    """When a train reversed, and how it ended."""
    course, order = run.course, run.order
    times = reversals_s(course)
    whole = 0
    for time in times:
        soon = (course.t_s >= time + WHOLE_S[0]) & (course.t_s <= time + WHOLE_S[1])
        whole += bool(soon.any() and order[soon].mean() > ORDERED)
    rests = np.ptp(course.centre_m[run.last(END_S)], axis=0).max() < STUCK_M
    ended = STUCK if rests else RUNS
    if run.unstable_s is not None:
        ended = LOST
    return {
        "reversals_s": times,
        "whole": whole,
        "aside_m": float(abs(course.centre_m[-1, 1])),
        "ended": ended,
    }


def whole_runs(rows: list[Row], kind: DrivenKind) -> list[RunRow]:
    """The rows about whole runs of one kind."""
    return [row for row in rows if "ended" in row and kind.items() <= row.items()]


def moments(rows: list[Row], kind: DrivenKind) -> list[MomentRow]:
    """The rows about single moments of the first run of one kind."""
    return [row for row in rows if "t_s" in row and kind.items() <= row.items()]


def report(rows: list[Row], setting: Setting) -> Findings:
    """B3, judged by the preset that reverses less often.

    Each preset counts between the walls at which it reverses more often, by the median of its runs.
    """
    kinds = [_summarize_kind(rows, kind) for kind in KINDS]
    least = min(
        max(
            _median_reversals(kind)
            for kind in kinds
            if kind["preset"] == name and kind["drag"] is None
        )
        for name in ("paper", "snake2019")
    )
    still = all(kind["constant_torque"]["ended"] == STUCK for kind in kinds)
    claim = Claim(
        "B3",
        SENTENCES["B3"],
        f">= {LEAST} reversals in a row in both presets; a train with constant torque gets stuck",
        least,
        "1",
        None,
        least >= LEAST and still,
        f"the reversals in {setting.options['seconds']:g} s, median of the runs, in the preset that"
        " has fewer; " + "; ".join(map(_describe_kind, kinds)),
    )
    numbers: Numbers = {"kinds": kinds}
    doubt = setting.short_of(seeds=LEAST_TRAINS, seconds=LEAST_S)
    return Findings([claim.doubted(doubt)], numbers)


def _summarize_kind(rows: list[Row], kind: Kind) -> KindNumbers:
    runs = whole_runs(rows, {**kind, "controller": True})
    legs = [later - earlier for row in runs for earlier, later in pairwise(row["reversals_s"])]
    (constant,) = whole_runs(rows, {**kind, "controller": False})
    return {
        **kind,
        "reversals": [row["whole"] for row in runs],
        "not_whole": sum(len(row["reversals_s"]) - row["whole"] for row in runs),
        "ended": dict(Counter(row["ended"] for row in runs)),
        "aside_m": [round(row["aside_m"], 1) for row in runs],
        "leg_s_median": float(np.median(legs)) if legs else None,
        "constant_torque": {"reversals": len(constant["reversals_s"]), "ended": constant["ended"]},
    }


def _median_reversals(kind: KindNumbers) -> float:
    return float(np.median(kind["reversals"]))


def name_train(train: Train) -> str:
    """A train in words."""
    if train["drag"] is None:
        return train["preset"]
    return f"{train['preset']} with drag {train['drag']:g} N s/rad"


def _describe_kind(kind: KindNumbers) -> str:
    walls = "bouncy" if kind["bouncy"] else "dead"
    counts = " ".join(str(count) for count in kind["reversals"])
    ended = ", ".join(f"{count} {how}" for how, count in kind["ended"].items())
    return f"{name_train(kind)}, {walls} walls: {counts} reversals, in the end {ended}"
