"""The study `edge`: the least push that reverses a rolling wheel, and the edge that it crosses.

The wheel is the continuous model's, which rolls forward.
"""

from __future__ import annotations

from math import degrees
from typing import Any

import numpy as np

from host.errors import WrongUse
from host.runs.contract import Setting
from host.theory.analysis.edge import departures, track
from host.theory.analysis.least_push import (
    KINDS,
    MOMENTS,
    POTENTIALS,
    Least,
    PushKind,
    amplitudes,
    grid,
    least,
    levels,
    rolling,
)
from host.theory.model.wheel import OMEGA, PHI, Array, Wheel, wheel_of
from host.theory.studies.basins import require_settling
from host.theory.studies.edge_report import report
from host.theory.studies.edge_rows import (
    BACKWARD,
    EDGE,
    FORWARD,
    LEAST,
    Course,
    EdgeCell,
    Measured,
    Role,
    Threshold,
)
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

# Phases of the map, and how many of them are computed in one piece.
PHASES, BAND = 32, 4
# For how long the edge is followed, and both sides once they have parted, in units of the wheel's
# memory.
FOLLOWED, DEPARTED = 16.0, 6.0


def cells(options: dict[str, Any], *, batch: bool = True) -> list[EdgeCell]:
    """For each kind of push: bands of the map of least pushes, and the least of all.

    Raises WrongUse if the wheel has one rod, does not roll, or takes too many steps to settle.
    """
    require_two_rods(options)
    wheel = wheel_of(options)
    require_settling(wheel)
    if rolling(wheel) is None:
        raise WrongUse(
            f"a wheel with k = {wheel.k:g} and tau = {wheel.tau:g} s does not roll one way for"
            " good, so there is nothing to reverse",
            "choose a k or tau at which it does: kickctl theory phase-diagram shows where",
        )
    step = BAND * MOMENTS // PHASES
    found: list[EdgeCell] = []
    for push in KINDS:
        found += [{"part": "map", "push": push, "band": band} for band in range(0, MOMENTS, step)]
        found.append({"part": "least", "push": push})
    return found


def simulate(cell: EdgeCell, setting: Setting) -> Measured:
    """A row for each phase and direction of a map; or the least push, and courses after a jump."""
    wheel = wheel_of(setting.options)
    cycle = rolling(wheel)
    if cycle is None:
        return []
    if cell["part"] == "map":
        return _map(cell["push"], cell["band"], wheel, cycle)
    found = least(cell["push"], wheel, cycle)
    if found is None:
        return []
    pushed = _pushed(found, cycle)
    return [pushed, *_courses(found, wheel)] if cell["push"] == POTENTIALS else [pushed]


def _map(push: PushKind, band: int, wheel: Wheel, cycle: Array) -> list[Threshold]:
    step = MOMENTS // PHASES
    ways = grid(push, cycle, np.arange(band, band + BAND * step, step, dtype=np.int64))
    found = amplitudes(wheel, ways, levels(push, cycle)).above
    columns = (ways.angles.tolist(), found.tolist(), ways.starts.T.tolist())
    return [
        {
            "phase_deg": degrees(start[PHI]),
            "direction_deg": degrees(angle),
            "amplitude": amplitude if np.isfinite(amplitude) else None,
            "x1": start[0],
            "x2": start[1],
            "omega": start[OMEGA],
        }
        for angle, amplitude, start in zip(*columns, strict=True)
    ]


def _pushed(found: Least, cycle: Array) -> Course:
    """The row of the least push."""
    phases = np.unwrap(cycle[PHI], period=np.pi / 2)
    phase_deg = degrees(float(np.interp(found.moment, np.arange(MOMENTS), phases)))
    (pushed,) = _states(LEAST, np.zeros(1), found.above[:, None])
    return {
        **pushed,
        "amplitude": found.amplitude,
        "error": found.error,
        "phase_deg": phase_deg,
        "direction_deg": degrees(found.angle),
    }


def _courses(found: Least, wheel: Wheel) -> list[Course]:
    """The courses that lead away from the least push, along the edge and to either side."""
    path = track(wheel, found.below, found.above, FOLLOWED)
    forward, backward = departures(wheel, path, DEPARTED)
    return [
        *_states(EDGE, path.times, path.states),
        *_states(FORWARD, *forward),
        *_states(BACKWARD, *backward),
    ]


def _states(role: Role, times: Array, states: Array) -> list[Course]:
    return [
        {
            "role": role,
            "t_s": time,
            "x1": x1,
            "x2": x2,
            "phi": phi,
            "omega": omega,
            "amplitude": None,
            "error": None,
            "phase_deg": None,
            "direction_deg": None,
        }
        for time, (x1, x2, phi, omega) in zip(times.tolist(), states.T.tolist(), strict=True)
    ]
