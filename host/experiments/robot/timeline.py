"""The three kicks one after the other, each there and back, as in the paper's timeline.

It shows how long the wheels take to settle, and how far they slip. The wheels' relative phase is
the left one's angle less the right one's, as a mean over WINDOW_S, so that the encoder's counts do
not show. A slip is its change from before a kick until after both wheels have settled. Beside it
stands the drift: its change in a time as long before the kick, measured in the same way.
"""

from __future__ import annotations

from math import pi
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.experiments.registry import claimed
from host.experiments.robot.timeline_rows import (
    Cell,
    Kick,
    KickRow,
    SettledKick,
    Slip,
    Tick,
    TimelineRow,
    kick_rows,
    settled_kicks,
)
from host.kicking.outcome import kick_and_watch
from host.kicking.primitives import drive
from host.kicking.robot_claims import LEAST_TRIALS, inversions
from host.logs.log import Log
from host.logs.motion import settling_s
from host.runs.answers import Answer, share
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim, too_few
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import bootstrap_interval, standard_error, wilson
from robot.kicks import DIRECTION_TICKS, MEMBRANE, PHASE, POSITION

simulate = None

KICKS: dict[str, dict[str, Any]] = {MEMBRANE: {}, POSITION: {"ticks": 3}, PHASE: {"ticks": 4}}
TURNS = (1, 2)  # there and back
STEADY_S, TURN_S, WINDOW_S = 3.0, 0.5, 0.5
# A slip stands out if it exceeds what this share of the drifts stays below.
USUAL = 0.95
# The first round keeps its ticks for the figure, from before the first of two kicks until after the
# second.
SHOWN_BEFORE_S, SHOWN_AFTER_S = 1.0, 2.0


class ModeNumbers(TypedDict):
    """What the kicks of one mode did; quantiles are 5, 50 and 95 %, None without a kick.

    Attributes:
        reversed: how many kicks reversed the robot.
        of: how many kicks.
        settling_s: quantiles of the slower wheel's settling time (s).
        slip_rad: quantiles of the slip without its sign (rad).
        drift_rad: quantiles of the drift without its sign (rad).
    """

    reversed: int
    of: int
    settling_s: list[float] | None
    slip_rad: list[float] | None
    drift_rad: list[float] | None


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Rounds of all three kicks."""
    return [{"trial": trial} for trial in range(options["trials"])]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Kick | Tick]:
    """Do one round: each kick takes the robot from forward to backward, and back."""
    rng = np.random.default_rng(setting.seed_of(cell))
    tick_s = float(log.info["params"]["tick_s"])
    rows: list[Kick | Tick] = []
    robot.wait(STEADY_S, until=lambda: len(log) > DIRECTION_TICKS)
    for mode, details in KICKS.items():
        drive(robot, log, "forward")
        kicked = []
        for turn in TURNS:
            robot.wait(STEADY_S + float(rng.uniform(0.0, TURN_S)))
            outcome = kick_and_watch(robot, log, mode, **details)
            kicked.append(_row_of(log, outcome.applied_tick))
            rows.append(
                {
                    "kind": "kick",
                    "mode": mode,
                    "turn": turn,
                    "ticks": outcome.ticks,
                    "kick_s": outcome.ticks * tick_s,
                    "reversed": outcome.reversed,
                    **_slip(log, outcome.applied_tick),
                }
            )
        if cell["trial"] == 0:
            rows += _ticks(log, mode, kicked)
    return rows


def _row_of(log: Log, tick: int) -> int:
    return int(np.flatnonzero(log.column("tick") == tick)[-1])


def _relative(log: Log) -> NDArray[np.float64]:
    return np.asarray(log.column("left_phi_rad") - log.column("right_phi_rad"))


def _slip(log: Log, tick: int) -> Slip:
    """How the wheels settled, and slipped, after the kick that began in this tick."""
    log = log.until_now()
    t, relative = log.column("t_s"), _relative(log)
    begin_s = float(t[_row_of(log, tick)])

    def mean(first_s: float) -> float:
        return float(relative[(t >= first_s) & (t < first_s + WINDOW_S)].mean())

    before = mean(begin_s - WINDOW_S)
    left_s, right_s = settling_s(log, "left", tick), settling_s(log, "right", tick)
    found: Slip = {
        "settling_left_s": left_s,
        "settling_right_s": right_s,
        "relative_before_rad": wrap(before),
        "relative_after_rad": None,
        "slip_rad": None,
        "drift_rad": None,
    }
    if left_s is None or right_s is None:
        return found
    settled_s = max(left_s, right_s)
    after = mean(begin_s + settled_s)
    found["relative_after_rad"] = wrap(after)
    found["slip_rad"] = after - before
    found["drift_rad"] = before - mean(begin_s - settled_s - 2 * WINDOW_S)
    return found


def wrap(angle: float) -> float:
    """The same direction in [-pi, pi)."""
    return (angle + pi) % (2 * pi) - pi


def _ticks(log: Log, mode: str, kicked: list[int]) -> list[Tick]:
    """The ticks around the kicks that begin in these rows of the log."""
    log = log.until_now()
    t, acts, relative = log.column("t_s"), log.column("kick") > 0, _relative(log)
    begin_s, end_s = t[kicked[0]] - SHOWN_BEFORE_S, t[kicked[-1]] + SHOWN_AFTER_S
    return [
        {
            "kind": "tick",
            "mode": mode,
            "t_s": float(t[row] - t[kicked[0]]),
            "kicked": bool(acts[row]),
            "relative_rad": float(relative[row]),
            "left_x1": log.records[row].left_x1,
            "left_x2": log.records[row].left_x2,
            "left_torque": log.records[row].left_torque,
            "right_x1": log.records[row].right_x1,
            "right_x2": log.records[row].right_x2,
            "right_torque": log.records[row].right_torque,
        }
        for row in np.flatnonzero((t >= begin_s) & (t <= end_s)).tolist()
    ]


def report(rows: list[TimelineRow], setting: Setting) -> Findings:
    """R8, R11 and R12."""
    numbers = {mode: _mode_numbers(kick_rows(rows, mode)) for mode in KICKS}
    done = settled_kicks(kick_rows(rows))
    few = too_few(len(done), LEAST_TRIALS, "kicks that reversed the robot")
    claims = [
        inversions([row["reversed"] for row in kick_rows(rows, MEMBRANE)]),
        _settling(done).doubted(few),
        _slips(done).doubted(few),
    ]
    foreign = setting.elsewhere(**claimed("timeline"))
    answers = [answer for mode in KICKS for answer in _answers(mode, kick_rows(rows, mode))]
    return Findings([claim.doubted(foreign) for claim in claims], numbers, answers=answers)


def _answers(mode: str, kicks: list[KickRow]) -> list[Answer]:
    done = settled_kicks(kicks)
    return [
        share(f"{mode} kicks that reverse", sum(row["reversed"] for row in kicks), len(kicks)),
        _median("  they settle in (median)", [kick.settling_s for kick in done], "s"),
        _median("  they slip by (median)", [abs(kick.slip_rad) for kick in done], "rad"),
        _median("  without a kick they drift by", [abs(kick.drift_rad) for kick in done], "rad"),
    ]


def _median(name: str, values: list[float], unit: str) -> Answer:
    interval = bootstrap_interval(values, np.median)
    error = standard_error(interval) if interval else None
    return Answer(name, float(np.median(values)) if values else None, error, unit)


def _mode_numbers(kicks: list[KickRow]) -> ModeNumbers:
    done = settled_kicks(kicks)
    return {
        "reversed": sum(row["reversed"] for row in kicks),
        "of": len(kicks),
        "settling_s": _quantiles([kick.settling_s for kick in done]),
        "slip_rad": _quantiles([abs(kick.slip_rad) for kick in done]),
        "drift_rad": _quantiles([abs(kick.drift_rad) for kick in done]),
    }


def _quantiles(values: list[float]) -> list[float] | None:
    """5, 50 and 95 %."""
    return [float(value) for value in np.quantile(values, (0.05, 0.5, 0.95))] if values else None


def _settling(done: list[SettledKick]) -> Claim:
    times = [kick.settling_s for kick in done]
    low, median, high = _quantiles(times) or [0.0] * 3
    slow = sum(time >= 0.5 for time in times)
    return Claim(
        "R11",
        SENTENCES["R11"],
        "distribution of settling times",
        median,
        "s",
        bootstrap_interval(times, np.median),
        slow > 0 and all(kick.settling_s > kick.kick_s for kick in done),
        f"the median settling time of {len(times)} reversals, each that of the slower wheel; 5 to"
        f" 95 %: {low:.2f} to {high:.2f} s; {slow} took half a second or more",
    )


def _slips(done: list[SettledKick]) -> Claim:
    slips = [abs(kick.slip_rad) for kick in done]
    low, median, high = _quantiles(slips) or [0.0] * 3
    usual = float(np.quantile([abs(kick.drift_rad) for kick in done] or [0.0], USUAL))
    beyond = sum(slip > usual for slip in slips)
    return Claim(
        "R12",
        SENTENCES["R12"],
        "relative phase shown before and after",
        median,
        "rad",
        bootstrap_interval(slips, np.median),
        wilson(beyond, len(slips))[0] > 1 - USUAL,
        f"the median |slip| of {len(slips)} reversals; 5 to 95 %: {low:.3f} to {high:.3f} rad, at"
        f" most {max(slips, default=0.0):.2f}. {beyond} slips exceed {usual:.3f} rad; without a"
        f" kick {USUAL:.0%} stay below it in the same time",
    )
