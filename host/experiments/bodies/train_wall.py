"""A train between two walls, of which no sensor tells it.

How often in a row it reverses as a whole (B3).

Beside it a train whose wheels have a constant torque instead of a controller. A train that hits a
wall at an angle may turn along it, and leave sideways, where there is no wall; or it rests at a
wall, its rods at their dead centres. Walls are dead or bouncy, as in LPZRobots.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from typing import Any

import numpy as np

from host.experiments.bodies.stage import ORDERED, Ran, made, ran
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from sim_motor.bodies.measures import reversals_s
from sim_motor.bodies.presets import Preset, preset

# The presets, and that of 2019 with the drag (N s/rad) that its authors' program was also run with.
TRAINS: tuple[Cell, ...] = (
    {"preset": "paper", "drag": None},
    {"preset": "snake2019", "drag": None},
    {"preset": "snake2019", "drag": 0.005},
)
# A constant force at the wheel's rim, as a part of k: "calculated from mean angular velocity" in
# the program of 2019.
CONSTANT = 0.162
LEAST = 5
# Trains of each kind for a median, and the time for so many reversals.
LEAST_TRAINS, LEAST_S = 3, 60.0
EVERY_S, WHOLE_S, END_S, STUCK_M = 0.05, (0.5, 1.5), 5.0, 0.25
STUCK, RUNS, LOST = "stuck", "runs", "could not be followed"


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A train each. `number` is that of its chance, the wheels' phases at the start.

    Without a controller there is none.
    """
    walls = [{**train, "bouncy": bouncy} for train in TRAINS for bouncy in (False, True)]
    driven = [
        {**wall, "controller": True, "number": number}
        for wall in walls
        for number in range(options["seeds"])
    ]
    return driven + [{**wall, "controller": False, "number": 0} for wall in walls]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The run in a row; of the first of its kind also its middle's way and its wheels' mean omega, every EVERY_S."""
    own = _train(cell)
    torque = None if cell["controller"] else CONSTANT * own.k * own.wheel_radius
    seed = setting.seed_of({"number": cell["number"]})  # the same start between all walls
    did = ran(
        made(own, "walls", seed=seed, bouncy=cell["bouncy"], torque=torque),
        setting.options["seconds"],
    )
    rows = [told(did)]
    if cell["number"] == 0:
        omega = did.moved.omega.mean(axis=1)
        rows += [
            {
                "t_s": float(did.moved.t_s[at]),
                "x_m": float(did.moved.centre_m[at, 0]),
                "omega_rad_s": float(omega[at]),
            }
            for at in did.every(EVERY_S)
        ]
    return rows


def _train(cell: Cell) -> Preset:
    own = preset(cell["preset"])
    return own if cell["drag"] is None else own.with_drag(cell["drag"])


def told(did: Ran) -> Row:
    """reversals_s: when most wheels reversed; whole: how often all went one way soon after.

    aside_m: how far it is along the walls.
    """
    moved = did.moved
    times = reversals_s(moved)
    soon = [(moved.t_s >= time + WHOLE_S[0]) & (moved.t_s <= time + WHOLE_S[1]) for time in times]
    rests = np.ptp(moved.centre_m[did.last(END_S)], axis=0).max() < STUCK_M
    return {
        "reversals_s": times,
        "whole": sum(bool(did.order[window].mean() > ORDERED) for window in soon if window.any()),
        "aside_m": float(abs(moved.centre_m[-1, 1])),
        "ended": LOST if did.broke_s is not None else STUCK if rests else RUNS,
    }


def runs_of(rows: list[Row], **fields: Any) -> list[Row]:
    """The rows that tell of a whole run, of a kind."""
    return [
        row
        for row in rows
        if "ended" in row and all(row[name] == value for name, value in fields.items())
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """B3: by the lesser preset, each between the walls at which it reverses more often (median of its runs)."""
    kinds = [_kind(rows, train, bouncy) for train in TRAINS for bouncy in (False, True)]
    best = {
        name: max(
            (kind for kind in kinds if kind["preset"] == name and kind["drag"] is None), key=_median
        )
        for name in ("paper", "snake2019")
    }
    least = min(_median(kind) for kind in best.values())
    still = all(kind["constant_torque"]["ended"] == STUCK for kind in kinds)
    claim = Claim(
        "B3",
        "the train reverses as a whole at a wall, with no sensor for it",
        f">= {LEAST} reversals in a row in both presets; a train with constant torque gets stuck",
        least,
        "1",
        None,
        least >= LEAST and still,
        f"median of the runs, in the preset that has fewer, in {setting.options['seconds']:g} s; "
        + "; ".join(map(_words, kinds)),
    )
    doubt = setting.short_of(seeds=LEAST_TRAINS, seconds=LEAST_S)
    return Findings([claim.doubted(doubt)], {"kinds": kinds})


def _kind(rows: list[Row], train: Cell, bouncy: bool) -> dict[str, Any]:
    driven = runs_of(rows, **train, bouncy=bouncy, controller=True)
    legs = [later - earlier for row in driven for earlier, later in pairwise(row["reversals_s"])]
    (constant,) = runs_of(rows, **train, bouncy=bouncy, controller=False)
    return {
        **train,
        "bouncy": bouncy,
        "reversals": [row["whole"] for row in driven],
        "not_whole": sum(len(row["reversals_s"]) - row["whole"] for row in driven),
        "ended": dict(Counter(row["ended"] for row in driven)),
        "aside_m": [round(row["aside_m"], 1) for row in driven],
        "leg_s_median": float(np.median(legs)) if legs else None,
        "constant_torque": {"reversals": len(constant["reversals_s"]), "ended": constant["ended"]},
    }


def _median(kind: dict[str, Any]) -> float:
    return float(np.median(kind["reversals"]))


def name_of(train: Cell) -> str:
    """A train in words."""
    return str(train["preset"]) + (
        "" if train["drag"] is None else f" with drag {train['drag']:g} N s/rad"
    )


def _words(kind: dict[str, Any]) -> str:
    counts, ended = (
        " ".join(str(count) for count in kind["reversals"]),
        ", ".join(f"{count} {how}" for how, count in kind["ended"].items()),
    )
    return (
        f"{name_of(kind)}, {'bouncy' if kind['bouncy'] else 'dead'} walls: {counts} reversals, in"
        f" the end {ended}"
    )
