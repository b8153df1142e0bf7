"""What a tick does to the thresholds, in numbers, and how accurate these are."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import log2
from typing import TypedDict

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.hopf import estimate
from host.theory.model.wheel import wheel_of
from host.theory.studies.tick_rows import (
    NEW,
    OLD,
    ORDERS,
    LimitRow,
    Order,
    TickStudyRow,
    check_of,
    limit_of,
    over_ticks,
    point_of,
    short_ticks,
)

# The ticks whose shift of k_c is reported, s.
SHOWN_S = (0.03, 0.04)


class ContinuousNumbers(TypedDict):
    """The thresholds of the model without ticks, and its speed (Hz), if it rolls."""

    k_c: float
    k_rolls: float | None
    k_stops: float | None
    hz: float | None
    note: str | None


class Multiplier(TypedDict):
    """The leading multiplier of rest at k_c."""

    modulus: float | None
    angle_rad: float | None


class OrderNumbers(TypedDict):
    """The thresholds with one order within the tick, and how they move with the tick."""

    k_c: float | None
    shift_pct: float | None
    multiplier: Multiplier
    k_rolls: float | None
    k_stops: float | None
    hz: float | None
    shift_pct_at_tick_s: dict[str, float | None]
    k_c_rises_per_s_of_tick: float


class Accuracy(TypedDict):
    """Relative differences between methods."""

    jacobian_against_differences: float | None
    k_c_against_time_course: float | None
    k_rolls_and_stops_followed_twice_as_long: float | None
    k_c_without_tick_against_hopf: float
    order_of_convergence: float
    k_rolls_without_tick_against_continuous: float | None


class Numbers(TypedDict):
    """All numbers of the study."""

    tick_s: float
    latency_s: float
    k_hopf: float
    k_estimate: float
    continuous: ContinuousNumbers
    new: OrderNumbers
    old: OrderNumbers
    accuracy: dict[Order, Accuracy]


def report(rows: list[TickStudyRow], setting: Setting) -> Findings:
    """The thresholds and how they move with the tick. The paper, without ticks, claims nothing."""
    options = setting.options
    limit = limit_of(rows)
    numbers: Numbers = {
        "tick_s": options["tick"],
        "latency_s": options["latency"],
        "k_hopf": limit["k_c"],
        "k_estimate": estimate(wheel_of(options)),
        "continuous": {
            "k_c": limit["k_c"],
            "k_rolls": limit["k_rolls"],
            "k_stops": limit["k_stops"],
            "hz": limit["hz"],
            "note": limit["note"],
        },
        "new": _numbers(rows, NEW, limit["k_c"]),
        "old": _numbers(rows, OLD, limit["k_c"]),
        "accuracy": {
            order: _accuracy(rows, order, limit, late=options["latency"] > 0.0) for order in ORDERS
        },
    }
    answers = [Answer("without ticks: rest is unstable from k", limit["k_c"])]
    answers += _thresholds("without ticks", numbers["continuous"])
    for order, own in (("new", numbers["new"]), ("old", numbers["old"])):
        answers.append(Answer(f"torque by {order} potentials: rest is unstable from k", own["k_c"]))
        answers.append(Answer(f"torque by {order} potentials: shift", own["shift_pct"], None, "%"))
        answers += _thresholds(f"torque by {order} potentials", own)
    return Findings([], numbers, answers=answers)


def _thresholds(where: str, own: ContinuousNumbers | OrderNumbers) -> list[Answer]:
    return [
        Answer(f"{where}: rolls from k", own["k_rolls"]),
        Answer(f"{where}: stops below k", own["k_stops"]),
        Answer(f"{where}: turns at k = 8", own["hz"], None, "Hz"),
    ]


def shift_pct(k_c: float | None, k_hopf: float) -> float | None:
    """By how much k_c is above that of the continuous model, in percent."""
    return None if k_c is None else 100 * (k_c / k_hopf - 1)


def _numbers(rows: list[TickStudyRow], order: Order, k_hopf: float) -> OrderNumbers:
    point = point_of(rows, order)
    k_c_at = {row["tick_s"]: row["k_c"] for row in over_ticks(rows, order)}
    slopes = [(k_c - k_hopf) / tick_s for tick_s, k_c in _short(rows, order)]
    return {
        "k_c": point["k_c"],
        "shift_pct": shift_pct(point["k_c"], k_hopf),
        "multiplier": {"modulus": point["modulus"], "angle_rad": point["angle"]},
        "k_rolls": point["k_rolls"],
        "k_stops": point["k_stops"],
        "hz": point["hz"],
        "shift_pct_at_tick_s": {
            f"{tick_s:g}": shift_pct(k_c_at.get(tick_s), k_hopf) for tick_s in SHOWN_S
        },
        "k_c_rises_per_s_of_tick": extrapolated(slopes),
    }


def _accuracy(rows: list[TickStudyRow], order: Order, limit: LimitRow, *, late: bool) -> Accuracy:
    """Relative differences between methods. late: whether there is a latency."""
    check = check_of(rows, order)
    k_cs = [k_c for _, k_c in _short(rows, order)]
    offs = [abs(k_c - limit["k_c"]) for k_c in k_cs]
    # Without latency these are 4, 2 and 1 ms.
    shortest = [row["k_rolls"] for row in over_ticks(rows, order)[2::-1]]
    k_rolls = [k for k in shortest if k]
    rolls_off = None
    if limit["k_rolls"] and len(k_rolls) == len(shortest) and not late:
        rolls_off = abs(extrapolated(k_rolls) / limit["k_rolls"] - 1)
    return {
        "jacobian_against_differences": check["jacobian_off"],
        "k_c_against_time_course": check["k_c_off"],
        "k_rolls_and_stops_followed_twice_as_long": check["onset_off"],
        "k_c_without_tick_against_hopf": abs(extrapolated(k_cs) / limit["k_c"] - 1),
        "order_of_convergence": log2(offs[-2] / offs[-1]),
        "k_rolls_without_tick_against_continuous": rolls_off,
    }


def _short(rows: list[TickStudyRow], order: Order) -> list[tuple[float, float]]:
    """(tick in s, k_c) for ticks that approach zero."""
    found = [(row["tick_s"], row["k_c"]) for row in short_ticks(rows, order)]
    return [(tick_s, k_c) for tick_s, k_c in found if k_c is not None]


def extrapolated(values: Sequence[float]) -> float:
    """The limit of values at h, h/2, h/4, ... whose error is a power series in h (Romberg)."""
    level = list(values)
    for power in range(1, len(level)):
        level = [(2**power * after - before) / (2**power - 1) for before, after in pairwise(level)]
    return float(level[0])
