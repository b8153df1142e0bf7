"""A train between four slopes.

How often it turns back and how coherent it is, over the slopes' angle and k; and two paths.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_slope import (
    ANGLES,
    SHOWN,
    TRAINS,
    Kind,
    KindNumbers,
    Numbers,
    PositionRow,
    Row,
    positions,
)
from host.figures.bodies.from_above import draw_scene, scene_data
from host.figures.heat_map import draw_heat_map
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings

PANELS = ("reversals", "path-1", "path-2", "coherent")


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    kinds = numbers["trains"]
    reversals = [kind["reversals_a_minute"] for kind in kinds]
    coherent = [np.nan if kind["coherent"] is None else 100 * kind["coherent"] for kind in kinds]
    with styled():
        figure = Figure(**SIZE)
        places: Any = figure.subplot_mosaic(
            [["reversals", "path-1", "path-2"], ["coherent", "path-1", "path-2"]],
            width_ratios=(1.1, 1, 1),
        )
        maps = places["reversals"], places["coherent"]
        _draw_map(maps[0], kinds, "reversals a minute", reversals, max(1.0, *reversals))
        _draw_map(maps[1], kinds, "time with order above 0.9 (%)", coherent, 100.0)
        for number, shown in enumerate(SHOWN, start=1):
            _draw_path(places[f"path-{number}"], positions(rows, shown), shown)
        figure.suptitle(
            f"A train between four slopes, runs of each: {kinds[0]['runs']}"
            " (left: farther than 2 m up a slope)",
            fontsize=15,
        )
    return figure


def _draw_map(
    axes: Axes, kinds: list[KindNumbers], title: str, values: list[float], largest: float
) -> None:
    """Draw a value of each kind, and how many of its runs left the slopes."""

    def label(row: int, column: int, value: float) -> str:
        kind = kinds[row * len(ANGLES) + column]
        left = kind["runs"] - kind["inside"]
        return f"{value:.0f}\n({left} left)" if left else f"{value:.0f}"

    draw_heat_map(axes, np.reshape(values, (len(TRAINS), len(ANGLES))), largest, label)
    axes.set_xticks(np.arange(len(ANGLES)) + 0.5, [f"{angle:g}" for angle in ANGLES])
    axes.set_yticks(
        np.arange(len(TRAINS)) + 0.5,
        [f"{train['preset']}\n$k$ = {train['k']:g} N" for train in TRAINS],
        fontsize=10,
    )
    axes.set_xlabel("angle of the slopes (rad)")
    axes.set_title(title, fontsize=13)


def _draw_path(axes: Axes, path: list[PositionRow], shown: Kind) -> None:
    points = np.array([[row["x_m"], row["y_m"]] for row in path])
    draw_scene(axes, scene_data("slopes", shown["angle"]), points)
    axes.plot(*points.T, color=COLOURS[0], linewidth=1.2)
    axes.plot(*points[0], "o", color=COLOURS[1])
    axes.set_title(
        f"{shown['preset']}, $k$ = {shown['k']:g} N, {shown['angle']:g} rad:\n"
        f"way of the head from the dot, {path[-1]['t_s']:.0f} s",
        fontsize=12,
    )
