"""The car's path between slopes, from above, for each angle.

Shown is the car that saw most of the floor.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from host.experiments.bodies.car_slope import (
    ANGLES,
    AngleNumbers,
    DriveRow,
    Numbers,
    PositionRow,
    Row,
    drives,
    positions,
)
from host.figures.bodies.from_above import draw_scene, scene_data
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings

PANELS = tuple(f"{angle:g}" for angle in ANGLES)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    moments = positions(rows)
    minutes = max((row["t_s"] for row in moments), default=0.0) / 60
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(1, len(numbers["angles"]))
        for axes, angle in zip(panels, numbers["angles"], strict=True):
            cars = [row for row in drives(rows) if row["angle"] == angle["angle"]]
            shown = max(cars, key=lambda row: row["squares"])
            path = [
                row
                for row in moments
                if (row["angle"], row["number"]) == (shown["angle"], shown["number"])
            ]
            lines = _draw_path(axes, path, angle["angle"])
            axes.set_title(_title(angle, shown), fontsize=12)
        figure.colorbar(lines, ax=panels, shrink=0.6, label="time (min)")
        figure.suptitle(
            f"A car between four slopes (dashed: their feet), for {minutes:.2g} min; dot: where it"
            " ends",
            fontsize=16,
        )
    return figure


def _draw_path(axes: Axes, path: list[PositionRow], angle: float) -> LineCollection:
    """Draw a path coloured by time over the slopes, and return its lines."""
    points = np.array([[row["x_m"], row["y_m"]] for row in path])
    draw_scene(axes, scene_data("slopes", angle), points)
    t_s = np.array([row["t_s"] for row in path])
    lines = LineCollection(
        list(np.stack([points[:-1], points[1:]], axis=1)),
        cmap="cividis",
        array=t_s[:-1] / 60,
        linewidths=0.9,
    )
    axes.add_collection(lines)
    axes.plot(*points[-1], "o", color=COLOURS[1], markersize=5)
    return lines


def _title(angle: AngleNumbers, shown: DriveRow) -> str:
    return (
        f"{angle['angle']:g} rad: {angle['inside']} of {angle['cars']} inside,"
        f" {angle['flipped']} flipped;\nshown: {shown['path_m']:.0f} m, reversals:"
        f" {shown['reversals']}"
    )
