"""How surely a kick reverses a wheel, against its length (R8 to R10).

Kicks are position kicks, phase kicks of both signs, and membrane kicks beside them. A trial is one
wheel that has settled; the kick meets it at a random phase. Phase kicks of both signs are given to
wheels of both directions: the paper names one sign for each direction, and says nothing about the
other.
"""

from __future__ import annotations

from math import isnan
from typing import NotRequired, TypedDict

import numpy as np

from host.client.robot import Robot
from host.errors import NotDone
from host.experiments.registry import claimed
from host.kicking.kick_map import KickCell, request, shift_of, span_ticks, times_of
from host.kicking.outcome import DIRECTIONS, OPPOSITE, Outcome, kick_and_watch, wait_settled
from host.kicking.robot_claims import inversions, quenched
from host.logs.log import Log
from host.logs.motion import settling_s
from host.runs.answers import Answer, share
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import fraction
from robot.kick_requests import parse
from robot.kicks import DEFAULT_TICKS, MEMBRANE, PHASE, POSITION, WHEELS
from sim_motor.batch import run

LENGTHS = tuple(range(1, 11))
TURN_S = 0.5
# If no wheel runs in one of the directions after this many batches, it is not by chance.
PATIENT_BATCHES = 3
# How long a wheel settles before a kick and is watched after it, without the neurons' memory, s.
_SETTLE_S, _WATCH_S = 3.1, 1.9


class Cell(KickCell):
    """A kick for all trials of the simulation, or for one trial on a robot.

    Attributes:
        trial: number of the trial on a robot, from 0.
    """

    trial: NotRequired[int]


class Trial(TypedDict):
    """One wheel that was kicked.

    Attributes:
        before: its direction before the kick, 1 forward or -1 backward.
        reversed: whether it runs in the other direction afterwards.
        settling_s: time from the kick's beginning until it has settled (s); None if it has not.
    """

    before: int
    reversed: bool
    settling_s: float | None


class Row(Cell, Trial):
    """A trial with its kick."""


class Numbers(TypedDict):
    """The counts of each kick.

    Attributes:
        lengths: lengths of the kicks (ticks).
        reversals_of_trials: [reversals, trials] at each length, by the kind of kick.
        as_table: the same in lines for people.
    """

    lengths: list[int]
    reversals_of_trials: dict[str, list[list[int]]]
    as_table: str


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Every kick once for the simulation.

    On a robot, whose battery fades, all kicks take turns in each of many rounds.
    """
    kicks: list[Cell] = [{"mode": MEMBRANE, "ticks": 1, "sign": 0}]
    kicks += [{"mode": POSITION, "ticks": ticks, "sign": 0} for ticks in LENGTHS]
    kicks += [{"mode": PHASE, "ticks": ticks, "sign": 1} for ticks in LENGTHS]
    kicks += [{"mode": PHASE, "ticks": ticks, "sign": -1} for ticks in LENGTHS]
    if batch:
        return kicks
    return [{**kick, "trial": trial} for trial in range(options["trials"]) for kick in kicks]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def simulate(cell: Cell, setting: Setting) -> list[Trial]:
    """Kick simulated wheels until enough of them ran in each direction."""
    rng = np.random.default_rng(setting.seed_of(cell))
    asked = request(cell["mode"], cell["ticks"], shift_of(cell["sign"]))
    params = setting.params()
    settle, watch = span_ticks(_SETTLE_S, params), span_ticks(_WATCH_S, params)
    kick = parse({"id": "reliability", **asked}, (0, 0), params, settle)
    published, trials = setting.constants, setting.options["trials"]
    rows: dict[int, list[Trial]] = {1: [], -1: []}
    batches = 0
    while min(map(len, rows.values())) < trials:
        if batches >= PATIENT_BATCHES and not all(rows.values()):
            raise NotDone(
                f"of {3 * trials * batches} simulated wheels {len(rows[1])} rolled forward and"
                f" {len(rows[-1])} backward, and nothing else can be kicked around",
                "is k too small, or the battery too weak for this motor?",
            )
        batches += 1
        motors = published.specimens(3 * trials, rng)
        ticks = settle + kick.ticks + watch
        result = run(
            len(motors),
            ticks,
            int(rng.integers(2**32)),
            params=params,
            kick=kick,
            motors=motors,
            battery_v=setting.battery_v,
            times=times_of(ticks, params),
        )
        wheels = zip(
            result.before.tolist(), result.reversed.tolist(), result.settled_s.tolist(), strict=True
        )
        for before, reverses, settled in wheels:
            settled_s = None if isnan(settled) else settled
            if before:
                rows[before].append(
                    {"before": before, "reversed": reverses, "settling_s": settled_s}
                )
    return rows[1][:trials] + rows[-1][:trials]


def kick_settled(cell: KickCell, robot: Robot, log: Log, setting: Setting) -> Outcome:
    """Wait until a robot has settled, and give it the cell's kick at a random phase."""
    wait_settled(robot)
    robot.wait(float(np.random.default_rng(setting.seed_of(cell)).uniform(0.0, TURN_S)))
    kick = request(cell["mode"], cell["ticks"], shift_of(cell["sign"]))
    return kick_and_watch(robot, log, **kick)


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Trial]:
    """Kick both wheels of a robot."""
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
    """The trials of one kick.

    Args:
        rows: all trials.
        mode: mode of the kick.
        ticks: its length.
        named: True for phase kicks of the sign that the paper names for the wheel's direction,
            False for those of the other sign, None for all.
    """
    kicks = [row for row in rows if row["mode"] == mode and row["ticks"] == ticks]
    return [row for row in kicks if named in (None, row["sign"] == row["before"])]


def report(rows: list[Row], setting: Setting) -> Findings:
    """R8 to R10."""
    claims = [
        inversions([row["reversed"] for row in points(rows, MEMBRANE, 1)]),
        _quenched("R9", rows, POSITION, None),
        _quenched("R10", rows, PHASE, named=True),
    ]
    kinds = (
        ("position", POSITION, None),
        ("phase", PHASE, True),
        ("phase, other sign", PHASE, False),
    )
    counts = {
        name: [list(rate(points(rows, mode, ticks, named))) for ticks in LENGTHS]
        for name, mode, named in kinds
    }
    numbers: Numbers = {
        "lengths": list(LENGTHS),
        "reversals_of_trials": counts,
        "as_table": _as_table(rate(points(rows, MEMBRANE, 1)), counts),
    }
    claims = [claim.doubted(setting.elsewhere(**claimed("reliability"))) for claim in claims]
    return Findings(claims, numbers, answers=_answers(rows))


def _as_table(inverted: tuple[int, int], counts: dict[str, list[list[int]]]) -> str:
    """The wheels that reversed, of those that were kicked: a line for each length."""
    columns = [["ticks", *map(str, LENGTHS)]]
    columns += [
        [kind, *(f"{done} of {tried}" for done, tried in row)] for kind, row in counts.items()
    ]
    widths = [max(map(len, column)) for column in columns]
    lines = [
        "Wheels that reversed, of those that were kicked:",
        f"  membrane, of 1 tick: {inverted[0]} of {inverted[1]}",
    ]
    for row in zip(*columns, strict=True):
        cells = (f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True))
        lines.append("  " + "   ".join(cells))
    return "\n".join(lines)


def _answers(rows: list[Row]) -> list[Answer]:
    """The share of each kick that reverses a wheel, the paper's lengths first."""
    answers = [share("inversions of the potentials that reverse", *rate(points(rows, MEMBRANE, 1)))]
    of_kinds = [
        (f"{words} of {ticks} tick{'' if ticks == 1 else 's'} that reverse", mode, ticks, named)
        for words, mode, named in (
            ("inverted positions", POSITION, None),
            ("phase kicks", PHASE, True),
            ("phase kicks of the other sign", PHASE, False),
        )
        for ticks in LENGTHS
    ]
    of_kinds.sort(key=lambda kind: kind[2] != DEFAULT_TICKS[kind[1]])
    return answers + [
        share(words, *rate(points(rows, mode, ticks, named)))
        for words, mode, ticks, named in of_kinds
    ]


def _quenched(number: str, rows: list[Row], mode: str, named: bool | None) -> Claim:
    """Claim that a kick is reliable in the worse direction, and fails in both."""
    least_sure: dict[int, tuple[int, int]] = {}
    rates: dict[int, float] = {}
    fewest = len(rows)
    for ticks in LENGTHS:
        own = points(rows, mode, ticks, named)
        both = [rate([row for row in own if row["before"] == before]) for before in (1, -1)]
        least_sure[ticks] = min(both, key=lambda counts: fraction(*counts))
        rates[ticks] = max(fraction(*counts) for counts in both)
        fewest = min(fewest, *(tried for _, tried in both))
    return quenched(
        number,
        SENTENCES[number],
        "in the worse direction",
        least_sure,
        rates,
        fewest,
        "trials in a direction",
    )
