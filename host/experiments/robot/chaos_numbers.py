"""What the experiment `chaos` counts: how wheels end, growth rates, and why switching stops."""

from __future__ import annotations

from collections.abc import Sequence
from math import log
from typing import NotRequired, TypedDict

import numpy as np

from host.experiments.robot.chaos_pieces import MODEL_S, SEEN
from host.experiments.robot.chaos_rows import (
    ChaosRow,
    Ending,
    SeriesRow,
    TwinsRow,
    angles_rad,
    intervals_s,
    is_chaotic,
    lives_rows,
    map_rows,
    model_rows,
    speed_rows,
    twins_rows,
)
from host.experiments.robot.switching import (
    CONDITIONS,
    DELAYED,
    OLDER,
    ORDINARY,
    RESTS,
    ROLLS,
    SWITCHES,
    ending,
    switches,
)
from host.theory.analysis.series_exponents import Exponent, from_series, from_twins

# Two moments of a series are neighbours only if they lie this far apart in time: longer than a
# wheel takes there and back.
APART_S = 2.0
# Twins part for about one period of the motion.
GROWTH_S = 2.0

Interval = tuple[float, float] | None


class Rate(TypedDict):
    """A growth rate (1/s) with its 95 % interval."""

    per_s: float
    interval: Interval


class SeriesRate(Rate):
    """The growth rate of a series, with the embedding that it was estimated in."""

    lag_s: float
    dimension: int


class SeriesNumbers(Ending):
    """How one wheel switched. The quartiles are of the times (s) between its switches."""

    switches: int
    interval_quartiles_s: list[float] | None
    exponent: SeriesRate | None


class Tally(TypedDict):
    """How many wheels switch to the end, roll or rest, and when they switched last (s).

    median_until_s: half of the wheels have stopped then; at least half have not if it is censored.
    median_is_censored: whether the median is only when the run ended: the true one is later.
    half_life_s: the time in which half of the switching wheels stop, if only chance decides when.
    """

    wheels: int
    to_the_end: int
    roll: int
    rest: int
    median_until_s: float
    median_is_censored: bool
    longest_until_s: float
    half_life_s: float | None


class ConditionNumbers(Tally):
    """The tally under one condition, and the speed (Hz) at k = 8, tau = 0.25 s."""

    turns_per_s_at_k_8: float


class TwinsNumbers(Rate):
    """How fast twins part under one condition after one jump (1)."""

    condition: str
    jump: float


class MapNumbers(TypedDict):
    """How many wheels are chaotic at one lag of the rods (s) and voltage of the battery."""

    rod_lag_s: float
    battery_v: float
    chaotic: int
    of: int


class ModelNumbers(Tally):
    """The tally of one model: whose wheel, driven by M or by F_tan, and its I and f."""

    wheel: str
    bounded: bool
    moment: float
    friction: float


class Explanations(TypedDict):
    """What the simulated pieces beside the series came to."""

    conditions: dict[str, ConditionNumbers]
    twins: list[TwinsNumbers]
    map: list[MapNumbers]
    model: list[ModelNumbers]


class Numbers(TypedDict):
    """How the wheels of each series switched, and the explanations, if they were simulated.

    parameters: those of the robot, by its names for them.
    """

    parameters: dict[str, float]
    series: dict[str, SeriesNumbers]
    conditions: NotRequired[dict[str, ConditionNumbers]]
    twins: NotRequired[list[TwinsNumbers]]
    map: NotRequired[list[MapNumbers]]
    model: NotRequired[list[ModelNumbers]]


def series_numbers(series: list[SeriesRow]) -> SeriesNumbers:
    """How one wheel switched, and the growth rate of its force; M is the force, bounded."""
    times, phi = np.array([row["t_s"] for row in series]), angles_rad(series)
    tick_s = float(times[-1] / (len(times) - 1))
    until_s, end = ending(phi, tick_s)
    between = intervals_s(series)
    quartiles = np.quantile(between, (0.25, 0.5, 0.75)).tolist() if len(between) else None
    exponent: SeriesRate | None = None
    found = from_series(np.array([row["force"] for row in series]), tick_s, APART_S)
    if found is not None:
        rate, embedding = found
        lag_s = embedding.lag * tick_s
        exponent = {**plain(rate), "lag_s": lag_s, "dimension": embedding.dimension}
    return {
        "switches": len(switches(phi)),
        "until_s": until_s,
        "end": end,
        "interval_quartiles_s": quartiles,
        "exponent": exponent,
    }


def plain(exponent: Exponent) -> Rate:
    """An exponent as plain data."""
    return {"per_s": exponent.rate, "interval": exponent.interval}


def tally(ends: Sequence[Ending]) -> Tally:
    """Count how wheels ended."""
    switch, roll, rest = (
        sum(row["end"] == end for row in ends) for end in (SWITCHES, ROLLS, RESTS)
    )
    until_s = np.array([row["until_s"] for row in ends], dtype=float)
    stopped = roll + rest
    return {
        "wheels": len(ends),
        "to_the_end": switch,
        "roll": roll,
        "rest": rest,
        "median_until_s": float(np.median(until_s)),
        "median_is_censored": 2 * switch >= len(ends),
        "longest_until_s": float(until_s.max()),
        "half_life_s": float(log(2) * until_s.sum() / stopped) if stopped else None,
    }


def growth(rows: list[TwinsRow]) -> Exponent:
    """The rate at which twins part, just after the jump."""
    first = np.array([row["distance"] for row in rows if row["since_s"] == 0.0])
    last = np.array([row["distance"] for row in rows if row["since_s"] == GROWTH_S])
    return from_twins(first, last, GROWTH_S)


def explain(rows: list[ChaosRow]) -> Explanations:
    """Count the conditions, the twins, the map and the model."""
    return {
        "conditions": {name: _condition_numbers(rows, name) for name in CONDITIONS},
        "twins": [
            {"condition": condition, "jump": jump, **plain(growth(pairs))}
            for (condition, jump), pairs in twins_rows(rows).items()
        ],
        "map": [
            {
                "rod_lag_s": lag_s,
                "battery_v": battery_v,
                "chaotic": sum(map(is_chaotic, wheels)),
                "of": len(wheels),
            }
            for (lag_s, battery_v), wheels in map_rows(rows).items()
        ],
        "model": [
            {
                "wheel": wheel,
                "bounded": bounded,
                "moment": runs[0]["moment"],
                "friction": runs[0]["friction"],
                **tally(runs),
            }
            for (wheel, bounded), runs in model_rows(rows).items()
        ],
    }


def _condition_numbers(rows: list[ChaosRow], condition: str) -> ConditionNumbers:
    turns = [row["turns_per_s"] for row in speed_rows(rows, condition)]
    return {**tally(lives_rows(rows, condition)), "turns_per_s_at_k_8": float(np.median(turns))}


def reasons(found: Explanations, older_rate: SeriesRate | None) -> list[str]:
    """Say why switching does not last, and under which conditions it does.

    Args:
        found: the counts of the simulated pieces.
        older_rate: growth rate of the series with OLDER rods, None if there is none.
    """
    models = {(model["wheel"], model["bounded"]): model for model in found["model"]}
    free, bounded = models["paper", False], models["paper", True]
    robot = models["robot", True]
    older, delayed = found["conditions"][OLDER], found["conditions"][DELAYED]
    (twins,) = (row for row in found["twins"] if (row["condition"], row["jump"]) == (OLDER, SEEN))
    cause = (
        f"M being bounded is why: for {MODEL_S:g} s the paper's model (I = {free['moment']:g}, f ="
        f" {free['friction']:g}) switches in {free['to_the_end']} of {free['wheels']} runs driven"
        f" by F_tan, in {bounded['to_the_end']} driven by M, and driven by M with this motor's I ="
        f" {robot['moment']:.2g}, f = {robot['friction']:.2g} in {robot['to_the_end']}"
    )
    hypothesis = (
        f"with {OLDER} than the angle in F_tan, and both wheels on one body,"
        f" {older['to_the_end']} of {older['wheels']} wheels switch to the end; exponent"
        f" {in_words(older_rate)} from the series, {in_words(twins)} from twins. A program that"
        " reads the sensor anew in each formula would do this: a hypothesis that fits the paper's"
        " 30 to 40 ms"
    )
    delay = (
        f"a {DELAYED}, for which there is no source, would do too: {delayed['to_the_end']} of"
        f" {delayed['wheels']} switch to the end"
    )
    others = ", ".join(
        f"{name}: {own['to_the_end']} of {own['wheels']}, {own['turns_per_s_at_k_8']:.1f} Hz"
        for name, own in found["conditions"].items()
        if name not in (ORDINARY, DELAYED, OLDER)
    )
    speeds = (
        f"under other conditions, and beside it how fast at k = 8 (R2: 1.8 to 2.3 Hz): {others}"
    )
    return [cause, hypothesis, delay, speeds]


def in_words(rate: Rate | None) -> str:
    """A growth rate with its interval, as text."""
    if rate is None:
        return "none (too short, or still in part)"
    if rate["interval"] is None:
        return f"{rate['per_s']:.2f}/s"
    low, high = rate["interval"]
    return f"{rate['per_s']:.2f}/s ({low:.2f} to {high:.2f})"
