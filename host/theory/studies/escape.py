"""The study `escape`: how long noise takes to drive a wheel from its attractor.

Wheels that rest or swing escape to another well, those that roll turn round or come to rest. The
mean time is measured over the noise, and compared with Arrhenius's law.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypedDict

import numpy as np

from host.errors import WrongUse
from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.escape_times import Stay, arrhenius, levels, settled, stay
from host.theory.engine.noise import FINENESS, Noise, escapes, require_followed, seeds_of
from host.theory.model.laws import require_friction
from host.theory.model.wheel import wheel_of
from host.theory.studies.escape_rows import (
    CheckRow,
    EscapeCell,
    EscapeRow,
    Stayed,
    TimesRow,
    by_level,
    checks,
)
from host.util.intervals import standard_error

# Strengths of noise, with 1 / D^2 up to SPAN times the least; wheels in a cell.
LEVELS, SPAN, BATCH = 6, 2.0, 64
# The check takes steps shorter by this.
FINER = 2.0


def cells(options: dict[str, Any], *, batch: bool = True) -> list[EscapeCell]:
    """Batches of wheels for each strength, and a check.

    Raises WrongUse without noise or friction, or if wheels do not stay on the attractor without
    noise.
    """
    wheel = wheel_of(options)
    if not (options["noise"] or options["angle_noise"]):
        raise WrongUse("without noise no wheel escapes", "give --noise or --angle-noise above 0")
    require_friction(wheel)
    require_followed(wheel.columns(1), options["seconds"], FINER * FINENESS)
    settled(wheel, options["start"], 2, np.random.default_rng(0))
    found: list[EscapeCell] = [
        {"part": "times", "level": level, "batch": number}
        for level in range(LEVELS)
        for number in range(-(-options["wheels"] // BATCH))
    ]
    return [*found, {"part": "check"}]


def simulate(cell: EscapeCell, setting: Setting) -> list[Stayed]:
    """How long each wheel of a batch stayed."""
    options, wheel = setting.options, wheel_of(setting.options)
    strengths = levels(Noise(options["noise"], options["angle_noise"]), LEVELS, SPAN)
    rng = np.random.default_rng(setting.seed_of(cell))
    count, noise, fineness = options["wheels"], strengths[0], FINER * FINENESS
    if cell["part"] == "times":
        count = min(BATCH, count - BATCH * cell["batch"])
        noise, fineness = strengths[cell["level"]], FINENESS
    begin = settled(wheel, options["start"], count, rng)
    found = escapes(
        begin.states,
        wheel.columns(count),
        noise,
        options["seconds"],
        seeds_of(rng, count),
        begin.way,
        fineness,
        begin.patience_s,
    )
    return [
        {"noise": noise.torque, "angle_noise": noise.angle, "time_s": time_s, "ended": ended}
        for time_s, ended in zip(found.time_s.tolist(), found.ended.tolist(), strict=True)
    ]


class Level(TypedDict):
    """The mean time until a wheel escapes, with its 95 % interval, at one strength of noise."""

    noise: float
    angle_noise: float
    wheels: int
    escapes: int
    mean_s: float | None
    low_s: float
    high_s: float | None


class Law(TypedDict):
    """Arrhenius's law ln T = ln prefactor + barrier / D^2 as fitted.

    D is the torque's noise; the angle's, without the torque's.
    """

    barrier: float
    barrier_error: float
    prefactor_s: float
    misfit: float | None


class Accuracy(TypedDict):
    """The mean time with halved steps, at the greatest noise, with its 95 % interval (s)."""

    mean_s: float | None
    low_s: float
    high_s: float | None


class Numbers(TypedDict):
    """All numbers of the study."""

    seed: int
    start: str
    levels: list[Level]
    arrhenius: Law | None
    accuracy: Accuracy


def strength_of(row: Level) -> float:
    """The noise D in the fitted law."""
    return row["noise"] or row["angle_noise"]


def report(rows: list[EscapeRow], setting: Setting) -> Findings:
    """Mean times and the law. The paper claims nothing about noise."""
    groups = by_level(rows)
    stays = [_stay(own) for own in groups]
    found: list[Level] = [
        {
            "noise": own[0]["noise"],
            "angle_noise": own[0]["angle_noise"],
            "wheels": len(own),
            "escapes": stayed.escapes,
            "mean_s": stayed.mean_s,
            "low_s": stayed.low_s,
            "high_s": stayed.high_s,
        }
        for own, stayed in zip(groups, stays, strict=True)
    ]
    fit = arrhenius(np.array([strength_of(row) for row in found]), stays)
    finer = _stay(checks(rows))
    numbers: Numbers = {
        "seed": setting.seed,
        "start": setting.options["start"],
        "levels": found,
        "arrhenius": None
        if fit is None
        else {
            "barrier": fit.barrier,
            "barrier_error": fit.barrier_error,
            "prefactor_s": fit.prefactor_s,
            "misfit": fit.misfit,
        },
        "accuracy": {"mean_s": finer.mean_s, "low_s": finer.low_s, "high_s": finer.high_s},
    }
    letter, unit = ("D_M", "s") if found[0]["noise"] else ("D_phi", "rad^2/s")
    answers = [_answer(letter, row) for row in found]
    if fit is not None:
        answers += [
            Answer(f"B in T = T_0 exp(B / {letter}^2)", fit.barrier, fit.barrier_error, unit),
            Answer("T_0", fit.prefactor_s, None, "s"),
        ]
    answers.append(Answer("random seed", float(setting.seed)))
    return Findings([], numbers, answers=answers)


def _stay(rows: Sequence[TimesRow | CheckRow]) -> Stay:
    return stay(np.array([row["time_s"] for row in rows]), np.array([row["ended"] for row in rows]))


def _answer(letter: str, row: Level) -> Answer:
    error = None if row["high_s"] is None else standard_error((row["low_s"], row["high_s"]))
    name = f"mean time until an escape at {letter} = {strength_of(row):.4g}"
    return Answer(name, row["mean_s"], error, "s")
