"""Trains on a flat floor whose wheels all start at random phases.

Do the wheels find one direction by themselves, and which one? (B2)
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from host.experiments.bodies.simulation import ORDERED, PRESETS, build_body, run_body
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import fraction, wilson
from sim_motor.bodies.presets import preset

# Rows are EVERY_S (s) apart, and a train is judged by its last JUDGED_S (s).
EVERY_S, JUDGED_S = 0.05, 1.0
# How long a train may take to find its direction, and how many trains of each preset it takes until
# both directions occur almost surely.
LEAST_S, LEAST_TRAINS = 15.0, 10


class Cell(TypedDict):
    """One train.

    Attributes:
        preset: name of the preset.
        number: number of the random start.
    """

    preset: str
    number: int


class Sample(TypedDict):
    """The train at one time.

    Attributes:
        t_s: time since the start (s).
        order: order parameter of the wheels, from 0 to 1 (1).
        omega_rad_s: their mean omega (rad/s).
    """

    t_s: float
    order: float
    omega_rad_s: float


class Row(Cell, Sample):
    """One line of the table: the cell, and a sample of its train."""


class Start(TypedDict):
    """How one train started.

    Attributes:
        preset: its cell.
        number: its cell.
        order: mean order parameter in the last JUDGED_S.
        direction: then, 1 forward, -1 backward, 0 at rest.
        ordered_s: the time (s) from which on it is ordered, or None.
    """

    preset: str
    number: int
    order: float
    direction: int
    ordered_s: float | None


class Numbers(TypedDict):
    """The trains of one preset.

    Attributes:
        trains: how many there are.
        ordered: how many of them end ordered, and in which direction.
        forward: how many of them end ordered, and in which direction.
        backward: how many of them end ordered, and in which direction.
        lowest_order: of all trains.
        ordered_s_median: the time (s) from which on they are ordered; None if no train is.
        ordered_s_latest: the time (s) from which on they are ordered; None if no train is.
    """

    trains: int
    ordered: int
    forward: int
    backward: int
    lowest_order: float
    ordered_s_median: float | None
    ordered_s_latest: float | None


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is one train."""
    return [
        {"preset": name, "number": number} for name in PRESETS for number in range(options["seeds"])
    ]


def simulate(cell: Cell, setting: Setting) -> list[Sample]:
    """Samples of the train, every EVERY_S."""
    body = build_body(preset(cell["preset"]), seed=setting.seed_of(cell))
    run = run_body(body, setting.options["seconds"])
    order, omega = run.order, run.course.omega.mean(axis=1)
    return [
        {
            "t_s": float(run.course.t_s[at]),
            "order": float(order[at]),
            "omega_rad_s": float(omega[at]),
        }
        for at in run.every(EVERY_S)
    ]


def starts(rows: list[Row]) -> list[Start]:
    """How each train started."""
    found: list[Start] = []
    for name, number in dict.fromkeys((row["preset"], row["number"]) for row in rows):
        train = [row for row in rows if (row["preset"], row["number"]) == (name, number)]
        t = np.array([row["t_s"] for row in train])
        order = np.array([row["order"] for row in train])
        omega = np.array([row["omega_rad_s"] for row in train])
        late = t > t[-1] - JUDGED_S
        unordered = np.flatnonzero(order <= ORDERED)
        ordered_s = None
        if len(unordered) and unordered[-1] + 1 < len(t):
            ordered_s = float(t[unordered[-1] + 1])
        found.append(
            {
                "preset": name,
                "number": number,
                "order": float(order[late].mean()),
                "direction": int(np.sign(omega[late].mean())),
                "ordered_s": ordered_s,
            }
        )
    return found


def report(rows: list[Row], setting: Setting) -> Findings:
    """B2; numbers: a `Numbers` for each preset."""
    found = starts(rows)
    numbers = {
        name: _count([start for start in found if start["preset"] == name])
        for name in dict.fromkeys(start["preset"] for start in found)
    }
    done, tried = sum(start["order"] > ORDERED for start in found), len(found)
    both = all(count["forward"] and count["backward"] for count in numbers.values())
    note = "the share of trains that do; " + "; ".join(
        f"{name}: {count['ordered']} of {count['trains']}, {count['forward']} forward and"
        f" {count['backward']} backward"
        for name, count in numbers.items()
    )
    claim = Claim(
        "B2",
        SENTENCES["B2"],
        f"order parameter > {ORDERED:g} in all, in both presets; both directions occur",
        fraction(done, tried),
        "1",
        wilson(done, tried),
        done == tried > 0 and both,
        note,
    )
    # A train that finds no direction disproves the claim, however few there were.
    few = "" if done < tried else setting.short_of(seeds=LEAST_TRAINS)
    return Findings([claim.doubted(setting.short_of(seconds=LEAST_S), few)], numbers)


def _count(found: list[Start]) -> Numbers:
    ordered_s = [start["ordered_s"] for start in found if start["ordered_s"] is not None]
    ordered = [start for start in found if start["order"] > ORDERED]
    return {
        "trains": len(found),
        "ordered": len(ordered),
        "forward": sum(start["direction"] > 0 for start in ordered),
        "backward": sum(start["direction"] < 0 for start in ordered),
        "lowest_order": min(start["order"] for start in found),
        "ordered_s_median": float(np.median(ordered_s)) if ordered_s else None,
        "ordered_s_latest": max(ordered_s, default=None),
    }
