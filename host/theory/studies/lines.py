"""The study `lines`: bifurcations in the plane of two constants.

The plane is cut into bands of y. In each band, lines are followed from where they cross its edges,
or, in windows of attracting cycles, its middle: a line that does not come there is not seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from host.errors import WrongUse
from host.runs.contract import Setting
from host.theory.analysis.chaos_edges import LASTING_S, chaos_edges
from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.hopf import hopf
from host.theory.analysis.phases import phases
from host.theory.engine.ensemble import averages, require_loose
from host.theory.engine.flow import steps_for
from host.theory.model.wheel import resting
from host.theory.studies.lines_boundaries import boundary_rows
from host.theory.studies.lines_cycles import cycle_rows
from host.theory.studies.lines_plane import Plane, plane_of
from host.theory.studies.lines_report import report
from host.theory.studies.lines_rows import PARTS, ChaosEdgePoint, LinesCell, Measured, PhasePoint
from host.theory.studies.lines_windows import WINDOW_BANDS, window_rows
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

BANDS = 12
# Values of y at which crises are looked for.
CHAOS_YS = 12
# Phases: points of each axis, values of y in a cell; the push (rad), and times (s).
GRID, ROWS = 60, 15
_PUSH, _TRANSIENT_S, _MEASURED_S = 1e-3, 60.0, 40.0


def cells(options: dict[str, Any], *, batch: bool = True) -> list[LinesCell]:
    """Phases, crises, windows, and the lines of each kind in each band.

    Raises WrongUse for a wheel with one rod, if the axes are the same, if no resting wheel begins
    to swing, or if a wheel is too stiff to be followed.
    """
    require_two_rods(options)
    if options["x"] == options["y"]:
        raise WrongUse(
            f"both axes are {options['x']}", "give two different constants for --x and --y"
        )
    plane = plane_of(options)
    x_from, x_to, y_from, y_to = plane.window
    for x, y in ((x_from, y_from), (x_from, y_to), (x_to, y_from), (x_to, y_to)):
        wheel = plane.at(x, y)
        hopf(wheel)
        fixpoint(0.0, wheel)
        steps_for(1.0, wheel)
        require_loose(wheel.columns(1), LASTING_S)
    phases: list[LinesCell] = [{"part": "phases", "first": first} for first in range(0, GRID, ROWS)]
    chaos: list[LinesCell] = [{"part": "chaos", "number": number} for number in range(CHAOS_YS)]
    windows: list[LinesCell] = [{"part": "windows", "band": band} for band in range(WINDOW_BANDS)]
    lines: list[LinesCell] = [
        {"part": part, "band": band} for band in range(BANDS) for part in PARTS
    ]
    return phases + chaos + windows + lines


def simulate(cell: LinesCell, setting: Setting) -> Sequence[Measured | PhasePoint | ChaosEdgePoint]:
    """The phases, crises, or lines of one cell."""
    plane = plane_of(setting.options)
    if cell["part"] == "phases":
        return _phases(cell["first"], plane)
    if cell["part"] == "chaos":
        return _chaos(cell["number"], plane, np.random.default_rng(setting.seed_of(cell)))
    if cell["part"] == "windows":
        rng = np.random.default_rng(setting.seed_of(cell))
        return window_rows(cell["band"], plane, rng)
    band = plane.band(cell["band"], BANDS)
    match cell["part"]:
        case "Hopf" | "merging" as part:
            return boundary_rows(part, band)
        case "FB" | "LLM" as family:
            return cycle_rows(family, band)


def _phases(first: int, plane: Plane) -> list[PhasePoint]:
    """What wheels do that start beside rest."""
    middles = (np.arange(GRID) + 0.5) / GRID
    ys, xs = (
        axis.ravel()
        for axis in np.meshgrid(
            plane.window.y_to * middles[first : first + ROWS],
            plane.window.x_to * middles,
            indexing="ij",
        )
    )
    parameters = plane.wheel.columns(xs.size, **{plane.x: xs, plane.y: ys})
    start = resting(np.full(xs.size, _PUSH))
    found = averages(start, parameters, _TRANSIENT_S, _MEASURED_S)
    columns = (xs.tolist(), ys.tolist(), phases(found, parameters))
    return [
        {"kind": "phase", "x": x, "y": y, "phase": name}
        for x, y, name in zip(*columns, strict=True)
    ]


def _chaos(number: int, plane: Plane, rng: np.random.Generator) -> list[ChaosEdgePoint]:
    """The crises along x."""
    y = plane.window.y_to * (number + 0.5) / CHAOS_YS
    found = chaos_edges(plane.at(plane.window.x_to, y), plane.x, plane.window.x_to, rng)
    return [
        {
            "kind": "chaos",
            "side": edge.side,
            "x": edge.value,
            "y": y,
            "leaves": edge.leaves,
            "stays": edge.stays,
        }
        for edge in found
    ]
