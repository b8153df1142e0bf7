"""Torque and speed against the spring constant k (R5, R6).

Locomotion ends at k_c, a robot may rest above it too, and an unstable limit cycle lies between.
There are four kinds of pieces, named by `part`:

- sweep: from locomotion at the greatest k, k goes down and up again in small steps. Each is held
  until the wheels are steady. Where down and up differ at the same k, there is hysteresis.
- fold: from locomotion at k = 1, k goes down in steps of STEP until both wheels rest. Where a wheel
  falls to rest is one measurement of k_c.
- branch: the limit cycles themselves, stable or not, by control-based continuation. Proportional
  and integral feedback on k holds one wheel at a given speed. Once k stays, the wheel is on a limit
  cycle that exists without the feedback at this k. Speed goes through the saddle-node without a
  jump, which k does not. So both branches come out in one piece, and the least k is k_c. Then k is
  frozen at its mean: a wheel stays on a stable cycle, and leaves an unstable one, to rest or to a
  higher speed. Slow cycles pause at each quarter of a turn. Below some 0.2 Hz friction holds the
  wheel there, and the branch ends: what divides rest from motion beyond is no limit cycle.
- ramp: on a robot at rest, the torque rises until the wheels move (R5).
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from host.client.robot import Robot
from host.errors import NotDone
from host.experiments.registry import claimed
from host.experiments.robot.bifurcation_pieces import (
    LEAST_K,
    MIDDLE_K,
    STEP,
    WINDOW_S,
    fold,
    hold,
    sweep,
)
from host.experiments.robot.bifurcation_rows import (
    BifurcationCell,
    BifurcationRow,
    CellRows,
    FoldRow,
    Ramp,
    RampRow,
    branch_rows,
    fold_rows,
    held_cycles,
    least_k,
    ramp_rows,
    restarts,
)
from host.kicking.manoeuvres import ramp
from host.kicking.outcome import require_running
from host.kicking.primitives import drive
from host.kicking.robot_claims import STALL_TORQUE, break_away
from host.logs.log import Log
from host.runs.answers import Answer
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import bootstrap_interval, standard_error
from robot.record import STATES

simulate = None

RUNNING = STATES.index("running")

SIGN = {"forward": 1, "backward": -1}
FOLLOWED = {"forward": "left", "backward": "right"}
LEAST_JUMP = 0.15
RAMPS = 5
SPEEDS_HZ = (0.2, 0.22, 0.24, 0.26, 0.28, 0.3, 0.33, 0.36, 0.4, 0.45, 0.5, 0.6, 0.8)

# k_c from the descents (mean and 95 % interval; each step lowers k by this share) and from the
# branch, None if no point of it was held.
CriticalK = TypedDict(
    "CriticalK",
    {
        "by descent": float,
        "interval": tuple[float, float] | None,
        "step": float,
        "by continuation": float | None,
    },
)


class Falls(TypedDict):
    """Mean |M| (1) and mean speed (turns per second) from which wheels fell to rest."""

    torque: float
    hz: float


class UnstableCycle(TypedDict):
    """A held cycle slower than the saddle-node; columns as in HeldCycle."""

    k: float
    hz: float
    torque: float
    free_hz: float


class Numbers(TypedDict):
    """What the experiment found beside the claims.

    Attributes:
        k_c: where locomotion ends.
        falls_from: the motion just above k_c.
        starts_again_at_k: the least k at which each wheel ran again.
        unstable: the unstable limit cycles.
        not_held_hz: speeds (turns per second) that the feedback could not hold.
    """

    k_c: CriticalK
    falls_from: Falls
    starts_again_at_k: list[float]
    unstable: list[UnstableCycle]
    not_held_hz: list[float]


def cells(options: Options, *, batch: bool) -> list[BifurcationCell]:
    """Sweeps, descents to the fold and branches, in both directions, and ramps."""
    rounds = [(trial, motion) for trial in range(options["rounds"]) for motion in SIGN]
    places = np.linspace(0, len(SPEEDS_HZ) - 1, options["branch"]).round().astype(int)
    work: list[BifurcationCell] = []
    work += [{"part": "sweep", "motion": motion, "trial": trial} for trial, motion in rounds]
    work += [{"part": "fold", "motion": motion, "trial": trial} for trial, motion in rounds]
    work += [
        {"part": "branch", "motion": motion, "held_hz": SPEEDS_HZ[place]}
        for motion in SIGN
        for place in places
    ]
    work += [{"part": "ramp", "trial": trial} for trial in range(RAMPS)]
    return work


def world(cell: BifurcationCell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def ladder(points: int, greatest_k: float) -> list[float]:
    """The values of k of a sweep, upwards: half of them up to MIDDLE_K, where they are denser."""
    below = points // 2
    lower = np.linspace(LEAST_K, MIDDLE_K, below, endpoint=False)
    upper = np.geomspace(MIDDLE_K, greatest_k, points - below)
    return [float(k) for k in np.round([*lower, *upper], 4)]


def trial(cell: BifurcationCell, robot: Robot, log: Log, setting: Setting) -> CellRows:
    """Do one cell. Before and after it, k is at its greatest."""
    greatest_k = setting.options["k"]
    if cell["part"] == "ramp":
        return [_ramp(robot, log)]
    robot.set(k=greatest_k)
    robot.wait(WINDOW_S)
    motion = cell["motion"]
    drive(robot, log, motion)
    rows: CellRows
    if cell["part"] == "sweep":
        rows = sweep(robot, ladder(setting.options["points"], greatest_k))
    elif cell["part"] == "fold":
        rows = fold(robot)
    else:
        rows = [hold(robot, FOLLOWED[motion], SIGN[motion], cell["held_hz"])]
    require_running(robot)
    robot.set(k=greatest_k)
    return rows


def _ramp(robot: Robot, log: Log) -> Ramp:
    span = ramp(robot, log)
    if any(record.state != RUNNING for record in log.records[span.first : span.end]):
        raise NotDone(
            "something stopped the robot while its torque was raised",
            "see its screen and its log, and run the same again",
        )
    found = break_away(log, span)
    return {"torque": found.measured or 0.0, "holds": found.holds is True, "note": found.note}


def report(rows: list[BifurcationRow], setting: Setting) -> Findings:
    """R5 and R6."""
    folds, cycles = fold_rows(rows), held_cycles(rows)
    critical = [(row["k"] + row["k_after"]) / 2 for row in folds]
    node = least_k(cycles)
    asked = {row["held_hz"] for row in branch_rows(rows)}
    numbers: Numbers = {
        "k_c": {
            "by descent": _mean(critical),
            "interval": bootstrap_interval(critical),
            "step": 1 - STEP,
            "by continuation": node["k"] if node else None,
        },
        "falls_from": {
            "torque": _mean([abs(row["torque"]) for row in folds]),
            "hz": _mean([abs(row["hz"]) for row in folds]),
        },
        "starts_again_at_k": restarts(rows),
        "unstable": [
            {
                "k": row["k"],
                "hz": row["hz"],
                "torque": row["torque"],
                "free_hz": row["free_hz"],
            }
            for row in cycles
            if node and row["held_hz"] < node["held_hz"]
        ],
        "not_held_hz": sorted(asked - {row["held_hz"] for row in cycles}),
    }
    foreign = setting.elsewhere(**claimed("bifurcation"))
    stall = _stall(ramp_rows(rows)).doubted(foreign)
    jump = _jump(folds, critical, restarts(rows)).doubted(
        foreign, setting.short_of(points=33, rounds=3)
    )
    answers = [
        Answer("locomotion ends at k_c", *_with_error(critical)),
        Answer("k_c by continuation", node["k"] if node else None),
        Answer("|torque M| before it ends", *_with_error([abs(row["torque"]) for row in folds])),
        Answer("speed before it ends", *_with_error([abs(row["hz"]) for row in folds]), "Hz"),
        Answer("wheels at rest start again at k", *_with_error(restarts(rows))),
        Answer("from rest, wheels move at |M|", *_with_error(_torques(ramp_rows(rows)))),
    ]
    return Findings([stall, jump], numbers, answers=answers)


def _with_error(values: list[float]) -> tuple[float | None, float | None]:
    """The mean and its standard error."""
    interval = bootstrap_interval(values)
    return (_mean(values) if values else None), (standard_error(interval) if interval else None)


def _torques(ramps: list[RampRow]) -> list[float]:
    return [row["torque"] for row in ramps]


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else 0.0


def _stall(ramps: list[RampRow]) -> Claim:
    torques = _torques(ramps)
    failed = [row["note"] for row in ramps if not row["holds"]]
    return Claim(
        "R5",
        SENTENCES["R5"],
        "no motion from rest below, motion above",
        _mean(torques),
        "1",
        bootstrap_interval(torques),
        bool(ramps) and not failed,
        "; ".join(failed)
        or "the mean |M| at which a wheel begins to move; in all of"
        f" {len(ramps)} slow ramps from rest both wheels rest below 0.1 and move at 0.11 at most",
    )


def _jump(folds: list[FoldRow], critical: list[float], again: list[float]) -> Claim:
    before = [abs(row["torque"]) for row in folds]
    after = max((abs(row["torque_after"]) for row in folds), default=1.0)
    interval = bootstrap_interval(before)
    jumps = interval is not None and interval[0] > LEAST_JUMP and after < STALL_TORQUE
    hysteresis = bool(again and critical) and float(np.median(again)) > max(critical)
    low, high = bootstrap_interval(critical) or (0.0, 0.0)
    return Claim(
        "R6",
        SENTENCES["R6"],
        "a jump from |M| > 0.15 to |M| < 0.1; hysteresis",
        _mean(before),
        "1",
        interval,
        jumps and hysteresis,
        f"the mean |M| of {len(before)} wheels before the jump; after it at most {after:.2f}; k_c ="
        f" {_mean(critical):.3f} ({low:.3f} to {high:.3f}). As k increases, {len(again)} wheels"
        f" start to move between k = {min(again, default=0.0):.2f} and"
        f" {max(again, default=0.0):.2f}, half of them by"
        f" {float(np.median(again)) if again else 0.0:.2f}",
    )
