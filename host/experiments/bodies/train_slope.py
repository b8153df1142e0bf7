"""A train on a floor between four slopes.

Does it turn back at them as a whole, and stay inside? Over the slopes' angle and k.
"""

from __future__ import annotations

from typing import TypedDict, final

import numpy as np

from host.experiments.bodies.simulation import (
    EDGE_M,
    ORDERED,
    Position,
    build_body,
    run_body,
    set_heading,
)
from host.runs.contract import Findings, Options, Setting
from sim_motor.bodies.measures import FALLEN_RAD, reversals_s, started_s
from sim_motor.bodies.presets import preset

EVERY_S = 0.1


class Train(TypedDict):
    """One kind of train.

    Attributes:
        preset: name of the preset.
        k: spring constant of its rods (N).
    """

    preset: str
    k: float


class Kind(Train):
    """One kind of train on slopes of one angle.

    Attributes:
        angle: of the slopes (rad).
    """

    angle: float


class Cell(Kind):
    """One train.

    Attributes:
        number: number of the random phases and heading at the start.
    """

    number: int


class Run(TypedDict):
    """The whole run.

    Attributes:
        reversals: how often the train reversed.
        coherent: part of the time after start-up in which the order parameter is above ORDERED
            (1); None if the train never moved.
        reach_m: how far its middle got from the floor's, along x or y (m).
        inside: whether it stayed on the floor and slopes.
        flipped: whether a car fell over.
    """

    reversals: int
    coherent: float | None
    reach_m: float
    inside: bool
    flipped: bool


@final
class RunRow(Cell, Run):
    """A line of the table about a whole run."""


@final
class PositionRow(Cell, Position):
    """A line of the table about where the train's head is at one time."""


Row = RunRow | PositionRow


class KindNumbers(Kind):
    """All runs of one kind: means over them, and how many of them stayed inside or fell over.

    Attributes:
        reach_m: the largest.
    """

    runs: int
    reversals_a_minute: float
    coherent: float | None
    inside: int
    flipped: int
    reach_m: float


class Numbers(TypedDict):
    """What the experiment found: an entry for each train and angle."""

    trains: list[KindNumbers]


# The presets', and the paper's train with a larger k: its authors' program had k = 2 N for ten
# times the mass.
TRAINS: tuple[Train, ...] = (
    {"preset": "paper", "k": 0.5},
    {"preset": "paper", "k": 1.0},
    {"preset": "paper", "k": 2.0},
    {"preset": "snake2019", "k": 2.0},
)
ANGLES = (0.1, 0.2, 0.27, 0.35, 0.5)
# These paths are shown: the presets', on slopes like those of the program of 2019 (0.27 rad).
SHOWN: tuple[Kind, ...] = (
    {"preset": "paper", "k": 0.5, "angle": 0.27},
    {"preset": "snake2019", "k": 2.0, "angle": 0.27},
)


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is one train, from random phases, with a random heading."""
    return [
        {**train, "angle": angle, "number": number}
        for train in TRAINS
        for angle in ANGLES
        for number in range(options["seeds"])
    ]


def simulate(cell: Cell, setting: Setting) -> list[Run | Position]:
    """The run, and if it is SHOWN also the head's positions, every EVERY_S."""
    seed = setting.seed_of(cell)
    heading = float(np.random.default_rng(seed).uniform(0.0, 2 * np.pi))
    own = preset(cell["preset"])._replace(k=cell["k"])
    edit = set_heading(heading)
    run = run_body(
        build_body(own, "slopes", seed=seed, angle=cell["angle"], edit=edit),
        setting.options["seconds"],
    )
    course, started = run.course, started_s(run.course)
    coherent = None
    if started is not None:
        coherent = float((run.order[course.t_s >= started] > ORDERED).mean())
    reach = float(np.abs(course.centre_m[:, :2]).max())
    rows: list[Run | Position] = [
        {
            "reversals": len(reversals_s(course)),
            "coherent": coherent,
            "reach_m": reach,
            "inside": reach < EDGE_M and run.unstable_s is None,
            "flipped": bool((course.lean_rad > FALLEN_RAD).any()),
        }
    ]
    if cell["number"] == 0 and any(kind.items() <= cell.items() for kind in SHOWN):
        rows += run.positions(run.head, EVERY_S)
    return rows


def whole_runs(rows: list[Row]) -> list[RunRow]:
    """The rows about whole runs."""
    return [row for row in rows if "inside" in row]


def positions(rows: list[Row], kind: Kind) -> list[PositionRow]:
    """The rows about single moments of the shown run of one kind."""
    return [row for row in rows if "t_s" in row and kind.items() <= row.items()]


def report(rows: list[Row], setting: Setting) -> Findings:
    """By train and angle: means over the runs, and how many stayed inside.

    No claim of the paper.
    """
    kinds: list[Kind] = [{**train, "angle": angle} for train in TRAINS for angle in ANGLES]
    numbers: Numbers = {
        "trains": [
            _summarize_kind(
                kind,
                [row for row in whole_runs(rows) if kind.items() <= row.items()],
                setting.options["seconds"],
            )
            for kind in kinds
        ]
    }
    return Findings([], numbers)


def _summarize_kind(kind: Kind, runs: list[RunRow], seconds: float) -> KindNumbers:
    coherent = [row["coherent"] for row in runs if row["coherent"] is not None]
    return {
        **kind,
        "runs": len(runs),
        "reversals_a_minute": float(np.mean([row["reversals"] for row in runs])) * 60.0 / seconds,
        "coherent": float(np.mean(coherent)) if coherent else None,
        "inside": sum(row["inside"] for row in runs),
        "flipped": sum(row["flipped"] for row in runs),
        "reach_m": max(row["reach_m"] for row in runs),
    }
