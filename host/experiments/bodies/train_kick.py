"""How many wheels of a running train must be kicked, and for how long, to reverse all of it?

Beyond the paper. The kicks are its membrane and position inversion, on randomly chosen wheels, at a
random moment. A train is too heavy to be stopped by its rods within one turn of the wheels; so the
position inversion is also tried for so long that it brakes the train.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TypedDict

import numpy as np
from numpy.typing import NDArray

from host.experiments.bodies.simulation import ORDERED, build_pushed_train
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import wilson
from robot.kicks import MEMBRANE, POSITION, PULSE_BETA, Kick
from sim_motor.bodies.measures import order
from sim_motor.bodies.presets import preset

if TYPE_CHECKING:
    from sim_motor.bodies.body import Body

WHEELS = (4, 6, 7, 8, 9, 10)
LENGTHS_S = (0.1, 0.5, 1.0, 1.25, 1.5, 2.0, 2.5, 3.5)
# A train runs for START_S (s) before its first kick, then randomly up to CHANCE_S longer before
# each kick, and for WATCH_S after it.
START_S, CHANCE_S, WATCH_S = 5.0, 0.3, 5.0
# Below this part of the speed before the kick, a train is stopped, and a kick has braked it.
STOPPED, BRAKED = 0.2, 0.25
REVERSED, STOPS, GOES_ON, MIXED = "reversed", "stopped", "goes on", "wheels disagree"


class Cell(TypedDict):
    """All trials of one kick.

    Attributes:
        mode: membrane or position.
        wheels: how many are kicked.
        seconds: how long (s); None for the membrane inversion, which acts at once.
    """

    mode: str
    wheels: int
    seconds: float | None


class Trial(TypedDict):
    """One trial.

    Attributes:
        trial: its number.
        before_rad_s: mean omega of the wheels before the kick (rad/s).
        end_rad_s: the same when the kick ends (rad/s).
        after_rad_s: the same WATCH_S s later (rad/s).
        outcome: 'reversed', 'stopped', 'goes on' or 'wheels disagree'.
    """

    trial: int
    before_rad_s: float
    end_rad_s: float
    after_rad_s: float
    outcome: str


class Row(Cell, Trial):
    """One line of the table: the kick, and one of its trials."""


class KickNumbers(Cell):
    """All trials of one kick.

    Attributes:
        reversed: how many reversed the train.
        interval: of that rate (95 %).
        outcomes: how many came to each outcome.
        end_of_before: median of end_rad_s / before_rad_s.
    """

    trials: int
    reversed: int
    interval: list[float]
    outcomes: dict[str, int]
    end_of_before: float


class Numbers(TypedDict):
    """What the experiment found.

    Attributes:
        fewest_wheels_that_reversed: of all kicks that ever reversed the train.
        surest: the kick that reverses it most often. Both are None if no kick reverses it.
    """

    preset: str
    kicks: list[KickNumbers]
    fewest_wheels_that_reversed: int | None
    surest: KickNumbers | None


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is all trials of one kick."""
    kicks: list[Cell] = []
    kicks += [{"mode": MEMBRANE, "wheels": wheels, "seconds": None} for wheels in WHEELS]
    kicks += [
        {"mode": POSITION, "wheels": wheels, "seconds": seconds}
        for wheels in WHEELS
        for seconds in LENGTHS_S
    ]
    return kicks


def simulate(cell: Cell, setting: Setting) -> list[Trial]:
    """Kick a train again and again; a train that no longer runs is replaced by another."""
    rng = np.random.default_rng(setting.seed_of(cell))
    trials: list[Trial] = []
    body: Body | None = None
    for number in range(setting.options["trials"]):
        if body is None:
            own = preset(setting.options["preset"])
            body = build_pushed_train(own, seed=int(rng.integers(2**31)))
            body.run(START_S)
        body.run(rng.uniform(0.0, CHANCE_S))
        before = body.omega.copy()
        drawn = rng.permutation(len(body.wheels))[: cell["wheels"]].tolist()
        body.kick(build_kick(cell, [body.wheels[wheel] for wheel in drawn], body))
        body.run(cell["seconds"] or 0.0)
        end = float(body.omega.mean())
        body.run(WATCH_S)
        after = body.omega.copy()
        outcome = classify_outcome(before, after)
        trials.append(
            {
                "trial": number,
                "before_rad_s": float(before.mean()),
                "end_rad_s": end,
                "after_rad_s": float(after.mean()),
                "outcome": outcome,
            }
        )
        if outcome in (STOPS, MIXED):
            body = None
    return trials


def build_kick(cell: Cell, wheels: list[str], body: Body) -> Kick:
    """The cell's kick on these wheels of the body, which begins now."""
    if cell["seconds"] is None:
        return Kick("membrane", MEMBRANE, wheels, 1, begin=body.step)
    ticks = round(cell["seconds"] / body.model.opt.timestep)
    return Kick(
        "position", POSITION, wheels, ticks, pulse=PULSE_BETA, values=(1.0, 1.0), begin=body.step
    )


def classify_outcome(before: NDArray[np.float64], after: NDArray[np.float64]) -> str:
    """Say what a kick did, by the wheels' omega before it and well after it, (wheels,)."""
    if np.abs(after).mean() < STOPPED * np.abs(before).mean():
        return STOPS
    if order(after) <= ORDERED:
        return MIXED
    return GOES_ON if np.sign(after.mean()) == np.sign(before.mean()) else REVERSED


def report(rows: list[Row], setting: Setting) -> Findings:
    """By kick: how many trials came to each outcome; no claim of the paper."""
    kinds = dict.fromkeys((row["mode"], row["wheels"], row["seconds"]) for row in rows)
    kicks = [
        _summarize_kick(
            {"mode": mode, "wheels": wheels, "seconds": seconds},
            [
                row
                for row in rows
                if (row["mode"], row["wheels"], row["seconds"]) == (mode, wheels, seconds)
            ],
        )
        for mode, wheels, seconds in kinds
    ]
    reversing = [kick["wheels"] for kick in kicks if kick["reversed"]]
    surest = max(kicks, key=lambda kick: kick["reversed"] / kick["trials"])
    numbers: Numbers = {
        "preset": setting.options["preset"],
        "kicks": kicks,
        "fewest_wheels_that_reversed": min(reversing, default=None),
        "surest": surest if surest["reversed"] else None,
    }
    return Findings([], numbers)


def _summarize_kick(kick: Cell, trials: list[Row]) -> KickNumbers:
    outcomes = Counter(row["outcome"] for row in trials)
    speeds = [row["end_rad_s"] / row["before_rad_s"] for row in trials]
    return {
        **kick,
        "trials": len(trials),
        "reversed": outcomes[REVERSED],
        "interval": list(wilson(outcomes[REVERSED], len(trials))),
        "outcomes": dict(outcomes),
        "end_of_before": float(np.median(speeds)),
    }
