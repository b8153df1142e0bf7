"""The study `tick`: what a brick's tick and latency do to the thresholds of the model.

Where rest loses its stability, where rolling begins and ends, and how fast it is. Two orders within
a tick are compared: 'new' acts on the potentials that this tick has computed, as the robot does;
'old' acts on those of the tick before.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from host.errors import WrongUse
from host.runs.contract import Setting
from host.theory.analysis.hopf import hopf
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
from host.theory.studies.tick_report import report
from host.theory.studies.tick_rows import (
    CONTINUOUS,
    NEW,
    ORDERS,
    Check,
    Growth,
    Limit,
    Measured,
    Motion,
    Order,
    ShortTick,
    Thresholds,
    TickStudyCell,
)
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

# From the tick of a fast computer to that of a slow brick.
TICKS_S = (0.001, 0.002, 0.004, *(round(0.005 + 0.0025 * number, 4) for number in range(39)))
LATENCIES = 13
# Ticks that approach zero, in parts of tau.
SHORT = tuple(1.0 / (25 * 2**number) for number in range(8))
GROWTH_POINTS = 81
# The paper's robot runs at this k.
RUNNING_K = 8.0
# How long motions are followed at each k, in units of the wheel's memory, and the most in seconds.
FOLLOWED, LONGEST_S = 300.0, 600.0
# A motion of more ticks at each k takes a piece of work longer than ten seconds.
MOST_TICKS = 1_000_000
# Rolling is looked for between these multiples of k_c.
LEAST, MOST = 0.2, 5.0
# A wheel that takes more steps is too stiff to be followed at each k.
MOST_STEPS = 1e6
# Small swings of this amplitude (rad) are compared this close to k_c (relative), this many ticks
# apart.
SWING_RAD, NEAR, PATIENCE = 1e-4, 1e-5, 1_000_000


def cells(options: dict[str, Any], *, batch: bool = True) -> list[TickStudyCell]:
    """The continuous limit; for both orders each tick, each latency and the checks.

    Raises WrongUse if there is no Hopf bifurcation, no tick with this latency, or the ticks are too
    many to be followed.
    """
    require_two_rods(options)
    hopf(wheel_of(options))
    Clock(options["tick"], options["latency"]).checked()
    seconds = followed_s(wheel_of(options))
    if (ticks := seconds / options["tick"]) > MOST_TICKS:
        raise WrongUse(
            f"this study follows wheels for {seconds:.3g} s at each of some hundred k, which are"
            f" {ticks:.2g} ticks of {options['tick']:g} s",
            f"give a tick of {seconds / MOST_TICKS:.2g} s or more, or a smaller tau or I",
        )
    ticks_s = [tick_s for tick_s in TICKS_S if tick_s >= options["latency"]]
    latencies_s = [options["tick"] * number / (LATENCIES - 1) for number in range(LATENCIES)]
    found: list[TickStudyCell] = [
        {"part": "limit", "order": CONTINUOUS},
        {"part": "growth", "order": CONTINUOUS},
    ]
    for order in ORDERS:
        found += [
            {"part": "point", "order": order},
            {"part": "growth", "order": order},
            {"part": "short", "order": order},
            {"part": "check", "order": order},
        ]
        for tick_s in ticks_s:
            found.append({"part": "tick", "order": order, "tick_s": tick_s})
        for latency_s in latencies_s:
            found.append({"part": "latency", "order": order, "latency_s": latency_s})
    return found


def simulate(cell: TickStudyCell, setting: Setting) -> Measured:
    """A curve of growth rates, a row for each short tick, or the one row of another part."""
    options = setting.options
    wheel = wheel_of(options)
    tick_s, latency_s = options["tick"], options["latency"]
    if cell["part"] == "limit":
        return [_limit(wheel)]
    if cell["part"] == "growth" and cell["order"] == CONTINUOUS:
        return _growth(wheel, None)
    if cell["part"] == "growth":
        return _growth(wheel, Clock(tick_s, latency_s, cell["order"] == NEW))
    if cell["part"] == "short":
        return _short(wheel, cell["order"])
    if cell["part"] == "tick":
        tick_s = cell["tick_s"]
    elif cell["part"] == "latency":
        latency_s = cell["latency_s"]
    clock = Clock(tick_s, latency_s, cell["order"] == NEW)
    return [_check(wheel, clock)] if cell["part"] == "check" else [thresholds(wheel, clock)]


def _limit(wheel: Wheel) -> Limit:
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
    return {"k_c": k_c, **_motion(Continuous(), wheel, k_c, followed_s(wheel)), "note": None}


def followed_s(wheel: Wheel) -> float:
    """How long a motion of the wheel is followed at each k, s."""
    return min(FOLLOWED * memory_s(wheel), LONGEST_S)


def thresholds(wheel: Wheel, clock: Clock) -> Thresholds:
    """The thresholds of a wheel with this clock, and its speed at RUNNING_K."""
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
        **_motion(Sampled(clock), wheel, k_c, followed_s(wheel)),
    }


def _motion(model: Model, wheel: Wheel, k_c: float, seconds: float) -> Motion:
    return {
        "k_rolls": swinging_ends(model, wheel, k_c, MOST * k_c, seconds),
        "k_stops": rolling_ends(model, wheel, MOST * k_c, LEAST * k_c, seconds),
        "hz": _running_hz(model, wheel._replace(k=RUNNING_K), seconds),
    }


def _running_hz(model: Model, wheel: Wheel, seconds: float) -> float | None:
    """Turns per second of a wheel that rolls steadily; None if it does not.

    A steady wheel covers the same distance, to a quarter turn, in both halves of the time.
    """
    states = resting(np.zeros(1))
    states[PHI + 1] = 2 * pi
    settled = model.averages(model.states_of(states), wheel.columns(1), seconds / 2)
    first = model.averages(settled.states, wheel.columns(1), seconds / 4)
    second = model.averages(first.states, wheel.columns(1), seconds / 4)
    turns = [abs(float(half.omega_mean[0])) * seconds / 4 / (2 * pi) for half in (first, second)]
    steady = turns[1] > 2.0 and abs(turns[0] - turns[1]) < 0.25
    return sum(turns) / (seconds / 2) if steady else None


def _growth(wheel: Wheel, clock: Clock | None) -> list[Growth]:
    """The growth rate of a small swing along k; without a clock, of the continuous model."""
    rows: list[Growth] = []
    for k in np.linspace(0.0, 2.0 * hopf(wheel).k, GROWTH_POINTS).tolist():
        here = wheel._replace(k=k)
        if clock is None:
            matrix: Any = jacobian_at(sampled.at_rest()[:4], here)
            rates = np.linalg.eigvals(matrix)
        else:
            # Without latency one multiplier is 0; the smallest float gives it a logarithm.
            rates = np.log(multipliers(here, clock).astype(complex) + 1e-300) / clock.tick_s
        # The slowest rate is that of the pair, or of what becomes the pair: at k = 0 a wheel stays
        # where it is put.
        slowest = max(rates, key=lambda rate: float(rate.real))
        rows.append(
            {"k": k, "growth_per_s": float(slowest.real), "hz": abs(float(slowest.imag)) / (2 * pi)}
        )
    return rows


def _short(wheel: Wheel, order: Order) -> list[ShortTick]:
    clocks = [Clock(wheel.tau * share, 0.0, order == NEW) for share in SHORT]
    return [{"tick_s": clock.tick_s, "k_c": critical_k(wheel, clock)} for clock in clocks]


def _check(wheel: Wheel, clock: Clock) -> Check:
    """The thresholds of this clock, compared with other methods."""
    k_c = critical_k(wheel, clock)
    if not k_c:
        return {"jacobian_off": None, "k_c_off": None, "onset_off": None}
    own = thresholds(wheel, clock)
    longer = _motion(Sampled(clock), wheel, k_c, 2 * followed_s(wheel))
    pairs = ((own["k_rolls"], longer["k_rolls"]), (own["k_stops"], longer["k_stops"]))
    offs = [abs(k / other - 1) for k, other in pairs if k and other]
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
    """The k at which a small swing neither grows nor fades.

    Interpolated between swings a little below and a little above k_c.
    """
    parameters = wheel.columns(2)
    parameters[2] = k_c * (1 - NEAR), k_c * (1 + NEAR)
    window = round(200 * 2 * pi / abs(np.angle(leading(wheel._replace(k=k_c), clock))))
    start = sampled.unforced(resting(np.full(2, SWING_RAD)))
    settled = sampled.averages(start, parameters, clock, 2 * window)
    first = sampled.averages(settled.states, parameters, clock, window)
    between = sampled.advance(first.states, parameters, clock, PATIENCE)
    later = sampled.averages(between, parameters, clock, window)
    below, above = np.log(later.omega_std / first.omega_std).tolist()
    return float(k_c * (1 - NEAR + 2 * NEAR * below / (below - above)))
