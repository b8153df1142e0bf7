"""Trains on a flat floor, all wheels at random phases.

How they find one direction by themselves, and which (B2).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.experiments.bodies.stage import ORDERED, PRESETS, made, ran
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import fraction, wilson
from sim_motor.bodies.presets import preset

EVERY_S, JUDGED_S = 0.05, 1.0
# How long a train may take to find its direction, and how many trains of each preset it takes until
# both directions occur almost surely.
LEAST_S, LEAST_TRAINS = 15.0, 10


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A train each."""
    return [
        {"preset": name, "number": number} for name in PRESETS for number in range(options["seeds"])
    ]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """Order parameter and mean omega of all wheels (rad/s), every EVERY_S."""
    did = ran(made(preset(cell["preset"]), seed=setting.seed_of(cell)), setting.options["seconds"])
    order, omega = did.order, did.moved.omega.mean(axis=1)
    return [
        {
            "t_s": float(did.moved.t_s[at]),
            "order": float(order[at]),
            "omega_rad_s": float(omega[at]),
        }
        for at in did.every(EVERY_S)
    ]


def starts(rows: list[Row]) -> list[dict[str, Any]]:
    """Of each train: its preset and number, its order parameter in the last JUDGED_S, its direction then, and since when it is ordered."""
    found = []
    for name, number in dict.fromkeys((row["preset"], row["number"]) for row in rows):
        own = [row for row in rows if (row["preset"], row["number"]) == (name, number)]
        t, order, omega = (
            np.array([row[field] for row in own]) for field in ("t_s", "order", "omega_rad_s")
        )
        late = t > t[-1] - JUDGED_S
        unordered = np.flatnonzero(order <= ORDERED)
        since = (
            float(t[unordered[-1] + 1]) if len(unordered) and unordered[-1] + 1 < len(t) else None
        )
        found.append(
            {
                "preset": name,
                "number": number,
                "order": float(order[late].mean()),
                "direction": int(np.sign(omega[late].mean())),
                "ordered_s": since,
            }
        )
    return found


def report(rows: list[Row], setting: Setting) -> Findings:
    """B2."""
    found = starts(rows)
    numbers = {
        name: _told([one for one in found if one["preset"] == name])
        for name in dict.fromkeys(one["preset"] for one in found)
    }
    done, tried = sum(one["order"] > ORDERED for one in found), len(found)
    both = all(told["forward"] and told["backward"] for told in numbers.values())
    note = "; ".join(
        f"{name}: {told['ordered']} of {told['trains']}, {told['forward']} forward and"
        f" {told['backward']} backward"
        for name, told in numbers.items()
    )
    claim = Claim(
        "B2",
        "the ten wheels of a train coordinate speed and direction on their own, from random phases",
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


def _told(found: list[dict[str, Any]]) -> dict[str, Any]:
    since = [one["ordered_s"] for one in found if one["ordered_s"] is not None]
    return {
        "trains": len(found),
        "ordered": sum(one["order"] > ORDERED for one in found),
        "forward": sum(one["order"] > ORDERED and one["direction"] > 0 for one in found),
        "backward": sum(one["order"] > ORDERED and one["direction"] < 0 for one in found),
        "lowest_order": min(one["order"] for one in found),
        "ordered_s_median": float(np.median(since)) if since else None,
        "ordered_s_latest": max(since, default=None),
    }
