"""Left, the least jump of the potentials that reverses a wheel, over its phase and direction.

Right, the least jump at each phase beside the paper's inversion, and the courses after the least
one: along the edge, and from there to either side.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.theory.analysis.least_push import POTENTIALS
from host.theory.studies.edge_rows import (
    BACKWARD,
    EDGE,
    FORWARD,
    EdgeRow,
    MapRow,
    Role,
    course_of,
    least_of,
    map_of,
)

PANELS = ("map", "phase", "course")

_COURSES: tuple[tuple[Role, str, str, str], ...] = (
    (FORWARD, "a little smaller: rolls on", COLOURS[0], "-"),
    (BACKWARD, "a little larger: reverses", COLOURS[1], "--"),
    (EDGE, "on the edge", "black", "-"),
)


def draw(rows: list[EdgeRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    plane = map_of(rows, POTENTIALS)
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplot_mosaic([["map", "phase"], ["map", "course"]])
        _draw_map(figure, panels["map"], plane)
        _draw_phases(panels["phase"], plane)
        least = least_of(rows, POTENTIALS)
        if least is not None:
            _mark(panels["map"], least["phase_deg"], least["direction_deg"], "white")
            _mark(panels["phase"], least["phase_deg"], least["amplitude"], COLOURS[1])
        _draw_courses(panels["course"], rows)
        figure.suptitle("The least jump of the potentials that reverses a wheel", fontsize=16)
    return figure


def _mark(axes: Axes, phase_deg: Any, height: Any, colour: str) -> None:
    axes.plot([phase_deg], [height], "*", color=colour, markeredgecolor="black", markersize=15)


def _table(plane: list[MapRow]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phases, directions (degrees), and amplitudes (directions, phases), NaN without one."""
    phases = np.unique([row["phase_deg"] for row in plane])
    ways = np.unique([row["direction_deg"] for row in plane])
    ordered = sorted(plane, key=lambda row: (row["direction_deg"], row["phase_deg"]))
    found = np.array([row["amplitude"] for row in ordered], dtype=float)
    return phases, ways, found.reshape(len(ways), len(phases))


def _draw_map(figure: Figure, axes: Axes, plane: list[MapRow]) -> None:
    phases, ways, found = _table(plane)
    mesh = axes.pcolormesh(
        phases, ways, found, cmap="cividis_r", shading="nearest", rasterized=True
    )
    bar = figure.colorbar(mesh, ax=axes, location="right", aspect=40)
    bar.set_label("least jump (without unit)")
    axes.set(
        xlabel="phase of rolling (degrees)",
        ylabel="direction of the jump: $x_1$ is 0°, $x_2$ is 90°",
        yticks=range(0, 361, 90),
    )
    axes.patch.set(facecolor="white", edgecolor="grey", hatch="//", linewidth=0.0)
    axes.set_title("hatched: no jump that was tried reverses", fontsize=12)


def _draw_phases(axes: Axes, plane: list[MapRow]) -> None:
    phases, _, found = _table(plane)
    sizes = {row["phase_deg"]: 2.0 * float(np.hypot(row["x1"], row["x2"])) for row in plane}
    inverted = [sizes[phase] for phase in phases]
    axes.plot(phases, inverted, color=COLOURS[2], linestyle="--", label="inversion")
    least = np.where(np.isnan(found), np.inf, found).min(axis=0)
    axes.plot(
        phases,
        np.where(np.isfinite(least), least, np.nan),
        color=COLOURS[1],
        label="least in any direction",
    )
    axes.set(xlabel="phase of rolling (degrees)", ylabel="jump", ylim=(0, None), xlim=(0, 90))
    axes.legend(loc="best", fontsize=11)


def _draw_courses(axes: Axes, rows: list[EdgeRow]) -> None:
    for role, label, colour, line in _COURSES:
        course = course_of(rows, POTENTIALS, role)
        axes.plot(
            [row["t_s"] for row in course],
            [row["omega"] / (2 * np.pi) for row in course],
            color=colour,
            linestyle=line,
            label=label,
        )
    axes.axhline(0.0, color="dimgrey", linewidth=0.8, zorder=0)
    axes.set(xlabel="time after the least jump (s)", ylabel=r"speed $\omega/2\pi$ (Hz)")
    axes.legend(loc="best", fontsize=11)
