"""What a brick's tick does to the lines of the model.

Where rest loses its stability, where rolling begins, and how fast it is.

Two orders within a tick are compared: 'new' acts on the potentials that the tick has just made, as
the robot does, 'old' on those of the tick before.
"""

from __future__ import annotations

from itertools import pairwise
from math import log2, pi
from typing import Any

import numpy as np

from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.hopf import estimate, hopf
from host.theory.analysis.stability_thresholds import (
    critical_k,
    leading,
    multipliers,
    rolling_ends,
    swinging_ends,
)
from host.theory.engine import sampled
from host.theory.engine.ensemble import rate_per_s
from host.theory.engine.kicked import Continuous, Model, Sampled, memory_s
from host.theory.engine.sampled import Clock
from host.theory.model.symbolic import jacobian_at
from host.theory.model.wheel import PHI, Wheel, resting, wheel_of

CONTINUOUS, NEW, OLD = "continuous", "new", "old"
ORDERS = (NEW, OLD)
# From what a fast computer does to what a slow brick does.
TICKS_S = (0.001, 0.002, 0.004, *(round(0.005 + 0.0025 * number, 4) for number in range(39)))
TOLD_S = (0.03, 0.04)
LATENCIES = 13
# Ticks that approach zero, in parts of tau.
SHORT = tuple(1.0 / (25 * 2**number) for number in range(8))
GROWTH_POINTS = 81
# The paper's robot runs at this k.
RUNNING_K = 8.0
# How long motions are followed at each k, in memories of the wheel, but at most so many seconds;
# how far rolling is looked for, in parts of k_c.
FOLLOWED, LONGEST_S, LEAST, MOST = 300.0, 600.0, 0.2, 5.0
# A wheel that takes more steps for that is too stiff to be followed as often as it has to be.
MOST_STEPS = 1e6
# A small swing is watched so near k_c, for so many ticks.
NEAR, PATIENCE = 1e-5, 1_000_000
_SWING_RAD = 1e-4


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """The continuous limit; each tick and each latency by both orders.

    And what speaks of accuracy. Raises WrongUse.
    """
    hopf(wheel_of(options))
    Clock(options["tick"], options["latency"]).checked()
    ticks_s = [tick_s for tick_s in TICKS_S if tick_s >= options["latency"]]
    latencies_s = [options["tick"] * number / (LATENCIES - 1) for number in range(LATENCIES)]
    found: list[Cell] = [
        {"part": "limit", "order": CONTINUOUS},
        {"part": "growth", "order": CONTINUOUS},
    ]
    for order in ORDERS:
        found += [{"part": part, "order": order} for part in ("point", "growth", "short", "check")]
        found += [{"part": "tick", "order": order, "tick_s": tick_s} for tick_s in ticks_s]
        found += [
            {"part": "latency", "order": order, "latency_s": latency_s} for latency_s in latencies_s
        ]
    return found


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """One row, but of a growth rate's line and of short ticks."""
    options = setting.options
    wheel, part = wheel_of(options), cell["part"]
    if cell["order"] == CONTINUOUS:
        return [_limit(wheel)] if part == "limit" else _growth(wheel, None)
    times = {"tick_s": options["tick"], "latency_s": options["latency"], **cell}
    clock = Clock(times["tick_s"], times["latency_s"], cell["order"] == NEW)
    if part == "growth":
        return _growth(wheel, clock)
    if part == "short":
        clocks = [Clock(wheel.tau_s * share, 0.0, clock.fresh) for share in SHORT]
        return [{"tick_s": short.tick_s, "k_c": critical_k(wheel, short)} for short in clocks]
    return [_check(wheel, clock) if part == "check" else lines(wheel, clock)]


def _limit(wheel: Wheel) -> Row:
    k_c = hopf(wheel).k
    steps = followed_s(wheel) * float(rate_per_s(wheel._replace(k=MOST * k_c).columns(1))[0])
    if steps > MOST_STEPS:
        return {
            "k_c": k_c,
            "k_rolls": None,
            "k_stops": None,
            "hz": None,
            "note": f"too stiff to follow: a wheel takes {steps:.1e} steps",
        }
    return {"k_c": k_c, **_behaviour(Continuous(), wheel, k_c, followed_s(wheel)), "note": None}


def followed_s(wheel: Wheel) -> float:
    """For how long a motion of the wheel is followed at each k."""
    return min(FOLLOWED * memory_s(wheel), LONGEST_S)


def lines(wheel: Wheel, clock: Clock) -> Row:
    """What this clock makes of the wheel; what there is not is None.

    k_c: where rest loses its stability, with modulus and angle (rad a tick) of the multiplier
    there. k_rolls, k_stops: where swinging turns into rolling as k rises, and where rolling ends as
    k falls. hz: turns per second at k = RUNNING_K.
    """
    k_c = critical_k(wheel, clock)
    if not k_c:
        return {
            "k_c": k_c,
            "modulus": None,
            "angle": None,
            "k_rolls": None,
            "k_stops": None,
            "hz": None,
        }
    multiplier = leading(wheel._replace(k=k_c), clock)
    return {
        "k_c": k_c,
        "modulus": abs(multiplier),
        "angle": float(np.angle(multiplier)),
        **_behaviour(Sampled(clock), wheel, k_c, followed_s(wheel)),
    }


def _behaviour(model: Model, wheel: Wheel, k_c: float, seconds: float) -> Row:
    return {
        "k_rolls": swinging_ends(model, wheel, k_c, MOST * k_c, seconds),
        "k_stops": rolling_ends(model, wheel, MOST * k_c, LEAST * k_c, seconds),
        "hz": _running_hz(model, wheel._replace(k=RUNNING_K), seconds),
    }


def _running_hz(model: Model, wheel: Wheel, seconds: float) -> float | None:
    """Turns per second of a wheel that rolls steadily.

    As far in one half of the time as in the other, to a quarter turn.
    """
    states = resting(np.zeros(1))
    states[PHI + 1] = 2 * pi
    begun = model.averages(model.begun(states), wheel.columns(1), seconds / 2)
    halves = [model.averages(begun.states, wheel.columns(1), seconds / 4)]
    halves.append(model.averages(halves[0].states, wheel.columns(1), seconds / 4))
    turns = [abs(float(half.omega_mean[0])) * seconds / 4 / (2 * pi) for half in halves]
    return (
        sum(turns) / (seconds / 2) if turns[1] > 2.0 and abs(turns[0] - turns[1]) < 0.25 else None
    )


def _growth(wheel: Wheel, clock: Clock | None) -> list[Row]:
    """How fast a small swing grows (1/s), and its frequency (Hz), along k."""
    rows = []
    for k in np.linspace(0.0, 2.0 * hopf(wheel).k, GROWTH_POINTS).tolist():
        here = wheel._replace(k=k)
        if clock is None:
            matrix: Any = jacobian_at(sampled.at_rest()[:4], here)
            rates = np.linalg.eigvals(matrix)
        else:
            # The least float keeps the multiplier 0, which there is without latency, from having no
            # logarithm.
            rates = np.log(multipliers(here, clock).astype(complex) + 1e-300) / clock.tick_s
        # The pair, or what becomes the pair: without k, a wheel stays where it is put.
        slowest = max(rates, key=lambda rate: float(rate.real))
        rows.append(
            {"k": k, "growth_per_s": float(slowest.real), "hz": abs(float(slowest.imag)) / (2 * pi)}
        )
    return rows


def _check(wheel: Wheel, clock: Clock) -> Row:
    """The same by other means: by how much the values of this clock differ."""
    k_c = critical_k(wheel, clock)
    if not k_c:
        return {"jacobian_off": None, "k_c_off": None, "onset_off": None}
    row, again = lines(wheel, clock), _behaviour(Sampled(clock), wheel, k_c, 2 * followed_s(wheel))
    offs = [
        abs(row[name] / again[name] - 1)
        for name in ("k_rolls", "k_stops")
        if row[name] and again[name]
    ]
    return {
        "jacobian_off": _jacobian_off(wheel._replace(k=k_c), clock),
        "k_c_off": abs(k_by_time_course(wheel, clock, k_c) / k_c - 1),
        "onset_off": max(offs, default=None),
    }


def _jacobian_off(wheel: Wheel, clock: Clock, step: float = 1e-5) -> float:
    """The greatest difference between the Jacobian at rest and central differences of the map."""
    aside = np.repeat(np.array(sampled.at_rest())[:, None], 10, axis=1)
    aside[np.arange(10) % 5, np.arange(10)] += np.repeat([step, -step], 5)
    ended = sampled.advance(aside, wheel.columns(10), clock, 1)
    by_differences = np.asarray(ended[:, :5] - ended[:, 5:]) / (2 * step)
    return float(np.max(np.abs(by_differences - sampled.jacobian(sampled.at_rest(), wheel, clock))))


def k_by_time_course(wheel: Wheel, clock: Clock, k_c: float) -> float:
    """The k at which a small swing neither grows nor fades, from the swings a little below and above k_c, interpolated."""
    parameters = wheel.columns(2)
    parameters[2] = k_c * (1 - NEAR), k_c * (1 + NEAR)
    window = round(200 * 2 * pi / abs(np.angle(leading(wheel._replace(k=k_c), clock))))
    first = sampled.averages(
        sampled.unforced(resting(np.full(2, _SWING_RAD))), parameters, clock, 2 * window
    )
    first = sampled.averages(first.states, parameters, clock, window)
    later = sampled.averages(
        sampled.advance(first.states, parameters, clock, PATIENCE), parameters, clock, window
    )
    below, above = np.log(later.omega_std / first.omega_std).tolist()
    return float(k_c * (1 - NEAR + 2 * NEAR * below / (below - above)))


def report(rows: list[Row], setting: Setting) -> Findings:
    """No claim of the paper's, which knows no tick.

    Where the lines are, and how they move with the tick.
    """
    options = setting.options
    wheel = wheel_of(options)
    limit = next(row for row in rows if row["part"] == "limit")
    orders = {order: [row for row in rows if row["order"] == order] for order in ORDERS}
    numbers: dict[str, Any] = {
        "tick_s": options["tick"],
        "latency_s": options["latency"],
        "k_hopf": limit["k_c"],
        "k_estimate": estimate(wheel),
        CONTINUOUS: {name: limit[name] for name in ("k_c", "k_rolls", "k_stops", "hz", "note")},
        **{order: _numbers(own, limit["k_c"]) for order, own in orders.items()},
        "accuracy": {order: _accuracy(own, limit, options) for order, own in orders.items()},
    }
    return Findings([], numbers)


def part_of(rows: list[Row], part: str) -> list[Row]:
    """The rows of a part."""
    return [row for row in rows if row["part"] == part]


def shift_pct(k_c: float | None, k_hopf: float) -> float | None:
    """By how much k_c is above the continuous model's, in percent."""
    return None if k_c is None else 100 * (k_c / k_hopf - 1)


def _numbers(rows: list[Row], k_hopf: float) -> dict[str, Any]:
    point = part_of(rows, "point")[0]
    at = {row["tick_s"]: row["k_c"] for row in part_of(rows, "tick")}
    slopes = [(k_c - k_hopf) / tick_s for tick_s, k_c in _short(rows)]
    return {
        "k_c": point["k_c"],
        "shift_pct": shift_pct(point["k_c"], k_hopf),
        "multiplier": {"modulus": point["modulus"], "angle_rad": point["angle"]},
        "k_rolls": point["k_rolls"],
        "k_stops": point["k_stops"],
        "hz": point["hz"],
        "shift_pct_at_tick_s": {
            f"{tick_s:g}": shift_pct(at.get(tick_s), k_hopf) for tick_s in TOLD_S
        },
        "k_c_rises_per_s_of_tick": _extrapolated(slopes),
    }


def _accuracy(rows: list[Row], limit: Row, options: dict[str, Any]) -> dict[str, Any]:
    """What was checked in this run, and by which part the values differ."""
    check = part_of(rows, "check")[0]
    offs = [abs(k_c - limit["k_c"]) for _, k_c in _short(rows)]
    at = {row["tick_s"]: row["k_rolls"] for row in part_of(rows, "tick")}
    known = [at.get(tick_s) for tick_s in TICKS_S[2::-1]]
    comparable = limit["k_rolls"] and all(known) and not options["latency"]
    return {
        "jacobian_against_differences": check["jacobian_off"],
        "k_c_against_time_course": check["k_c_off"],
        "k_rolls_and_stops_followed_twice_as_long": check["onset_off"],
        "k_c_without_tick_against_hopf": abs(
            _extrapolated([k_c for _, k_c in _short(rows)]) / limit["k_c"] - 1
        ),
        "order_of_convergence": log2(offs[-2] / offs[-1]),
        "k_rolls_without_tick_against_continuous": (
            abs(_extrapolated(known) / limit["k_rolls"] - 1) if comparable else None
        ),
    }


def _short(rows: list[Row]) -> list[tuple[float, float]]:
    return [(row["tick_s"], row["k_c"]) for row in part_of(rows, "short")]


def _extrapolated(values: Any) -> float:
    """What values at h, h/2, h/4, ... tend to, with an error in all powers of h (Romberg)."""
    level = list(values)
    for power in range(1, len(level)):
        level = [(2**power * after - before) / (2**power - 1) for before, after in pairwise(level)]
    return float(level[0])
