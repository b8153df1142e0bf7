"""How surely a kick reverses a wheel, against its length.

Position and phase kicks of both signs, membrane beside them (R8 to R10).

A trial is one wheel that has settled, at whatever phase the kick meets it. Phase kicks of both
signs are given to wheels of both directions: of the sign that the paper names for a direction, and
of the other one, of which it says nothing.
"""

from __future__ import annotations

from math import isnan

import numpy as np

from host.client.robot import Robot
from host.errors import NotDone
from host.kicking.kick_map import request, shift_of
from host.kicking.outcome import DIRECTIONS, OPPOSITE, Outcome, kick_and_watch, wait_settled
from host.kicking.robot_claims import inversions, quenched
from host.logs.log import Log
from host.logs.motion import settling_s
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import fraction
from robot.kicks import MEMBRANE, PHASE, POSITION, WHEELS, parse
from robot.params import Params
from sim_motor.batch import run
from sim_motor.motor import load

LENGTHS = tuple(range(1, 11))
TURN_S = 0.5
# So many batches without a wheel in one of the directions, and it is no matter of chance.
PATIENT_BATCHES = 3
_SETTLE_TICKS, _WATCH_TICKS = 170, 130


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A cell is a kick for all trials of the batch, or for one trial on a robot.

    There they go round after round, as its battery fades.
    """
    kicks: list[Cell] = [{"mode": MEMBRANE, "ticks": 1, "sign": 0}]
    kicks += [{"mode": POSITION, "ticks": ticks, "sign": 0} for ticks in LENGTHS]
    kicks += [
        {"mode": PHASE, "ticks": ticks, "sign": sign} for sign in (1, -1) for ticks in LENGTHS
    ]
    return (
        kicks
        if batch
        else [{**kick, "trial": trial} for trial in range(options["trials"]) for kick in kicks]
    )


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """As many wheels as it takes until so many ran in each direction."""
    rng = np.random.default_rng(setting.seed_of(cell))
    asked = request(cell["mode"], cell["ticks"], shift_of(cell["sign"]))
    kick = parse({"id": "reliability", **asked}, (0, 0), Params(), _SETTLE_TICKS)
    published, trials = load(setting.motor), setting.options["trials"]
    rows: dict[int, list[Row]] = {1: [], -1: []}
    batches = 0
    while min(map(len, rows.values())) < trials:
        if batches >= PATIENT_BATCHES and not all(rows.values()):
            raise NotDone(
                f"of {3 * trials * batches} simulated wheels {len(rows[1])} rolled forward and"
                f" {len(rows[-1])} backward, and nothing else can be kicked around",
                "is the battery too weak for this motor?",
            )
        batches += 1
        motors = published.specimens(3 * trials, rng)
        ticks = _SETTLE_TICKS + kick.ticks + _WATCH_TICKS
        result = run(
            len(motors),
            ticks,
            int(rng.integers(2**32)),
            kick=kick,
            motors=motors,
            battery_v=setting.battery_v,
        )
        for before, reverses, settled in zip(
            result.before.tolist(), result.reversed.tolist(), result.settled_s.tolist(), strict=True
        ):
            if before:
                rows[before].append(
                    {
                        "before": before,
                        "reversed": reverses,
                        "settling_s": None if isnan(settled) else settled,
                    }
                )
    return rows[1][:trials] + rows[-1][:trials]


def kick_settled(cell: Cell, robot: Robot, log: Log, setting: Setting) -> Outcome:
    """Give a robot that has settled the cell's kick, at a random phase."""
    wait_settled(robot)
    robot.wait(float(np.random.default_rng(setting.seed_of(cell)).uniform(0.0, TURN_S)))
    return kick_and_watch(
        robot, log, **request(cell["mode"], cell["ticks"], shift_of(cell["sign"]))
    )


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """Both wheels of a robot."""
    outcome = kick_settled(cell, robot, log, setting)
    return [
        {
            "before": DIRECTIONS[outcome.before[side]],
            "reversed": outcome.after[side] == OPPOSITE[outcome.before[side]],
            "settling_s": settling_s(log, side, outcome.applied_tick),
        }
        for side in WHEELS
        if outcome.before[side] in DIRECTIONS
    ]


def rate(rows: list[Row]) -> tuple[int, int]:
    """(reversals, trials)."""
    return sum(row["reversed"] for row in rows), len(rows)


def points(rows: list[Row], mode: str, ticks: int, named: bool | None = None) -> list[Row]:
    """The trials of a point. named.

    Only phase kicks of the sign that the paper names for the wheel's direction, or only the others.
    """
    return [
        row
        for row in rows
        if (row["mode"], row["ticks"]) == (mode, ticks)
        and (named is None or (row["sign"] == row["before"]) is named)
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """R8 to R10."""
    claims = [
        inversions([row["reversed"] for row in points(rows, MEMBRANE, 1)]),
        _quenched("R9", "inverted positions are", rows, POSITION, None),
        _quenched("R10", "a phase shift of the named sign is", rows, PHASE, named=True),
    ]
    rates = {
        name: [[*rate(points(rows, mode, ticks, named))] for ticks in LENGTHS]
        for name, mode, named in (
            ("position", POSITION, None),
            ("phase", PHASE, True),
            ("phase, other sign", PHASE, False),
        )
    }
    claims = [claim.doubted(setting.elsewhere()) for claim in claims]
    return Findings(claims, {"lengths": list(LENGTHS), "reversals_of_trials": rates})


def _quenched(number: str, what: str, rows: list[Row], mode: str, named: bool | None) -> Claim:
    """Reliable in the worse direction, failing in both."""
    directions = {
        ticks: [
            rate([row for row in points(rows, mode, ticks, named) if row["before"] == before])
            for before in (1, -1)
        ]
        for ticks in LENGTHS
    }
    return quenched(
        number,
        f"{what} reliable for 3 to 5 ticks",
        "in the worse direction",
        {
            ticks: min(both, key=lambda counts: fraction(*counts))
            for ticks, both in directions.items()
        },
        {ticks: max(fraction(*counts) for counts in both) for ticks, both in directions.items()},
        min(tried for both in directions.values() for _, tried in both),
        "trials in a direction",
    )
