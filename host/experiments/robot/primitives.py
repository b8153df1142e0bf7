"""The motion primitives (R1 to R4, R7).

All transitions between them, the motion from random starts, and where the robot can rest.

A round goes through every transition once, each from where the one before ended. From locomotion
into locomotion, kicks alone do it, and k stays as it is; into rest a pulse of k to zero, after
which k may have to be lower for the robot to stay. Where that pulse alone is enough is tried at one
k after another: there rest coexists with locomotion, if the robot ran at this k before the pulse.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from host.client.robot import Robot
from host.kicking.manoeuvres import starts
from host.kicking.outcome import FORWARD, STOPPED, kick_and_watch, require_running
from host.kicking.primitives import PRIMITIVES, STOP_PULSE_S, drive
from host.kicking.robot_claims import Steady, coexistence, locomotion, steady
from host.logs.log import Log
from host.logs.motion import heading
from host.runs.claims import Claim, too_few
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import wilson
from robot.kicks import DIRECTION_TICKS, PULSE, WHEELS

simulate = None

STATES = tuple(PRIMITIVES)
MOVING = tuple(name for name in STATES if name != "stopped")
K = 8.0
KS = (0.4, 0.45, 0.47, 0.48, 0.5, 0.52, 0.55, 0.6, 0.8, 1.5, 4.0, 8.0)
LOWERED_S, STAY_S = 6.0, 4.0
RELIABLE = 0.95
# For the figure, the first round keeps one tick of so many.
SHOWN_EVERY = 4


def circuit() -> list[str]:
    """The shortest tour from STATES[0] and back that makes every transition once (Hierholzer's)."""
    left = {begin: [end for end in STATES if end != begin] for begin in STATES}
    path, tour = [STATES[0]], []
    while path:
        if left[path[-1]]:
            path.append(left[path[-1]].pop())
        else:
            tour.append(path.pop())
    return tour[::-1]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Rounds of all transitions, random starts, and tries of rest at each k."""
    trials = range(options["trials"])
    rounds: list[Cell] = [{"part": "round", "trial": trial} for trial in trials]
    begins: list[Cell] = [{"part": "start", "trial": trial} for trial in trials]
    return [
        *rounds,
        *begins,
        *({"part": "rest", "k": k, "trial": trial} for trial in trials for k in KS),
    ]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """One of the pieces."""
    robot.set(k=K)
    robot.wait(STAY_S, until=lambda: len(log) > DIRECTION_TICKS)
    if cell["part"] == "start":
        return _start(robot, log)
    if cell["part"] == "rest":
        return [_rest(robot, log, cell["k"])]
    rows = _round(robot, log)
    return [*rows, *_shown(log)] if cell["trial"] == 0 else rows


def _round(robot: Robot, log: Log) -> list[Row]:
    """Every transition once. One that failed is made good for by driving to where the next begins, which does not count."""
    tour = circuit()
    rows: list[Row] = []
    for begin, end in pairwise(tour):
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


def _shown(log: Log) -> list[Row]:
    """The speeds of the wheels, and k, over the round."""
    t, speeds = log.column("t_s"), {side: log.omega(side) / (2 * pi) for side in WHEELS}
    changes = [
        (place, event["set"]["k"])
        for event, place in zip(log.events, log.places, strict=True)
        if "k" in event.get("set", {})
    ]
    k = np.full(len(log), K)
    for place, value in changes:
        k[place:] = value
    pairs = [(row, max(0, row - SHOWN_EVERY + 1)) for row in range(0, len(log), SHOWN_EVERY)]
    return [
        {
            "kind": "sample",
            "t_s": float(t[row] - t[0]),
            "k": float(k[row]),
            **{side + "_hz": float(speeds[side][first : row + 1].mean()) for side in WHEELS},
        }
        for row, first in pairs
    ]


def _start(robot: Robot, log: Log) -> list[Row]:
    """Steady motion of each wheel after a start from random potentials."""
    (span,) = starts(robot, log, 1)
    require_running(robot)
    return [
        {"kind": "start", "side": side, **wheel._asdict()}
        for side, wheel in zip(WHEELS, steady(log, span), strict=True)
    ]


def _rest(robot: Robot, log: Log, k: float) -> Row:
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


def transitions(rows: list[Row], begin: str, end: str) -> list[Row]:
    """The tries of one transition."""
    return [
        row
        for row in rows
        if row["kind"] == "transition" and (row["begin"], row["end"]) == (begin, end)
    ]


def rests(rows: list[Row], k: float, name: str) -> tuple[int, int]:
    """(how often the robot 'runs' or 'stays' at this k, of how many tries)."""
    tries = [row for row in rows if row["kind"] == "rest" and row["k"] == k]
    return sum(row[name] for row in tries), len(tries)


def report(rows: list[Row], setting: Setting) -> Findings:
    """R1 to R4 and R7."""
    begun = [
        Steady(*(row[name] for name in Steady._fields)) for row in rows if row["kind"] == "start"
    ]
    table = {
        f"{begin} to {end}": _score(transitions(rows, begin, end))
        for begin in STATES
        for end in STATES
        if begin != end
    }
    rest = {str(k): {name: [*rests(rows, k, name)] for name in ("runs", "stays")} for k in KS}
    claims = [coexistence(begun), *locomotion(begun), _primitives(rows)]
    return Findings(
        [claim.doubted(setting.elsewhere()) for claim in claims],
        {"transitions": table, "rest_after_a_pulse_of_k": rest},
    )


def _score(tries: list[Row]) -> dict[str, Any]:
    seconds = [row["seconds"] for row in tries if row["reached"]]
    rate = wilson(len(seconds), len(tries))
    return {
        "reached": len(seconds),
        "of": len(tries),
        "rate": rate,
        "median_s": float(np.median(seconds)) if seconds else None,
    }


def _primitives(rows: list[Row]) -> Claim:
    tries = [row for row in rows if row["kind"] == "transition"]
    kicked = [row for row in tries if row["begin"] in MOVING and row["end"] in MOVING]
    alone = [
        row for row in kicked if row["reached"] and row["kicks"] and row["k"] == row["k_before"]
    ]
    stops = [row for row in tries if "stopped" in (row["begin"], row["end"])]
    stopped = sum(row["reached"] for row in stops)
    shared = [k for k in KS if rests(rows, k, "runs")[0] and rests(rows, k, "stays")[0]]
    sure = [
        k
        for k in shared
        if all(
            done >= RELIABLE * of
            for done, of in (rests(rows, k, name) for name in ("runs", "stays"))
        )
    ]
    pairs = [(begin, end) for begin in STATES for end in STATES if begin != end]
    tried = sum(bool(transitions(rows, *pair)) for pair in pairs)
    claim = Claim(
        "R7",
        "forward, backward and both spins from each other by kicks alone; stopped and back",
        "all reached; the range of k where the stopped state coexists with locomotion shown",
        len(alone) / max(1, len(kicked)),
        "1",
        wilson(len(alone), len(kicked)),
        len(alone) >= RELIABLE * len(kicked) and stopped >= RELIABLE * len(stops) and bool(sure),
        f"{len(alone)} of {len(kicked)} by kicks alone; to stopped and back {stopped} of"
        f" {len(stops)}; after a pulse of k to 0 the robot always rests, and always runs without"
        f" it, at k = {_range(sure)}; sometimes so at k = {_range(shared)}",
    )
    # Failures count even if other transitions were never tried.
    return claim.doubted(too_few(tried, len(pairs), "transitions")) if claim.holds else claim


def _range(values: list[float]) -> str:
    return f"{min(values):g} to {max(values):g}" if values else "none tried"
