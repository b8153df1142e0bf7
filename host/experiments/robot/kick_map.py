"""Which kicks reverse a wheel, by length, phase and direction of the wheel (R9 and R10).

The paper shifts and inverts at any phase. The map shows at which lengths the phase does not matter,
and at which phase to kick otherwise.
"""

from __future__ import annotations

from math import ceil
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.experiments.registry import claimed
from host.experiments.robot.kick_map_rows import Cell, ChunkCell, Row, TrialCell, counts, of_kind
from host.experiments.robot.reliability import kick_settled
from host.kicking.kick_map import (
    KINDS,
    LENGTHS,
    PHASE_BINS,
    Counts,
    KickCell,
    count,
    phase_bin,
    tally,
)
from host.kicking.outcome import DIRECTIONS, OPPOSITE
from host.kicking.planning import choose
from host.kicking.robot_claims import INVERTED, SHIFTED, quenched, surest
from host.logs.log import Log
from host.runs.answers import Answer
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import fraction, standard_error, wilson
from robot.kicks import DEFAULT_TICKS, PHASE, POSITION, WHEELS

# Kicks in one cell: they take some seconds, and memory that any machine has. A million kicks make
# 28,000 for a length, and 390 for a direction and a phase: where all of these reverse, at least
# 99 % do (95 % confidence); a rate of half is known to 5 %.
CHUNK = 20000


class Rate(TypedDict):
    """A share of reversed kicks (None without kicks), its 95 % interval, and how many kicks."""

    rate: float | None
    interval: list[float]
    tried: int


class BestKick(Rate):
    """The kick that `choose` found.

    Attributes:
        ticks: its length.
        window_deg: the phases (degrees) between which to kick; None for any.
    """

    ticks: int
    window_deg: list[float] | None


class BlindKick(Rate):
    """Kicks of one length at all phases together.

    Attributes:
        ticks: the length.
        at_the_worst_phase: the share that reversed in the bin where fewest did.
    """

    ticks: int
    at_the_worst_phase: float | None


class KindNumbers(TypedDict):
    """What a kind of kick does to wheels of one direction.

    Attributes:
        mode: mode of the kick.
        sign: sign of the phase shift, 0 for position kicks.
        before: direction of the wheels, 1 or -1.
        best: the best kick, None if no kick is sure.
        blind_as_in_the_paper: the paper's kick, at any phase.
        blind: kicks of each length, at any phase.
    """

    mode: str
    sign: int
    before: int
    best: BestKick | None
    blind_as_in_the_paper: BlindKick
    blind: list[BlindKick]


class Numbers(TypedDict):
    """How many kicks, the lengths (ticks), how many bins of phase, and what each kind does."""

    kicks: int
    lengths: list[int]
    phase_bins: int
    maps: list[KindNumbers]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Chunks of kicks for the simulation; single kicks for a robot, all kinds in each round."""
    kicks: list[KickCell] = [
        {"mode": mode, "sign": sign, "ticks": ticks} for mode, sign in KINDS for ticks in LENGTHS
    ]
    each = ceil(options["kicks"] / len(kicks))
    if batch:
        return [
            {**kick, "chunk": begin // CHUNK, "kicks": min(CHUNK, each - begin)}
            for kick in kicks
            for begin in range(0, each, CHUNK)
        ]
    return [{**kick, "trial": trial} for trial in range(each) for kick in kicks]


def world(cell: TrialCell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def simulate(cell: ChunkCell, setting: Setting) -> list[Counts]:
    """Kick the wheels of one chunk, and count by direction and phase."""
    return tally(
        cell["mode"],
        cell["sign"],
        cell["ticks"],
        cell["kicks"],
        setting.seed_of(cell),
        params=setting.params(),
        motor=setting.constants,
        battery_v=setting.battery_v,
    )


def trial(cell: TrialCell, robot: Robot, log: Log, setting: Setting) -> list[Counts]:
    """Kick both wheels of a robot."""
    outcome = kick_settled(cell, robot, log, setting)
    met = next(record for record in reversed(log.records) if record.tick == outcome.applied_tick)
    return [
        {
            "before": DIRECTIONS[outcome.before[side]],
            "phase": phase_bin(getattr(met, side + "_phi_rad")),
            "tried": 1,
            "reversed": int(outcome.after[side] == OPPOSITE[outcome.before[side]]),
        }
        for side in WHEELS
        if outcome.before[side] in DIRECTIONS
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """R9 and R10 at the worst phase, and the best kick of each kind beside blind ones."""
    position = [of_kind(rows, POSITION, 0, before) for before in (1, -1)]
    named = [of_kind(rows, PHASE, before, before) for before in (1, -1)]
    claims = [
        _at_any_phase("R9", INVERTED, position),
        _at_any_phase("R10", SHIFTED, named),
    ]
    numbers: Numbers = {
        "kicks": count(rows)[1],
        "lengths": list(LENGTHS),
        "phase_bins": PHASE_BINS,
        "maps": [
            _kind_numbers(of_kind(rows, mode, sign, before), mode, sign, before)
            for mode, sign in KINDS
            for before in (1, -1)
        ],
    }
    foreign = setting.elsewhere(**claimed("kick-map"))
    return Findings(
        [claim.doubted(foreign) for claim in claims], numbers, answers=_answers(numbers)
    )


def _answers(numbers: Numbers) -> list[Answer]:
    """The paper's kick at any phase, and the best one, of each kind and direction."""
    answers = []
    for own in numbers["maps"]:
        kick = "inverted positions"
        if own["mode"] == PHASE:
            kick = f"phase kicks of {'+' if own['sign'] > 0 else '-'}135°"
        way = "forward" if own["before"] > 0 else "backward"
        blind, best = own["blind_as_in_the_paper"], own["best"]
        answers += [
            _rate_answer(f"{kick}, {way} wheels: {blind['ticks']} ticks reverse", blind),
            _rate_answer(f"{kick}, {way} wheels: the best kick reverses", best),
            Answer(f"{kick}, {way} wheels: its length", best and best["ticks"], None, "ticks"),
        ]
    return answers


def _rate_answer(name: str, rate: Rate | None) -> Answer:
    if rate is None or rate["rate"] is None:
        return Answer(name, None)
    low, high = rate["interval"]
    return Answer(name, 100 * rate["rate"], 100 * standard_error((low, high)), "%")


def _kind_numbers(rows: list[Row], mode: str, sign: int, before: int) -> KindNumbers:
    """The best kick of a kind and direction, and blind kicks of the paper's and each length."""
    plan = choose(rows, before)
    best: BestKick | None = None
    if plan is not None:
        rate = _rate(plan.reversed, plan.tried)
        best = {"ticks": plan.ticks, "window_deg": plan.window_deg(), **rate}
    by_length = counts(rows).transpose(1, 0, 2)
    blind: list[BlindKick] = [
        {
            "ticks": ticks,
            **_rate(*totals.sum(axis=1)),
            "at_the_worst_phase": _rate(*_least_sure(totals))["rate"],
        }
        for ticks, totals in zip(LENGTHS, by_length, strict=True)
    ]
    return {
        "mode": mode,
        "sign": sign,
        "before": before,
        "best": best,
        "blind_as_in_the_paper": blind[LENGTHS.index(DEFAULT_TICKS[mode])],
        "blind": blind,
    }


def _rate(done: float, tried: float) -> Rate:
    return {
        "rate": float(done / tried) if tried else None,
        "interval": list(wilson(int(done), int(tried))),
        "tried": int(tried),
    }


def _at_any_phase(number: str, what: str, directions: list[list[Row]]) -> Claim:
    """Claim that a kick is reliable in each direction at each phase, and fails in both together."""
    totals = np.concatenate([counts(rows) for rows in directions], axis=2).transpose(1, 0, 2)
    by_length = dict(zip(LENGTHS, totals, strict=True))
    least_sure = {ticks: _least_sure(own) for ticks, own in by_length.items()}
    return quenched(
        number,
        f"{what} reverses a wheel reliably at any phase if it lasts 3 to 5 ticks",
        "in the direction and at the phase where it is least sure",
        least_sure,
        {ticks: fraction(*own.sum(axis=1)) for ticks, own in by_length.items()},
        least_sure[surest(least_sure)][1],
        "kicks there",
    )


def _least_sure(totals: NDArray[np.float64]) -> tuple[int, int]:
    """(reversed, tried) in the bin of the lowest rate; of equals, of the fewest trials."""
    tried_bins = [(int(done), int(tried)) for done, tried in totals.T if tried]
    return min(tried_bins, key=lambda counts: (counts[0] / counts[1], counts[1]), default=(0, 0))
