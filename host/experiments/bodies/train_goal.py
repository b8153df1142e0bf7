"""Whether kicks can drive a train that nobody steers to a goal (beyond the paper).

Planned ones, beside random ones and none.

The goal is 3 m from the train's middle, anywhere around it, and reached if the middle comes within
0.2 m of it, a quarter of the train's length. The train of 2019 is taken: the same kicks turn the
paper's, which has weaker wheels and springs as stiff, on a circle of 10 m instead of 2 m.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from host.bodies.steering import (
    CHOICES,
    KICK_S,
    LOOK_S,
    ON,
    Array,
    Drive,
    environment,
    learn,
    plan,
    seen_from,
)
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import wilson

# What to do at a pose, after a last choice, to come to a goal.
Chooser = Callable[[Array, int, Array], int]

PRESET = "snake2019"
PLANNED, RANDOM, NONE = "planned kicks", "random kicks", "no kicks"
WAYS = (PLANNED, RANDOM, NONE)
# A goal is so far away (m), and reached if it is as near as this (m) within so long (s).
AWAY_M, REACHED_M, LIMIT_S = 3.0, 0.2, 30.0
# How often a train that plans has tried every choice after every other.
ROUNDS = 2


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Every goal, each way."""
    return [{"goal": goal, "way": way} for goal in range(options["goals"]) for way in WAYS]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """A train on its way to a goal: when it was there, if so; how near it came.

    And its course, as seen from where it was asked to go.

    What a train begins with and where its goal is are the same for all ways. One that plans learns
    on another drive first.
    """
    rng = np.random.default_rng(setting.seed_of({"goal": cell["goal"]}))
    bearing = rng.uniform(-np.pi, np.pi)
    goal, seed = AWAY_M * np.array([np.cos(bearing), np.sin(bearing)]), int(rng.integers(2**31))
    train, effects = environment(PRESET), None
    choose: Chooser = partial(_at_random, rng) if cell["way"] == RANDOM else _never
    if cell["way"] == PLANNED:
        effects = learn(train, int(rng.integers(2**31)), ROUNDS)
        choose = partial(plan, effects)
    drive = Drive(train, seed)
    course = go(drive, goal, choose)
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


def go(drive: Drive, goal: Array, choose: Chooser) -> Array:
    """Let a train go to the goal, as seen from where it is, or until LIMIT_S.

    Returns its course, (times, 3), seen from there.
    """
    origin = drive.poses[-1]
    while True:
        course = seen_from(origin, drive.poses)
        if (
            np.hypot(*(course[:, :2] - goal).T).min() <= REACHED_M
            or len(drive.choices) * KICK_S >= LIMIT_S
        ):
            return course
        drive.choose(choose(course[-1], drive.last, goal))


def _at_random(rng: np.random.Generator, start: Array, last: int, goal: Array) -> int:
    return int(rng.choice(CHOICES))


def _never(start: Array, last: int, goal: Array) -> int:
    return ON


def report(rows: list[Row], setting: Setting) -> Findings:
    """How often, how soon and with how many kicks each way leads there; no claim of the paper."""
    ways = []
    for way in WAYS:
        own = [row for row in rows if row["way"] == way]
        times = [row["reached_s"] for row in own if row["reached_s"] is not None]
        ways.append(
            {
                "way": way,
                "goals": len(own),
                "reached": len(times),
                "interval": list(wilson(len(times), len(own))),
                "median_s": float(np.median(times)) if times else None,
                "median_nearest_m": float(np.median([row["nearest_m"] for row in own])),
                "mean_kicks": float(
                    np.mean([sum(choice != ON for choice in row["choices"]) for row in own])
                ),
            }
        )
    effects = np.array([row["effects"] for row in rows if row["effects"] is not None])
    names = ("on", "left", "right")
    learned = [
        {
            "after": names[last],
            "choice": names[choice],
            "m_ahead_m_left_rad_left": effects[:, last, choice].mean(axis=0).tolist(),
        }
        for last in CHOICES
        for choice in CHOICES
    ]
    return Findings(
        [],
        {
            "preset": PRESET,
            "away_m": AWAY_M,
            "reached_m": REACHED_M,
            "limit_s": LIMIT_S,
            "ways": ways,
            "learned": learned,
        },
    )
