"""Where the basin lies: success of a kick against its length and the wheel's phase when it comes, for each direction (R9 and R10).

The paper shifts and inverts blindly, whatever the phase; the map tells at which lengths this does
not matter, and when to kick else.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.experiments.robot.reliability import kick_settled
from host.kicking.kick_map import KINDS, LENGTHS, PHASE_BINS, count, phase_bin, tally
from host.kicking.outcome import DIRECTIONS, OPPOSITE
from host.kicking.planning import choose
from host.kicking.robot_claims import quenched, surest
from host.logs.log import Log
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import fraction, wilson
from robot.kicks import DEFAULT_TICKS, PHASE, POSITION, WHEELS
from robot.params import Params

# Kicks that are computed in a go: some seconds, and memory that any machine has. A million kicks
# make 28,000 for a length, and 390 for a direction and a phase: where all of these reverse, at
# least 99 % do (95 % confidence); a rate of half is known to 5 %.
CHUNK = 20000


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A cell is a chunk of kicks of one kind and length, or a single one on a robot.

    There they go round after round.
    """
    kicks: list[Cell] = [
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


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """Counts by direction and phase."""
    kick = cell["mode"], cell["sign"], cell["ticks"], cell["kicks"]
    return tally(
        *kick,
        setting.seed_of(cell),
        params=Params(),
        motor=setting.motor,
        battery_v=setting.battery_v,
    )


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """Both wheels of a robot."""
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


def of_kind(rows: list[Row], mode: str, sign: int, before: int) -> list[Row]:
    """The rows of a kind of kick on wheels of a direction."""
    return [
        row for row in rows if (row["mode"], row["sign"], row["before"]) == (mode, sign, before)
    ]


def counts(rows: list[Row]) -> NDArray[np.float64]:
    """Reversals and trials, (2, LENGTHS, PHASE_BINS)."""
    totals = np.zeros((2, len(LENGTHS), PHASE_BINS))
    for row in rows:
        totals[:, LENGTHS.index(row["ticks"]), row["phase"]] += row["reversed"], row["tried"]
    return totals


def share(totals: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rates of such counts; NaN where nothing was tried."""
    done, tried = totals
    rates: NDArray[np.float64] = np.divide(
        done, tried, out=np.full_like(done, np.nan), where=tried > 0
    )
    return rates


def report(rows: list[Row], setting: Setting) -> Findings:
    """R9 and R10 at the worst phase.

    And for each kind and direction the best length and moment, beside blind kicks.
    """
    best = [
        _best(of_kind(rows, mode, sign, before), mode, sign, before)
        for mode, sign in KINDS
        for before in (1, -1)
    ]
    position = [of_kind(rows, POSITION, 0, before) for before in (1, -1)]
    named = [of_kind(rows, PHASE, before, before) for before in (1, -1)]
    claims = [
        _whatever_the_phase("R9", "inverted positions", position),
        _whatever_the_phase("R10", "a phase shift of the named sign", named),
    ]
    return Findings(
        [claim.doubted(setting.elsewhere()) for claim in claims],
        {"kicks": count(rows)[1], "lengths": list(LENGTHS), "phase_bins": PHASE_BINS, "maps": best},
    )


def _best(rows: list[Row], mode: str, sign: int, before: int) -> dict[str, Any]:
    """The best kick of a kind, beside blind ones.

    The paper's and each length's, whatever the phase, and at the worst phase.
    """
    plan = choose(rows, before)
    totals = counts(rows)
    blind = [
        {
            "ticks": ticks,
            **_rate(*of.sum(axis=1)),
            "at_the_worst_phase": _rate(*_least_sure(of))["rate"],
        }
        for ticks, of in zip(LENGTHS, totals.transpose(1, 0, 2), strict=True)
    ]
    return {
        "mode": mode,
        "sign": sign,
        "before": before,
        "best": (
            plan
            and {
                "ticks": plan.ticks,
                "window_deg": plan.window_deg(),
                **_rate(plan.reversed, plan.tried),
            }
        ),
        "blind_as_in_the_paper": blind[LENGTHS.index(DEFAULT_TICKS[mode])],
        "blind": blind,
    }


def _rate(done: float, tried: float) -> dict[str, Any]:
    return {
        "rate": float(done / tried) if tried else None,
        "interval": list(wilson(int(done), int(tried))),
        "tried": int(tried),
    }


def _whatever_the_phase(number: str, what: str, directions: list[list[Row]]) -> Claim:
    """Reliable in either direction at each phase, failing in both together."""
    totals = np.concatenate([counts(rows) for rows in directions], axis=2).transpose(1, 0, 2)
    least_sure = {ticks: _least_sure(of) for ticks, of in zip(LENGTHS, totals, strict=True)}
    return quenched(
        number,
        f"{what}: reliable for 3 to 5 ticks, whatever the phase",
        "in the direction and at the phase where it is least sure",
        least_sure,
        {ticks: fraction(*of.sum(axis=1)) for ticks, of in zip(LENGTHS, totals, strict=True)},
        least_sure[surest(least_sure)][1],
        "kicks there",
    )


def _least_sure(totals: NDArray[np.float64]) -> tuple[int, int]:
    """(reversed, tried) in the bin of the lowest rate; of equals, of the fewest trials."""
    tried_bins = [(int(done), int(tried)) for done, tried in totals.T if tried]
    return min(tried_bins, key=lambda counts: (counts[0] / counts[1], counts[1]), default=(0, 0))
