"""How large the basins are, which kicks reverse a wheel, and where the two models differ."""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from typing import TypedDict

import numpy as np

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.outcomes import BACKWARD, FORWARD, OUTCOMES, Outcome
from host.theory.engine.kicked import KICKS
from host.theory.studies.basins_rows import (
    CLOCK,
    CONTINUOUS,
    LENGTHS_S,
    MODEL_NAMES,
    PHASES,
    SAMPLED,
    BasinsRow,
    KickRow,
    ModelName,
    StartRow,
    SureRow,
    check_of,
    kicks_of,
    starts_of,
    sure_of,
)


class Basins(TypedDict):
    """Shares of starts by outcome and by well; of rolling wheels, those against their start."""

    shares: dict[Outcome, float]
    wells: dict[str, float]
    turned_around: float | None


class LengthShare(TypedDict):
    """The share of phases at which a kick of one length reverses the wheel."""

    length_s: float
    share: float


class Reversals(TypedDict):
    """Reversals by the kick's length, and the ranges of lengths that are sure (s)."""

    reversed: list[LengthShare]
    sure_s: list[list[float]]


class KickNumbers(Reversals):
    """The reversals of one kick in one model."""

    model: ModelName
    mode: str
    sign: int


class Difference(TypedDict):
    """The share of a kick's phases and lengths that end otherwise if the wheel is sampled."""

    mode: str
    sign: int
    share: float


class SameOutcome(TypedDict):
    """The share of starts with the same outcome if turned, mirrored, or with finer steps.

    None where there are no finer steps.
    """

    turned: float
    mirrored: float
    finer: float | None


class Accuracy(TypedDict):
    """How well the models keep their symmetries, and the grid of kicks."""

    same_outcome: dict[ModelName, SameOutcome]
    angle_off_rad: dict[ModelName, float]
    kick_length_s: float
    phases: int


class Numbers(TypedDict):
    """All numbers of the study."""

    tick_s: float
    basins: dict[ModelName, Basins]
    starts_that_end_otherwise_if_sampled: float
    kicks: list[KickNumbers]
    kicks_that_end_otherwise_if_sampled: list[Difference]
    no_wheel_rolls: list[ModelName]
    accuracy: Accuracy


def report(rows: list[BasinsRow], setting: Setting) -> Findings:
    """Basins of starts and of kicks. The paper claims nothing about them."""
    starts = {model: starts_of(rows, model) for model in MODEL_NAMES}
    kicks = [
        (mode, sign, {model: kicks_of(rows, model, mode, sign) for model in MODEL_NAMES})
        for mode, sign in KICKS
    ]
    differ = [
        (one["outcome"], one["quarters"]) != (other["outcome"], other["quarters"])
        for one, other in zip(*starts.values(), strict=True)
    ]
    checks = {model: check_of(rows, model) for model in MODEL_NAMES}
    numbers: Numbers = {
        "tick_s": CLOCK.tick_s,
        "basins": {model: _basins(own) for model, own in starts.items()},
        "starts_that_end_otherwise_if_sampled": float(np.mean(differ)),
        "kicks": [
            {
                "model": model,
                "mode": mode,
                "sign": sign,
                **_reversals(own[model], sure_of(rows, mode, sign) if model == CONTINUOUS else []),
            }
            for mode, sign, own in kicks
            for model in MODEL_NAMES
            if own[model]
        ],
        "kicks_that_end_otherwise_if_sampled": [
            {"mode": mode, "sign": sign, "share": _share_that_differs(own)}
            for mode, sign, own in kicks
            if all(own.values())
        ],
        "no_wheel_rolls": [model for model in MODEL_NAMES if not kicks[0][2][model]],
        "accuracy": {
            "same_outcome": {
                model: {
                    "turned": check["turned"],
                    "mirrored": check["mirrored"],
                    "finer": check["finer"],
                }
                for model, check in checks.items()
            },
            "angle_off_rad": {model: check["angle_off"] for model, check in checks.items()},
            "kick_length_s": LENGTHS_S[CONTINUOUS][1],
            "phases": PHASES,
        },
    }
    answers = [
        Answer(f"{outcome}, {model} model", 100 * share, None, "% of starts")
        for model, own in numbers["basins"].items()
        for outcome, share in own["shares"].items()
        if share
    ]
    answers += [_kick_answer(kick) for kick in numbers["kicks"]]
    return Findings([], numbers, answers=answers)


def _kick_answer(kick: KickNumbers) -> Answer:
    """The lengths at which a kick is sure to reverse a wheel."""
    sign = {1: " +", -1: " -", 0: ""}[kick["sign"]]
    name = f"{kick['mode']}{sign} kick, {kick['model']} model: reverses"
    if len(kick["reversed"]) == 1:  # a kick without a length
        return Answer(name, f"at {kick['reversed'][0]['share']:.1%} of phases")
    ranges = [f"{1000 * low:.6g} to {1000 * high:.6g} ms" for low, high in kick["sure_s"]]
    return Answer(f"{name} at all phases", ", ".join(ranges) or "at no length")


def reversals(kicks: list[KickRow]) -> dict[float, float]:
    """The share of phases at which a kick reverses the wheel, by the kick's length (s)."""
    return {
        length_s: float(np.mean([row["outcome"] == BACKWARD for row in line]))
        for length_s, line in _by_length(kicks).items()
    }


def _by_length(kicks: list[KickRow]) -> dict[float, list[KickRow]]:
    lines = groupby(kicks, lambda row: row["length_s"])
    return {length_s: list(line) for length_s, line in lines}


def _basins(starts: list[StartRow]) -> Basins:
    """Shares of outcomes and of wells, and how many wheels roll against their start.

    Wells are counted for wheels that end in one; turned_around is a share of the wheels that roll.
    """
    outcomes = Counter(row["outcome"] for row in starts)
    wells = Counter(row["quarters"] for row in starts if row["quarters"] is not None)
    around = [
        (row["outcome"] == FORWARD) != (row["omega"] > 0.0)
        for row in starts
        if row["outcome"] in (FORWARD, BACKWARD)
    ]
    return {
        "shares": {outcome: outcomes[outcome] / len(starts) for outcome in OUTCOMES},
        "wells": {str(well): count / len(starts) for well, count in sorted(wells.items())},
        "turned_around": float(np.mean(around)) if around else None,
    }


def _reversals(kicks: list[KickRow], ranges: list[SureRow]) -> Reversals:
    """Reversals by length; sure_s: ranges of lengths that reverse the wheel at every phase.

    The sampled wheel knows whole ticks only, so that its ranges are seen from its kicks.
    """
    shares = reversals(kicks)
    sure_s = [[row["from_s"], row["to_s"]] for row in ranges]
    if kicks[0]["model"] == CONTINUOUS and kicks[-1]["length_s"]:
        return {"reversed": _length_shares(shares), "sure_s": sure_s}
    for sure, line in groupby(shares.items(), lambda item: item[1] == 1.0):
        lengths_s = [length_s for length_s, _ in line]
        if sure:
            sure_s.append([lengths_s[0], lengths_s[-1]])
    return {"reversed": _length_shares(shares), "sure_s": sure_s}


def _length_shares(shares: dict[float, float]) -> list[LengthShare]:
    return [{"length_s": length_s, "share": share} for length_s, share in shares.items()]


def _share_that_differs(kicks: dict[ModelName, list[KickRow]]) -> float:
    """The share of the sampled wheel's kicks that end otherwise than the continuous wheel's.

    Compared with the nearest length and phase.
    """
    continuous = _by_length(kicks[CONTINUOUS])
    differ = []
    for length_s, line in _by_length(kicks[SAMPLED]).items():
        offs = {other: abs(other - length_s) for other in continuous}
        near = continuous[min(offs, key=offs.__getitem__)]
        phases = np.array([row["phase_deg"] for row in near])
        for row in line:
            away = np.abs((phases - row["phase_deg"] + 45.0) % 90.0 - 45.0)
            differ.append(near[int(np.argmin(away))]["outcome"] != row["outcome"])
    return float(np.mean(differ))
