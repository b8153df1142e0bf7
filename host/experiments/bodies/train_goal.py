"""Can kicks drive a train, which nobody steers, to a goal?

Planned kicks, beside random ones and none. Beyond the paper.

The goal is 3 m from the train's middle, in any direction. It is reached if the middle comes within
0.2 m, a quarter of the train's length. The train is that of 2019: the same kicks turn the paper's
train, which has weaker wheels and equally stiff springs, on a circle of 10 m instead of 2 m.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypedDict

import numpy as np

from host.bodies.steering import (
    CHOICES,
    KICK_S,
    LOOK_S,
    NO_KICK,
    Array,
    Drive,
    build_environment,
    learn,
    plan,
    relative_to,
)
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import wilson

# Chooses what to do at a pose, after the last choice, to get to a goal.
Chooser = Callable[[Array, int, Array], int]

PRESET = "snake2019"
PLANNED, RANDOM, NONE = "planned kicks", "random kicks", "no kicks"
WAYS = (PLANNED, RANDOM, NONE)
# How far away a goal is (m), how near counts as there (m), and how long the train may take (s).
AWAY_M, REACHED_M, LIMIT_S = 3.0, 0.2, 30.0
# How often a train that plans has tried every choice after every other.
ROUNDS = 2


class Cell(TypedDict):
    """One train on its way to a goal.

    Attributes:
        goal: number of the goal.
        way: one of WAYS.
    """

    goal: int
    way: str


class Trip(TypedDict):
    """What the train did, as seen from its pose at the start.

    Attributes:
        goal_m: where the goal is, ahead and to the left (m).
        reached_s: when the train was there (s), or None.
        nearest_m: how near it came (m).
        choices: what it chose, every KICK_S s, as the choice's number.
        course: its places, ahead and to the left (m), and its heading to the left (rad), every
            LOOK_S s.
        effects: what it learned that a choice does in KICK_S s, by last choice and choice:
            ahead and to the left (m), and to the left (rad); None if it did not plan.
    """

    goal_m: list[float]
    reached_s: float | None
    nearest_m: float
    choices: list[int]
    course: list[list[float]]
    effects: list[list[list[float]]] | None


class Row(Cell, Trip):
    """One line of the table: the cell, and what its train did."""


class WayNumbers(TypedDict):
    """All trains that were kicked in one way.

    Attributes:
        goals: how many there were.
        reached: how many trains came there.
        interval: of that rate (95 %).
        median_s: when they came there (s), or None.
        median_nearest_m: how near all trains came (m).
        mean_kicks: how often a train was kicked.
    """

    way: str
    goals: int
    reached: int
    interval: list[float]
    median_s: float | None
    median_nearest_m: float
    mean_kicks: float


class Effect(TypedDict):
    """What a choice does in KICK_S, mean over all trains that learned it.

    Attributes:
        after: 'on' (no kick), 'left' or 'right'.
        choice: 'on' (no kick), 'left' or 'right'.
    """

    after: str
    choice: str
    m_ahead_m_left_rad_left: list[float]


class Numbers(TypedDict):
    """What the experiment found, with what it was done with."""

    preset: str
    away_m: float
    reached_m: float
    limit_s: float
    ways: list[WayNumbers]
    learned: list[Effect]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Every goal, in each way."""
    return [{"goal": goal, "way": way} for goal in range(options["goals"]) for way in WAYS]


def simulate(cell: Cell, setting: Setting) -> list[Trip]:
    """Drive one train to its goal.

    The train's start and its goal are the same for all ways. A train that plans learns on another
    drive first.
    """
    rng = np.random.default_rng(setting.seed_of({"goal": cell["goal"]}))
    bearing = rng.uniform(-np.pi, np.pi)
    goal, seed = AWAY_M * np.array([np.cos(bearing), np.sin(bearing)]), int(rng.integers(2**31))
    train, effects = build_environment(PRESET), None
    choose: Chooser = _choose_nothing
    if cell["way"] == RANDOM:
        choose = partial(_choose_by_chance, rng)
    if cell["way"] == PLANNED:
        effects = learn(train, int(rng.integers(2**31)), ROUNDS)
        choose = partial(plan, effects)
    drive = Drive(train, seed)
    course = drive_to(drive, goal, choose)
    away = np.hypot(*(course[:, :2] - goal).T)
    there = np.flatnonzero(away <= REACHED_M)
    return [
        {
            "goal_m": goal.tolist(),
            "reached_s": round(int(there[0]) * LOOK_S, 3) if len(there) else None,
            "nearest_m": float(away.min()),
            "choices": drive.choices,
            "course": np.round(course, 3).tolist(),
            "effects": None if effects is None else effects[:, :, -1].tolist(),
        }
    ]


def drive_to(drive: Drive, goal: Array, choose: Chooser) -> Array:
    """Drive a train until it is at the goal, or until LIMIT_S.

    Args:
        drive: the train on its way.
        goal: (m ahead, m to the left) of where the train is now.
        choose: decides what to do next.

    Returns:
        Its course as seen from where it is now, (times, 3), every LOOK_S.
    """
    origin = drive.poses[-1]
    while True:
        course = relative_to(origin, drive.poses)
        reached = np.hypot(*(course[:, :2] - goal).T).min() <= REACHED_M
        if reached or len(drive.choices) * KICK_S >= LIMIT_S:
            return course
        drive.choose(choose(course[-1], drive.last, goal))


def _choose_by_chance(rng: np.random.Generator, start: Array, last: int, goal: Array) -> int:
    return int(rng.choice(CHOICES))


def _choose_nothing(start: Array, last: int, goal: Array) -> int:
    return NO_KICK


def report(rows: list[Row], setting: Setting) -> Findings:
    """How many trains reach the goal in each way, when, and with how many kicks.

    No claim of the paper.
    """
    effects = np.array([row["effects"] for row in rows if row["effects"] is not None])
    names = ("on", "left", "right")
    learned: list[Effect] = [
        {
            "after": names[last],
            "choice": names[choice],
            "m_ahead_m_left_rad_left": effects[:, last, choice].mean(axis=0).tolist(),
        }
        for last in CHOICES
        for choice in CHOICES
    ]
    numbers: Numbers = {
        "preset": PRESET,
        "away_m": AWAY_M,
        "reached_m": REACHED_M,
        "limit_s": LIMIT_S,
        "ways": [_summarize_way(way, [row for row in rows if row["way"] == way]) for way in WAYS],
        "learned": learned,
    }
    return Findings([], numbers)


def _summarize_way(way: str, trains: list[Row]) -> WayNumbers:
    times = [row["reached_s"] for row in trains if row["reached_s"] is not None]
    kicks = [sum(choice != NO_KICK for choice in row["choices"]) for row in trains]
    return {
        "way": way,
        "goals": len(trains),
        "reached": len(times),
        "interval": list(wilson(len(times), len(trains))),
        "median_s": float(np.median(times)) if times else None,
        "median_nearest_m": float(np.median([row["nearest_m"] for row in trains])),
        "mean_kicks": float(np.mean(kicks)),
    }
