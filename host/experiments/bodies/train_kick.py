"""How many of a running train's wheels must be kicked, and for how long, that all of it reverses (beyond the paper).

The kicks are the paper's membrane and position inversion, on wheels drawn by chance, at a moment
drawn by chance. The train weighs much more than its rods can stop within a turn of the wheels: so
the position inversion is also tried for so long that it brakes the train.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from host.experiments.bodies.stage import ORDERED, pushed_off
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import wilson
from robot.kicks import MEMBRANE, POSITION, PULSE_BETA, Kick
from sim_motor.bodies.measures import order
from sim_motor.bodies.presets import preset

if TYPE_CHECKING:
    from sim_motor.bodies.body import Body

WHEELS = (4, 6, 7, 8, 9, 10)
LENGTHS_S = (0.1, 0.5, 1.0, 1.25, 1.5, 2.0, 2.5, 3.5)
# A train is let run for so long (s) before the first kick; then for up to a little longer, and
# after the kick.
START_S, CHANCE_S, WATCH_S = 5.0, 0.3, 5.0
# A train whose wheels turn more slowly than the first part of the speed before the kick is stopped;
# a kick has braked it at the second.
STOPPED, BRAKED = 0.2, 0.25
REVERSED, STOPS, ON, MIXED = "reversed", "stopped", "goes on", "wheels disagree"


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """All trials of a kick on so many wheels."""
    inversions = [{"mode": MEMBRANE, "wheels": wheels, "seconds": None} for wheels in WHEELS]
    return inversions + [
        {"mode": POSITION, "wheels": wheels, "seconds": seconds}
        for wheels in WHEELS
        for seconds in LENGTHS_S
    ]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """A trial each: the wheels' mean omega (rad/s) before the kick, when it ends, and WATCH_S later. What then runs is kicked again."""
    rng = np.random.default_rng(setting.seed_of(cell))
    rows: list[Row] = []
    body: Body | None = None
    for trial in range(setting.options["trials"]):
        if body is None:
            body = pushed_off(preset(setting.options["preset"]), seed=int(rng.integers(2**31)))
            body.run(START_S)
        body.run(rng.uniform(0.0, CHANCE_S))
        before = body.omega.copy()
        kicked = [
            body.wheels[wheel]
            for wheel in rng.permutation(len(body.wheels))[: cell["wheels"]].tolist()
        ]
        body.kick(kick_of(cell, kicked, body))
        body.run(cell["seconds"] or 0.0)
        end = float(body.omega.mean())
        body.run(WATCH_S)
        after = body.omega.copy()
        outcome = outcome_of(before, after)
        rows.append(
            {
                "trial": trial,
                "before_rad_s": float(before.mean()),
                "end_rad_s": end,
                "after_rad_s": float(after.mean()),
                "outcome": outcome,
            }
        )
        if outcome in (STOPS, MIXED):
            body = None
    return rows


def kick_of(cell: Cell, wheels: list[str], body: Body) -> Kick:
    """The cell's kick on these wheels, now."""
    if cell["mode"] == MEMBRANE:
        return Kick("membrane", MEMBRANE, wheels, 1, begin=body.step)
    ticks = round(cell["seconds"] / body.model.opt.timestep)
    return Kick(
        "position", POSITION, wheels, ticks, pulse=PULSE_BETA, values=(1.0, 1.0), begin=body.step
    )


def outcome_of(before: Any, after: Any) -> str:
    """What became of a train whose wheels turned at omega `before` and then `after`, (wheels,)."""
    if np.abs(after).mean() < STOPPED * np.abs(before).mean():
        return STOPS
    if order(after) <= ORDERED:
        return MIXED
    return ON if np.sign(after.mean()) == np.sign(before.mean()) else REVERSED


def report(rows: list[Row], setting: Setting) -> Findings:
    """By kick: how many trials reversed the train, or ended otherwise; no claim of the paper."""
    kinds = dict.fromkeys((row["mode"], row["wheels"], row["seconds"]) for row in rows)
    kicks = [
        _kind(kind, [row for row in rows if (row["mode"], row["wheels"], row["seconds"]) == kind])
        for kind in kinds
    ]
    reversing = [kick["wheels"] for kick in kicks if kick["reversed"]]
    best = max(kicks, key=lambda kick: kick["reversed"] / kick["trials"])
    numbers = {
        "preset": setting.options["preset"],
        "kicks": kicks,
        "fewest_wheels_that_reversed": min(reversing, default=None),
    }
    return Findings([], {**numbers, "surest": best if best["reversed"] else None})


def _kind(kind: tuple[str, int, float | None], own: list[Row]) -> dict[str, Any]:
    outcomes = Counter(row["outcome"] for row in own)
    return {
        **dict(zip(("mode", "wheels", "seconds"), kind, strict=True)),
        "trials": len(own),
        "reversed": outcomes[REVERSED],
        "interval": list(wilson(outcomes[REVERSED], len(own))),
        "outcomes": dict(outcomes),
        "end_of_before": float(np.median([row["end_rad_s"] / row["before_rad_s"] for row in own])),
    }
