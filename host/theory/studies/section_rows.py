"""The cells and rows of the study `section`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.sections import MotionKind


class PointsCell(TypedDict):
    """Wheels on the section.

    Attributes:
        batch: number of the batch of wheels.
    """

    part: Literal["points"]
    batch: int


class SpectrumCell(TypedDict):
    """The power spectra."""

    part: Literal["spectrum"]


class CheckCell(TypedDict):
    """Some crossings with shorter steps."""

    part: Literal["check"]


class MotionColumns(TypedDict):
    """What a wheel does in the end.

    Attributes:
        kind: at rest, forth-and-back, rolling, chaotic, quasi-periodic, or undecided.
        period: number of crossings until it repeats itself, up to the symmetries; None if it does
            not, or never crosses the section.
        period_s: time until it repeats itself, whole turns apart (s).
        exponent: largest Lyapunov exponent (1/s) of a wheel that does not repeat itself.
    """

    kind: MotionKind
    period: int | None
    period_s: float | None
    exponent: float | None


class Place(TypedDict):
    """Where a wheel crosses the section; None for a wheel that never does.

    Attributes:
        t: when, after the wheel has settled (s).
        x1: first membrane potential (1).
        x2: second membrane potential (1).
        phi: angle (rad).
        omega: angular velocity (rad/s).
        section_x1: x1 of the point that stands for the crossing up to the symmetries (1).
        section_x2: x2 of this point (1).
        section_phi: phi of this point (rad).
        section_omega: omega of this point (rad/s).
    """

    t: float | None
    x1: float | None
    x2: float | None
    phi: float | None
    omega: float | None
    section_x1: float | None
    section_x2: float | None
    section_phi: float | None
    section_omega: float | None


NOWHERE: Place = {
    "t": None,
    "x1": None,
    "x2": None,
    "phi": None,
    "omega": None,
    "section_x1": None,
    "section_x2": None,
    "section_phi": None,
    "section_omega": None,
}


class Crossing(MotionColumns, Place):
    """A wheel that crosses the section; one row for a wheel that never does.

    Attributes:
        wheel: number of the wheel in its batch.
        number: number of the crossing.
    """

    wheel: int
    number: int


class Frequency(TypedDict):
    """The power at a frequency, of wheels with the same motion.

    Attributes:
        kind: their motion.
        period: in crossings, as above.
        resolution: distance of frequencies at which powers are densities; 0 for the harmonics of a
            cycle (Hz).
        frequency: of the power (Hz).
        potentials: power of x1 and x2 together; a density in 1/Hz.
        omega_power: power of omega (rad^2/s^2); a density in rad^2/s^2/Hz.
    """

    kind: MotionKind
    period: int | None
    resolution: float
    frequency: float
    potentials: float
    omega_power: float


class Checked(TypedDict):
    """A crossing with shorter steps.

    Attributes:
        wheel: number of the wheel in the first batch.
        number: number of the crossing.
        t: when it happens (s).
        t_finer: the same with shorter steps (s).
    """

    wheel: int
    number: int
    t: float
    t_finer: float


class CrossingRow(PointsCell, Crossing):
    """A row of a crossing."""


class FrequencyRow(SpectrumCell, Frequency):
    """A row of a spectrum."""


class CheckedRow(CheckCell, Checked):
    """A row of a check."""


SectionCell = PointsCell | SpectrumCell | CheckCell
SectionRow = CrossingRow | FrequencyRow | CheckedRow


def crossings_of(rows: Iterable[SectionRow]) -> list[CrossingRow]:
    """The crossings of all wheels."""
    return [row for row in rows if row["part"] == "points"]


def spectrum_of(rows: Iterable[SectionRow]) -> list[FrequencyRow]:
    """The power spectra."""
    return [row for row in rows if row["part"] == "spectrum"]


def checks_of(rows: Iterable[SectionRow]) -> list[CheckedRow]:
    """The crossings with shorter steps."""
    return [row for row in rows if row["part"] == "check"]
