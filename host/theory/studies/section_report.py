"""What the study `section` found: motions, the rotation as a fixpoint, and peaks of the spectra."""

from __future__ import annotations

from itertools import groupby
from typing import Any, TypedDict

import numpy as np

from host.errors import NotDone
from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.branches import rotation_by_formula
from host.theory.analysis.cycles import ROTATION, Shooting
from host.theory.analysis.power import Peak, peaks
from host.theory.analysis.sections import MotionKind
from host.theory.engine.crossings import Surface
from host.theory.model.wheel import Array, wheel_of
from host.theory.studies.branch_rows import pairs
from host.theory.studies.section_rows import (
    FrequencyRow,
    SectionRow,
    checks_of,
    crossings_of,
    spectrum_of,
)

# Peaks of a spectrum that are kept, and that are printed.
MOST, SHOWN = 5, 3
WORDS: dict[Surface, str] = {
    "phi": "sin(2 phi) = 0, taken to phi = 0 with omega > 0 by the symmetries",
    "omega": "omega = 0, taken to -pi/4 < phi < pi/4 with omega falling by the symmetries",
}


class MotionNumbers(TypedDict):
    """One motion: its kind, how it repeats itself, and how many wheels have it."""

    kind: MotionKind
    period: int | None
    period_s: float | None
    exponent: float | None
    wheels: int


class Rotation(TypedDict):
    """The rotation, stable or not: a fixpoint of the return map on phi = n pi/2.

    Attributes:
        x1: there (1).
        x2: there (1).
        omega: there (rad/s).
        frequency_hz: of whole turns.
        multipliers: of the return map, (re, im).
        stable: whether all are within the unit circle.
    """

    x1: float
    x2: float
    omega: float
    frequency_hz: float
    multipliers: list[list[float]]
    stable: bool


class SpectrumNumbers(TypedDict):
    """The spectrum of a motion.

    Attributes:
        kind: the motion.
        period: in crossings; None if it does not repeat itself.
        cycle_hz: the frequency of the cycle by its crossings; None without one.
        potentials: the strongest peaks of x1 and x2.
        omega: the strongest peaks of omega.
        resolution_hz: how far apart frequencies are; 0 for the harmonics of a cycle.
    """

    kind: MotionKind
    period: int | None
    cycle_hz: float | None
    potentials: list[dict[str, float]]
    omega: list[dict[str, float]]
    resolution_hz: float


class Numbers(TypedDict):
    """All numbers of the study."""

    constants: dict[str, float]
    on: Surface
    section: str
    motions: list[MotionNumbers]
    rotation: Rotation | None
    spectra: list[SpectrumNumbers]
    times_off_by_s: float | None


def report(rows: list[SectionRow], setting: Setting) -> Findings:
    """The section in numbers. The paper claims nothing about it."""
    options = setting.options
    motions = _motions(rows)
    differences = [abs(row["t"] - row["t_finer"]) for row in checks_of(rows)]
    numbers: Numbers = {
        "constants": {name: options[name] for name in ("a", "tau", "k", "f", "I")},
        "on": options["on"],
        "section": WORDS[options["on"]],
        "motions": motions,
        "rotation": _rotation(options),
        "spectra": [
            _spectrum(list(group), motions)
            for _, group in groupby(spectrum_of(rows), key=lambda row: (row["kind"], row["period"]))
        ],
        "times_off_by_s": max(differences, default=None),
    }
    return Findings([], numbers, answers=_answers(numbers))


def _motions(rows: list[SectionRow]) -> list[MotionNumbers]:
    """The motions, that of most wheels first."""
    found: dict[Any, MotionNumbers] = {}
    exponents: dict[Any, list[float]] = {}
    for row in crossings_of(rows):
        if row["number"] > 0:
            continue
        key = row["kind"], row["period"]
        own = found.setdefault(
            key,
            {
                "kind": row["kind"],
                "period": row["period"],
                "period_s": row["period_s"],
                "exponent": None,
                "wheels": 0,
            },
        )
        own["wheels"] += 1
        if row["exponent"] is not None:
            exponents.setdefault(key, []).append(row["exponent"])
            own["exponent"] = float(np.mean(exponents[key]))
    return sorted(found.values(), key=lambda own: -own["wheels"])


def _rotation(options: dict[str, Any]) -> Rotation | None:
    """The rotation at these constants; None if there is none near the paper's formula."""
    wheel = wheel_of(options)
    try:
        unknowns = rotation_by_formula(wheel).unknowns
    except NotDone:
        return None
    x1, x2, omega, quarter_s, _ = unknowns.tolist()
    multipliers = Shooting(wheel, ROTATION).multipliers(unknowns)
    return {
        "x1": x1,
        "x2": x2,
        "omega": omega,
        "frequency_hz": 1.0 / (4 * quarter_s),
        "multipliers": pairs(multipliers),
        "stable": bool(abs(multipliers[0]) < 1.0),
    }


def _spectrum(rows: list[FrequencyRow], motions: list[MotionNumbers]) -> SpectrumNumbers:
    first = rows[0]
    kind, period, resolution_hz = first["kind"], first["period"], first["resolution"]
    frequency = np.array([row["frequency"] for row in rows])
    period_s = next(
        own["period_s"] for own in motions if (own["kind"], own["period"]) == (kind, period)
    )
    potentials, omega = (
        [one._asdict() for one in _strongest(frequency, power, resolution_hz)]
        for power in (
            np.array([row["potentials"] for row in rows]),
            np.array([row["omega_power"] for row in rows]),
        )
    )
    return {
        "kind": kind,
        "period": period,
        "cycle_hz": period_s and 1.0 / period_s,
        "potentials": potentials,
        "omega": omega,
        "resolution_hz": resolution_hz,
    }


def _strongest(frequency_hz: Array, power: Array, resolution_hz: float) -> list[Peak]:
    """The strongest peaks. Each harmonic of a cycle is one, as far as it is no rounding error."""
    if resolution_hz:
        return peaks(frequency_hz, power, MOST)
    order = np.argsort(-power, kind="stable")[:MOST]
    return [
        Peak(float(frequency_hz[n]), float(power[n]))
        for n in order
        if power[n] > 1e-20 * power.max()
    ]


def _answers(numbers: Numbers) -> list[Answer]:
    wheels = sum(own["wheels"] for own in numbers["motions"])
    answers = [Answer("section", numbers["section"])]
    for own in numbers["motions"]:
        name = _name(own["kind"], own["period"])
        answers.append(
            Answer(f"{name}: share of wheels", 100.0 * own["wheels"] / wheels, None, "%")
        )
        if own["period_s"] is not None:
            answers.append(Answer(f"{name}: period in time", own["period_s"], None, "s"))
        if own["exponent"] is not None:
            answers.append(Answer(f"{name}: largest exponent", own["exponent"], None, "1/s"))
    rotation = numbers["rotation"]
    if rotation:
        name = f"{'' if rotation['stable'] else 'un'}stable rotation"
        size = abs(complex(*rotation["multipliers"][0]))
        answers.append(Answer(f"{name}: frequency", rotation["frequency_hz"], None, "Hz"))
        answers.append(Answer(f"{name}: modulus of its largest multiplier", size))
    for found in numbers["spectra"]:
        answers += _peaks(found, rotation)
    if numbers["times_off_by_s"] is not None:
        answers.append(
            Answer("moments with shorter steps differ by", numbers["times_off_by_s"], None, "s")
        )
    return answers


def _name(kind: MotionKind, period: int | None) -> str:
    return f"{kind}, period {period}" if period else kind


def _peaks(found: SpectrumNumbers, rotation: Rotation | None) -> list[Answer]:
    """The strongest peaks, and all in units of the frequency of the cycle, else of the rotation."""
    name = _name(found["kind"], found["period"])
    unit, words = found["cycle_hz"], "cycle's frequency"
    if unit is None and rotation:
        unit, words = rotation["frequency_hz"], "rotation's frequency"
    error = found["resolution_hz"] / 2 or None
    answers = []
    if found["cycle_hz"]:
        answers.append(Answer(f"{name}: frequency of the cycle", found["cycle_hz"], None, "Hz"))
    for signal, own in (("x1 and x2", found["potentials"]), ("omega", found["omega"])):
        hertz = [peak["frequency_hz"] for peak in own[:SHOWN]]
        if hertz:
            answers.append(Answer(f"{name}: strongest peak of {signal}", hertz[0], error, "Hz"))
        if hertz and unit:
            ratios = ", ".join(f"{one / unit:.4g}" for one in hertz)
            answers.append(Answer(f"{name}: peaks of {signal} / {words}", ratios))
    return answers
