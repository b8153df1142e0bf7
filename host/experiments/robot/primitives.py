"""The motion primitives: transitions, random starts, and where the robot can rest (R1 to R4, R7).

A round makes every transition once, each from where the one before ended. Between two kinds of
locomotion kicks alone do it, and k stays as it is. Into rest it takes a pulse of k to zero; after
that k may have to be lower for the robot to stay. At one k after another the experiment tries
whether the pulse alone is enough. If so, and if the robot ran at this k before the pulse, rest and
locomotion coexist there.
"""

from __future__ import annotations

from itertools import pairwise, permutations
from math import pi
from typing import TypedDict

import numpy as np

from host.client.robot import Robot
from host.experiments.robot.primitives_rows import (
    CellRows,
    PrimitivesCell,
    PrimitivesRow,
    Rest,
    Sample,
    Start,
    Transition,
    TransitionRow,
    rests,
    start_rows,
    transitions,
)
from host.kicking.manoeuvres import starts
from host.kicking.outcome import FORWARD, STOPPED, kick_and_watch, require_running
from host.kicking.primitives import PRIMITIVES, STOP_PULSE_S, drive
from host.kicking.robot_claims import Steady, coexistence, locomotion, steady
from host.logs.log import Log
from host.logs.motion import heading
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim, too_few
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import wilson
from robot.kicks import DIRECTION_TICKS, PULSE, WHEELS

simulate = None

STATES = tuple(PRIMITIVES)
PAIRS = tuple(permutations(STATES, 2))
K = 8.0
KS = (0.4, 0.45, 0.47, 0.48, 0.5, 0.52, 0.55, 0.6, 0.8, 1.5, 4.0, 8.0)
LOWERED_S, STAY_S = 6.0, 4.0
RELIABLE = 0.95
# The figure shows one tick in this many of the first round.
SHOWN_EVERY = 4


class Score(TypedDict):
    """How one transition went.

    Attributes:
        reached: how often it reached its end.
        of: how often it was tried.
        rate: 95 % interval of the share.
        median_s: median time of those that reached their end (s), None if none did.
    """

    reached: int
    of: int
    rate: tuple[float, float]
    median_s: float | None


class Numbers(TypedDict):
    """Scores of all transitions, and [successes, tries] to run and to stay at rest at each k."""

    transitions: dict[str, Score]
    rest_after_a_pulse_of_k: dict[str, dict[str, list[int]]]


def circuit() -> list[str]:
    """A tour from STATES[0] and back with every transition once (Hierholzer's algorithm)."""
    left = {begin: [end for end in STATES if end != begin] for begin in STATES}
    path, tour = [STATES[0]], []
    while path:
        if left[path[-1]]:
            path.append(left[path[-1]].pop())
        else:
            tour.append(path.pop())
    return tour[::-1]


def cells(options: Options, *, batch: bool) -> list[PrimitivesCell]:
    """Rounds of all transitions, random starts, and tries to rest at each k."""
    trials = range(options["trials"])
    work: list[PrimitivesCell] = []
    work += [{"part": "round", "trial": trial} for trial in trials]
    work += [{"part": "start", "trial": trial} for trial in trials]
    work += [{"part": "rest", "k": k, "trial": trial} for trial in trials for k in KS]
    return work


def world(cell: PrimitivesCell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def trial(cell: PrimitivesCell, robot: Robot, log: Log, setting: Setting) -> CellRows:
    """Do one cell."""
    robot.set(k=K)
    robot.wait(STAY_S, until=lambda: len(log) > DIRECTION_TICKS)
    if cell["part"] == "start":
        return _start(robot, log)
    if cell["part"] == "rest":
        return [_rest(robot, log, cell["k"])]
    rows: list[Transition | Sample] = [*_round(robot, log)]
    if cell["trial"] == 0:
        rows += _samples(log)
    return rows


def _round(robot: Robot, log: Log) -> list[Transition]:
    """Try every transition once.

    After one that failed, the robot is driven to where the next begins. That does not count, and if
    it fails too, the next transition is left out.
    """
    rows: list[Transition] = []
    for begin, end in pairwise(circuit()):
        if not drive(robot, log, begin)["reached"]:
            continue
        begin_s = log.records[-1].t_s
        done = drive(robot, log, end)
        rows.append(
            {
                "kind": "transition",
                "begin": begin,
                "end": end,
                "reached": done["reached"],
                "kicks": len(done["kicks"]),
                "seconds": log.records[-1].t_s - begin_s,
                "k_before": done["k_before"],
                "k": done["k"],
            }
        )
    return rows


def _samples(log: Log) -> list[Sample]:
    """The speeds of the wheels, as means over SHOWN_EVERY ticks, and k, over the round."""
    log = log.until_now()
    t = log.column("t_s")
    left, right = (log.omega(side) / (2 * pi) for side in WHEELS)
    k = np.full(len(log), K)
    for event, place in zip(log.events, log.places, strict=True):
        if "k" in event.get("set", {}):
            k[place:] = event["set"]["k"]
    rows: list[Sample] = []
    for row in range(0, len(log), SHOWN_EVERY):
        ticks = slice(max(0, row - SHOWN_EVERY + 1), row + 1)
        rows.append(
            {
                "kind": "sample",
                "t_s": float(t[row] - t[0]),
                "k": float(k[row]),
                "left_hz": float(left[ticks].mean()),
                "right_hz": float(right[ticks].mean()),
            }
        )
    return rows


def _start(robot: Robot, log: Log) -> list[Start]:
    """Steady motion of each wheel after a start from random potentials."""
    (span,) = starts(robot, log, 1)
    require_running(robot)
    return [
        {
            "kind": "start",
            "side": side,
            "hz": wheel.hz,
            "duty_pct": wheel.duty_pct,
            "ripple": wheel.ripple,
        }
        for side, wheel in zip(WHEELS, steady(log, span), strict=True)
    ]


def _rest(robot: Robot, log: Log, k: float) -> Rest:
    """Whether the robot runs at this k, and whether it stays at rest after a pulse of k to zero."""
    drive(robot, log, "forward")
    robot.set(k=k)
    robot.wait(LOWERED_S)
    ticks = round(STOP_PULSE_S / float(robot.status()["params"]["tick_s"]))
    runs = {heading(log, side, log.records[-1].tick) for side in WHEELS} == {FORWARD}
    kick_and_watch(robot, log, PULSE, param="k", value=0.0, ticks=ticks)
    robot.wait(STAY_S)
    require_running(robot)
    stays = {heading(log, side, log.records[-1].tick) for side in WHEELS} == {STOPPED}
    return {"kind": "rest", "runs": runs, "stays": stays}


def report(rows: list[PrimitivesRow], setting: Setting) -> Findings:
    """R1 to R4 and R7."""
    wheels = [Steady(row["hz"], row["duty_pct"], row["ripple"]) for row in start_rows(rows)]
    numbers: Numbers = {
        "transitions": {
            f"{begin} to {end}": _score(transitions(rows, begin, end)) for begin, end in PAIRS
        },
        "rest_after_a_pulse_of_k": {
            str(k): {"runs": [*rests(rows, k, "runs")], "stays": [*rests(rows, k, "stays")]}
            for k in KS
        },
    }
    claims = [coexistence(wheels), *locomotion(wheels), _primitives(rows)]
    return Findings([claim.doubted(setting.elsewhere()) for claim in claims], numbers)


def _score(tries: list[TransitionRow]) -> Score:
    seconds = [row["seconds"] for row in tries if row["reached"]]
    return {
        "reached": len(seconds),
        "of": len(tries),
        "rate": wilson(len(seconds), len(tries)),
        "median_s": float(np.median(seconds)) if seconds else None,
    }


def _primitives(rows: list[PrimitivesRow]) -> Claim:
    tries = transitions(rows)
    stops = [row for row in tries if "stopped" in (row["begin"], row["end"])]
    stopped = sum(row["reached"] for row in stops)
    kicked = [row for row in tries if "stopped" not in (row["begin"], row["end"])]
    alone = sum(
        row["reached"] and row["kicks"] > 0 and row["k"] == row["k_before"] for row in kicked
    )
    shared = [k for k in KS if rests(rows, k, "runs")[0] and rests(rows, k, "stays")[0]]
    sure = [k for k in shared if _is_sure(*rests(rows, k, "runs"))]
    sure = [k for k in sure if _is_sure(*rests(rows, k, "stays"))]
    tried = sum(bool(transitions(rows, *pair)) for pair in PAIRS)
    claim = Claim(
        "R7",
        SENTENCES["R7"],
        "all reached; the range of k where the stopped state coexists with locomotion shown",
        alone / max(1, len(kicked)),
        "1",
        wilson(alone, len(kicked)),
        _is_sure(alone, len(kicked)) and _is_sure(stopped, len(stops)) and bool(sure),
        f"the share of transitions by kicks alone that succeed: {alone} of {len(kicked)}; to"
        f" stopped and back {stopped} of {len(stops)}; at k = {_range(sure)} the robot always runs,"
        f" and always rests after a pulse of k to 0; at k = {_range(shared)} it sometimes does",
    )
    # Failures count even if other transitions were never tried.
    return claim.doubted(too_few(tried, len(PAIRS), "transitions")) if claim.holds else claim


def _is_sure(done: int, tried: int) -> bool:
    return done >= RELIABLE * tried


def _range(values: list[float]) -> str:
    return f"{min(values):g} to {max(values):g}" if values else "none tried"
