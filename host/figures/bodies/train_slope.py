"""A train between four slopes.

How often it turns back, how coherent it is, over the slopes' angle and k; and two ways from above.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_slope import ANGLES, SHOWN, TRAINS
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Cell, Findings, Row

_FOOT_M = 4.0


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    kinds = findings.numbers["trains"]
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 9.2)})
        maps, ways = figure.subplots(2, 2, height_ratios=(1, 1.25))
        minute = [kind["reversals_a_minute"] for kind in kinds]
        _draw_map(maps[0], kinds, "reversals a minute", minute, max(1.0, *minute))
        _draw_map(
            maps[1],
            kinds,
            "time with order above 0.9 (%)",
            [_percent(kind["coherent"]) for kind in kinds],
            100.0,
        )
        maps[1].set_yticklabels([])
        for axes, shown in zip(ways, SHOWN, strict=True):
            _draw_way(
                axes,
                [
                    row
                    for row in rows
                    if "t_s" in row and all(row[name] == value for name, value in shown.items())
                ],
                shown,
            )
        figure.suptitle(
            f"A train between four slopes, {kinds[0]['runs']} runs each (left: farther than 2 m up"
            " a slope)",
            fontsize=15,
        )
    return figure


def _percent(share: float | None) -> float:
    return np.nan if share is None else 100 * share


def _draw_map(
    axes: Axes, kinds: list[dict[str, Any]], title: str, values: list[float], most: float
) -> None:
    table = np.array(values).reshape(len(TRAINS), len(ANGLES))
    axes.pcolormesh(table, cmap="cividis", vmin=0, vmax=most, edgecolors="white", linewidth=1)
    for (row, column), value in np.ndenumerate(table):
        kind = kinds[row * len(ANGLES) + column]
        left = f"\n({kind['runs'] - kind['inside']} left)" if kind["inside"] < kind["runs"] else ""
        colour = "black" if value > 0.6 * most else "white"
        axes.text(
            column + 0.5,
            row + 0.5,
            f"{value:.0f}{left}",
            ha="center",
            va="center",
            color=colour,
            fontsize=11,
        )
    axes.set_xticks(np.arange(len(ANGLES)) + 0.5, [f"{angle:g}" for angle in ANGLES])
    axes.set_yticks(
        np.arange(len(TRAINS)) + 0.5,
        [f"{train['preset']}\n$k$ = {train['k']:g} N" for train in TRAINS],
        fontsize=11,
    )
    axes.set_xlabel("angle of the slopes (rad)")
    axes.set_title(title, fontsize=13)


def _draw_way(axes: Axes, way: list[Row], shown: Cell) -> None:
    box = _FOOT_M * np.array([[-1, 1, 1, -1, -1], [-1, -1, 1, 1, -1]])
    axes.fill(*box, color="whitesmoke", zorder=0)
    axes.plot(*box, color="grey", linewidth=1, linestyle="--", zorder=1)
    axes.plot(
        [row["x_m"] for row in way], [row["y_m"] for row in way], color=COLOURS[0], linewidth=1.2
    )
    axes.plot(way[0]["x_m"], way[0]["y_m"], "o", color=COLOURS[1])
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
    axes.set_title(
        f"{shown['preset']}, $k$ = {shown['k']:g} N, {shown['angle']:g} rad: head,"
        f" {way[-1]['t_s']:.0f} s",
        fontsize=13,
    )
