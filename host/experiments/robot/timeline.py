"""The three kicks one after the other, each there and back, as in the paper's timeline.

Settling, and the slip between the wheels.

The wheels' relative phase is the left one's angle less the right one's, as a mean over WINDOW_S, so
that the encoder's counts do not show. Its slip is how much it changes from before a kick until
after both wheels have settled; beside it stands the drift, which is how much it changed in a time
as long before the kick, measured in the same way.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.kicking.outcome import kick_and_watch
from host.kicking.primitives import drive
from host.kicking.robot_claims import LEAST_TRIALS, inversions
from host.logs.log import Log
from host.logs.motion import settling_s
from host.runs.claims import Claim, too_few
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import spread, wilson
from robot.kicks import DIRECTION_TICKS, MEMBRANE, PHASE, POSITION, WHEELS

simulate = None

KICKS: dict[str, dict[str, Any]] = {MEMBRANE: {}, POSITION: {"ticks": 3}, PHASE: {"ticks": 4}}
TURNS = (1, 2)  # there and back
STEADY_S, TURN_S, WINDOW_S = 3.0, 0.5, 0.5
# A slip is told from the drift by how many exceed what all but so much of the drift stays below.
USUAL = 0.95
# What the first round keeps of each tick for the figure, from before the first of two kicks until
# after the second.
SHOWN = [f"{side}_{name}" for side in WHEELS for name in ("x1", "x2", "torque")]
SHOWN_BEFORE_S, SHOWN_AFTER_S = 1.0, 2.0


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Rounds of all three kicks."""
    return [{"trial": trial} for trial in range(options["trials"])]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """One round: each kick takes the robot from forward to backward, and back.

    Rows of `kind` kick, and of kind tick in the first one.
    """
    rng = np.random.default_rng(setting.seed_of(cell))
    rows: list[Row] = []
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
                    "kick_s": outcome.ticks * float(log.info["params"]["tick_s"]),
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
    left, right = (log.column(side + "_phi_rad") for side in WHEELS)
    return np.asarray(left - right)


def _slip(log: Log, tick: int) -> Row:
    """When the wheels settled after the kick that began in this tick, and their relative phase.

    None for what did not settle.
    """
    t, relative = log.column("t_s"), _relative(log)
    begin_s = float(t[_row_of(log, tick)])
    times = [settling_s(log, side, tick) for side in WHEELS]

    def mean(first_s: float) -> float:
        return float(relative[(t >= first_s) & (t < first_s + WINDOW_S)].mean())

    before = mean(begin_s - WINDOW_S)
    known = [time for time in times if time is not None]
    settled = len(known) == len(WHEELS)
    after = mean(begin_s + max(known)) if settled else None
    earlier = mean(begin_s - max(known) - 2 * WINDOW_S) if settled else None
    return {
        **{f"settling_{side}_s": time for side, time in zip(WHEELS, times, strict=True)},
        "relative_before_rad": wrapped(before),
        "relative_after_rad": None if after is None else wrapped(after),
        "slip_rad": None if after is None else after - before,
        "drift_rad": None if earlier is None else before - earlier,
    }


def wrapped(angle: float) -> float:
    """The same direction in [-pi, pi)."""
    return (angle + pi) % (2 * pi) - pi


def _ticks(log: Log, mode: str, kicked: list[int]) -> list[Row]:
    """What was around the kicks that begin in these rows of the log; times count from the first."""
    t, acts = log.column("t_s"), log.column("kick") > 0
    shown = np.flatnonzero(
        (t >= t[kicked[0]] - SHOWN_BEFORE_S) & (t <= t[kicked[-1]] + SHOWN_AFTER_S)
    )
    columns = {name: log.column(name) for name in SHOWN}
    relative = _relative(log)
    return [
        {
            "kind": "tick",
            "mode": mode,
            "t_s": float(t[row] - t[kicked[0]]),
            "kicked": bool(acts[row]),
            "relative_rad": float(relative[row]),
            **{name: float(column[row]) for name, column in columns.items()},
        }
        for row in shown.tolist()
    ]


def kicks(rows: list[Row], mode: str | None = None) -> list[Row]:
    """The kicks that reversed the robot and after which both wheels settled."""
    done = [
        row
        for row in rows
        if row["kind"] == "kick" and row["reversed"] and row["slip_rad"] is not None
    ]
    return [row for row in done if mode in (None, row["mode"])]


def settling(rows: list[Row]) -> list[float]:
    """How long each kick's slower wheel took."""
    return [max(float(row[f"settling_{side}_s"]) for side in WHEELS) for row in rows]


def report(rows: list[Row], setting: Setting) -> Findings:
    """R8, R11 and R12."""
    tried = [row for row in rows if row["kind"] == "kick"]
    numbers = {
        mode: {
            "reversed": sum(row["reversed"] for row in tried if row["mode"] == mode),
            "of": sum(row["mode"] == mode for row in tried),
            "settling_s": _quantiles(settling(kicks(rows, mode))),
            "slip_rad": _quantiles([abs(row["slip_rad"]) for row in kicks(rows, mode)]),
            "drift_rad": _quantiles([abs(row["drift_rad"]) for row in kicks(rows, mode)]),
        }
        for mode in KICKS
    }
    membrane = inversions([row["reversed"] for row in tried if row["mode"] == MEMBRANE])
    few = too_few(len(kicks(rows)), LEAST_TRIALS, "kicks that reversed the robot")
    claims = [
        membrane,
        _settling(kicks(rows)).doubted(few),
        _slips(kicks(rows)).doubted(few),
    ]
    return Findings([claim.doubted(setting.elsewhere()) for claim in claims], numbers)


def _quantiles(values: list[float]) -> list[float] | None:
    """5, 50 and 95 %."""
    return [float(value) for value in np.quantile(values, (0.05, 0.5, 0.95))] if values else None


def _settling(done: list[Row]) -> Claim:
    times = settling(done)
    low, median, high = _quantiles(times) or [0.0] * 3
    slow = sum(time >= 0.5 for time in times)
    return Claim(
        "R11",
        "settling into the reversed cycle outlasts the kick (half a second or more is seen)",
        "distribution of settling times",
        median,
        "s",
        spread(times, np.median),
        slow > 0 and all(time > row["kick_s"] for time, row in zip(times, done, strict=True)),
        f"median of {len(times)} reversals, the slower wheel; 5 to 95 %: {low:.2f} to {high:.2f} s;"
        f" {slow} took half a second or more",
    )


def _slips(done: list[Row]) -> Claim:
    slips = [abs(row["slip_rad"]) for row in done]
    low, median, high = _quantiles(slips) or [0.0] * 3
    usual = float(np.quantile([abs(row["drift_rad"]) for row in done] or [0.0], USUAL))
    beyond = sum(slip > usual for slip in slips)
    return Claim(
        "R12",
        "a phase slip between left and right appears after kicks",
        "relative phase shown before and after",
        median,
        "rad",
        spread(slips, np.median),
        wilson(beyond, len(slips))[0] > 1 - USUAL,
        f"median |slip| of {len(slips)} reversals; 5 to 95 %: {low:.3f} to {high:.3f} rad, at most"
        f" {max(slips, default=0.0):.2f}; without a kick {USUAL:.0%} stay below {usual:.3f} in that"
        f" time, which {beyond} slips exceed",
    )
