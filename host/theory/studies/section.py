"""The study `section`: a Poincare section, the first-return map on it, and the power spectrum.

Eight wheels, from random states and one that rolls, settle on their attractors, and are then
followed from crossing to crossing.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.runs.contract import Setting
from host.theory.analysis import power
from host.theory.analysis.attractors import KINDS, REST, random_starts, settle
from host.theory.analysis.sections import MotionKind
from host.theory.engine.crossings import Surface, crossings
from host.theory.engine.flow import FINENESS
from host.theory.model.turning import rolling_states
from host.theory.model.wheel import Array, Wheel, wheel_of
from host.theory.studies.lyapunov_pieces import require_slow
from host.theory.studies.section_pieces import Settled, follow_wheels, settle_longer, swing_s
from host.theory.studies.section_report import report
from host.theory.studies.section_rows import (
    NOWHERE,
    Checked,
    Crossing,
    Frequency,
    MotionColumns,
    SectionCell,
)
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

WHEELS, BATCHES = 4, 2
# How long wheels settle: at least SETTLE_S (s), and SWINGS of the slowest swings.
SETTLE_S, SWINGS = 200.0, 60.0
# Points of a cycle that are the same differ by less than EXACT; PERIODS of it are kept.
EXACT, PERIODS = 1e-10, 2
# CHECKED crossings of each wheel are computed again with shorter steps: few, as a chaotic wheel
# makes much of a small difference.
CHECKED, FINER = 2, 1.5


def cells(options: dict[str, Any], *, batch: bool = True) -> list[SectionCell]:
    """Batches of wheels, their spectra, and a check.

    Raises WrongUse if wheels do not swing, or are too fast for long.
    """
    require_two_rods(options)
    wheel = wheel_of(options)
    require_slow(wheel)
    swing_s(wheel)
    batches: list[SectionCell] = [{"part": "points", "batch": number} for number in range(BATCHES)]
    return [*batches, {"part": "spectrum"}, {"part": "check"}]


def simulate(
    cell: SectionCell, setting: Setting
) -> list[Crossing] | list[Frequency] | list[Checked]:
    """The crossings of a batch, the spectra of the first one, or the check."""
    wheel, options = wheel_of(setting.options), setting.options
    batch = cell["batch"] if cell["part"] == "points" else 0
    rng = np.random.default_rng(setting.seed_of({"part": "points", "batch": batch}))
    states = _settled_states(wheel, batch, rng)
    if cell["part"] == "check":
        return _check(wheel, states, options["on"])
    wheels = [wheel] * WHEELS
    settled = follow_wheels(wheels, states, options["seconds"], options["on"], FINENESS)
    kinds = settle_longer(wheels, settled, options["on"], FINENESS, EXACT)
    if cell["part"] == "points":
        return [
            row
            for number, (one, own) in enumerate(zip(settled, kinds, strict=True))
            for row in _rows(number, one, own)
        ]
    return _spectra(wheel, settled, kinds, options["seconds"])


def _settled_states(wheel: Wheel, batch: int, rng: np.random.Generator) -> Array:
    """The states of wheels that have settled; the last one of the first batch has rolled."""
    states = random_starts(WHEELS, rng)
    if batch == 0:
        states[:, -1:] = rolling_states(wheel.columns(1))
    seconds = max(SETTLE_S, SWINGS * swing_s(wheel))
    return settle(states, wheel.columns(WHEELS), seconds)


def _rows(number: int, settled: Settled, own: MotionColumns) -> list[Crossing]:
    """The crossings of a wheel."""
    if not len(settled.points.times_s):
        return [{**own, "wheel": number, "number": 0, **NOWHERE}]
    kept = None if own["period"] is None else -PERIODS * own["period"] - 1
    columns = settled.points.times_s[:, None], settled.crossed, settled.points.states
    return [
        {
            **own,
            "wheel": number,
            "number": count,
            "t": row[0],
            "x1": row[1],
            "x2": row[2],
            "phi": row[3],
            "omega": row[4],
            "section_x1": row[5],
            "section_x2": row[6],
            "section_phi": row[7],
            "section_omega": row[8],
        }
        for count, row in enumerate(np.hstack(columns)[kept:].tolist())
    ]


def _spectra(
    wheel: Wheel, settled: list[Settled], kinds: list[MotionColumns], seconds: float
) -> list[Frequency]:
    """A spectrum for each motion of the wheels; none for rest."""
    alike: dict[tuple[MotionKind, int | None], list[int]] = {}
    for number, own in enumerate(kinds):
        alike.setdefault((own["kind"], own["period"]), []).append(number)
    rows: list[Frequency] = []
    for (kind, period), numbers in alike.items():
        if kind == KINDS[REST]:
            continue
        states = np.array([settled[number].ended for number in numbers]).T
        period_s = kinds[numbers[0]]["period_s"]
        found = (
            power.of_motion(wheel, states, seconds)
            if period_s is None
            else power.of_cycle(wheel, states[:, 0], period_s)
        )
        rows += [
            {
                "kind": kind,
                "period": period,
                "resolution": float(found.frequency_hz[0]) if period_s is None else 0.0,
                "frequency": frequency,
                "potentials": potentials,
                "omega_power": omega,
            }
            for frequency, potentials, omega in np.array(found).T.tolist()
        ]
    return rows


def _check(wheel: Wheel, states: Array, surface: Surface) -> list[Checked]:
    """The first crossings of wheels with usual steps and with shorter ones."""
    usual, finer = (
        crossings(states, wheel.columns(WHEELS), swing_s(wheel), surface, CHECKED, own).times_s
        for own in (FINENESS, FINER * FINENESS)
    )
    return [
        {"wheel": place, "number": number, "t": float(one), "t_finer": float(other)}
        for place, both in enumerate(zip(usual, finer, strict=True))
        for number, (one, other) in enumerate(zip(*both, strict=False))
    ]
