"""How a robot covers a floor: a trail of each way of moving, and the area visited against time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from host.experiments.robot.explore import (
    CELL_M,
    FLOOR_M,
    STEP_S,
    WAYS,
    Array,
    Row,
    paths_of,
    visited_shares,
)
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings

PANELS = ("area", *(way.replace(" ", "-") for way in WAYS))
_TRAIL_S = 120.0


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**SIZE)
        grid = figure.add_gridspec(2, len(WAYS))
        areas = figure.add_subplot(grid[1, :])
        for at, (way, colour) in enumerate(zip(WAYS, COLOURS, strict=False)):
            paths = paths_of(rows, way)
            _draw_trail(figure.add_subplot(grid[0, at]), paths[0], way, colour)
            _draw_area(areas, paths, way, colour)
        areas.set_xlabel("time (min)")
        areas.set_ylabel("cells visited (%)")
        areas.set_ylim(0, 112)
        areas.set_xlim(left=0)
        figure.suptitle(
            f"A floor of {FLOOR_M:g} x {FLOOR_M:g} m in cells of {CELL_M:g} m: the trail of one"
            f" robot in {_TRAIL_S / 60:g} min, and the mean of {len(paths)} with its 95 % interval"
        )
    return figure


def _draw_trail(axes: Axes, path: Array, way: str, colour: str) -> None:
    half = FLOOR_M / 2
    trail = path[: round(_TRAIL_S / STEP_S)]
    axes.add_patch(Rectangle((-half, -half), FLOOR_M, FLOOR_M, fill=False, lw=2))
    axes.plot(*trail.T, color=colour, lw=1)
    axes.plot(*trail[0], "o", color="black", ms=6)
    axes.set_title(way, color=colour)
    axes.set_aspect("equal")
    axes.set(xticks=[], yticks=[])
    axes.spines[:].set_visible(False)


def _draw_area(axes: Axes, paths: Array, way: str, colour: str) -> None:
    shares = 100 * np.array([visited_shares(path) for path in paths])
    minutes = STEP_S / 60 * np.arange(shares.shape[1])
    mean = shares.mean(axis=0)
    margin = 1.96 * shares.std(axis=0, ddof=1) / np.sqrt(len(shares)) if len(shares) > 1 else 0.0
    axes.plot(minutes, mean, color=colour)
    axes.annotate(
        way,
        (minutes[-1], mean[-1]),
        (0, 3),
        textcoords="offset points",
        ha="right",
        va="bottom",
        color=colour,
    )
    axes.fill_between(minutes, mean - margin, mean + margin, color=colour, alpha=0.25, lw=0)
