"""A train on a floor between four slopes.

Whether it turns back at them as a whole, and stays inside, over their angle and k.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.experiments.bodies.stage import EDGE_M, ORDERED, headed, made, ran
from host.runs.contract import Cell, Findings, Options, Row, Setting
from sim_motor.bodies.measures import FALLEN_RAD, reversals_s, started_s
from sim_motor.bodies.presets import preset

# The presets', and the paper's train with more; its authors' program had k = 2 for ten times the
# mass.
TRAINS: tuple[Cell, ...] = (
    {"preset": "paper", "k": 0.5},
    {"preset": "paper", "k": 1.0},
    {"preset": "paper", "k": 2.0},
    {"preset": "snake2019", "k": 2.0},
)
ANGLES = (0.1, 0.2, 0.27, 0.35, 0.5)
# Whose way is shown: the presets', on slopes like those of the program of 2019 (0.27 rad).
SHOWN: tuple[Cell, ...] = (
    {"preset": "paper", "k": 0.5, "angle": 0.27},
    {"preset": "snake2019", "k": 2.0, "angle": 0.27},
)
EVERY_S = 0.1


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A train each, from random phases, with a random heading."""
    return [
        {**train, "angle": angle, "number": number}
        for train in TRAINS
        for angle in ANGLES
        for number in range(options["seeds"])
    ]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The run in a row; of the first that is SHOWN also its head's way, every EVERY_S.

    coherent: part of the time after start-up in which the order parameter is above ORDERED.
    """
    seed = setting.seed_of(cell)
    heading = float(np.random.default_rng(seed).uniform(0.0, 2 * np.pi))
    body = made(
        preset(cell["preset"])._replace(k=cell["k"]),
        "slopes",
        seed=seed,
        angle=cell["angle"],
        prepare=headed(heading),
    )
    did = ran(body, setting.options["seconds"])
    moved, started = did.moved, started_s(did.moved)
    reach = float(np.abs(moved.centre_m[:, :2]).max())
    rows: list[Row] = [
        {
            "reversals": len(reversals_s(moved)),
            "coherent": (
                None
                if started is None
                else float((did.order[moved.t_s >= started] > ORDERED).mean())
            ),
            "reach_m": reach,
            "inside": reach < EDGE_M and did.broke_s is None,
            "flipped": bool((moved.lean_rad > FALLEN_RAD).any()),
        }
    ]
    if cell["number"] == 0 and {name: cell[name] for name in SHOWN[0]} in SHOWN:
        rows += [
            {
                "t_s": float(moved.t_s[at]),
                "x_m": float(did.head[at, 0]),
                "y_m": float(did.head[at, 1]),
            }
            for at in did.every(EVERY_S)
        ]
    return rows


def report(rows: list[Row], setting: Setting) -> Findings:
    """By train and angle: means over the runs, and how many stayed inside."""
    return Findings(
        [],
        {
            "trains": [
                _kind(rows, {**train, "angle": angle}, setting)
                for train in TRAINS
                for angle in ANGLES
            ]
        },
    )


def _kind(rows: list[Row], kind: Cell, setting: Setting) -> dict[str, Any]:
    own = [
        row
        for row in rows
        if "inside" in row and all(row[name] == value for name, value in kind.items())
    ]
    coherent = [row["coherent"] for row in own if row["coherent"] is not None]
    return {
        **kind,
        "runs": len(own),
        "reversals_a_minute": (
            float(np.mean([row["reversals"] for row in own])) * 60.0 / setting.options["seconds"]
        ),
        "coherent": float(np.mean(coherent)) if coherent else None,
        "inside": sum(row["inside"] for row in own),
        "flipped": sum(row["flipped"] for row in own),
        "reach_m": max(row["reach_m"] for row in own),
    }
