"""A robot at a wall: M while it bounces to and fro, and where it does.

Over grip and k, wall and bumper, and the wheels' phases.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.wall import (
    APARTS,
    BUMPERS,
    GRIPS,
    KS,
    PAPER,
    STIFFNESSES,
    WITH_BUMPER,
    of,
    rate,
)
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Cell, Findings, Row
from host.util.intervals import wilson

Scale = tuple[
    str, tuple[float, ...], str, float
]  # a field of the rows, its values, what it is called, and a factor for its unit

_SHOWN = ((PAPER, "the body's own width"), (WITH_BUMPER, "a wide, springy bumper"))
_OVER_K: Scale = ("k", KS, "$k$", 1.0)
_OVER_GRIP: Scale = ("grip", GRIPS, "grip of the tyres", 1.0)
_OVER_BUMPER: Scale = ("bumper", BUMPERS, "width of the bumper (m)", 1.0)
_OVER_STIFFNESS: Scale = ("stiffness", STIFFNESSES, "stiffness of the wall (kN/m)", 0.001)
_TALL = {**SIZE, "figsize": (10.0, 9.6)}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows.

    All of it if they were simulated, the hits alone if they are a robot's.
    """
    with styled():
        simulated = any("t_s" in row for row in rows)
        figure = Figure(**(_TALL if simulated else SIZE))
        share, (low, high) = findings.claims[0].measured, findings.claims[0].interval or (0.0, 1.0)
        figure.suptitle(
            f"At the wall, $k$ = 2: {share:.0%} of the hits bounce (95 % interval {low:.0%} to"
            f" {high:.0%})",
            fontsize=16,
        )
        if simulated:
            _draw_simulated(figure, rows)
        else:
            _draw_hits(figure.subplots(), of(rows, PAPER))
    return figure


def _draw_simulated(figure: Figure, rows: list[Row]) -> None:
    grid = figure.add_gridspec(3, 3, height_ratios=(5, 5, 9))
    for place, (condition, words) in enumerate(_SHOWN):
        axes = figure.add_subplot(grid[place, :])
        _draw_series(axes, rows, condition, words)
    axes.set_xlabel("time (s)")
    named = {
        label: handle
        for axes in figure.axes
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    style: Any = {
        "loc": "lower right",
        "bbox_to_anchor": (1.0, 0.97),
        "ncols": 3,
        "fontsize": 11,
        "handlelength": 1.4,
    }
    figure.axes[0].legend(named.values(), named.keys(), **style)
    maps = [figure.add_subplot(grid[2, column]) for column in range(3)]
    _draw_map(maps[0], rows, _OVER_K, _OVER_GRIP)
    maps[0].set_title("bounced (%): floor and $k$", fontsize=12)
    _draw_map(maps[1], rows, _OVER_BUMPER, _OVER_STIFFNESS)
    maps[1].set_title("bounced (%): body and wall", fontsize=12)
    _draw_apart(maps[2], rows)
    maps[2].set_title("bounced (%): phases", fontsize=12)


def _draw_series(axes: Axes, rows: list[Row], condition: Cell, words: str) -> None:
    ticks = [
        row
        for row in rows
        if "t_s" in row and all(row[name] == value for name, value in condition.items())
    ]
    t = [row["t_s"] for row in ticks]
    bounced = [row["t_s"] for row in ticks if row["bounce"]]
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    for number, time in enumerate(bounced):
        axes.axvline(
            time, color=COLOURS[1], linewidth=1.6, zorder=0, label="bounce" if number == 0 else None
        )
    for side, color, width in (("left", "black", 2.6), ("right", COLOURS[5], 1.4)):
        axes.plot(
            t,
            [row[side + "_torque"] for row in ticks],
            color=color,
            linewidth=width,
            label=f"{side} wheel",
        )
    count = f"{len(bounced)} bounce{'' if len(bounced) == 1 else 's'} in {t[-1]:.0f} s"
    axes.set_title(
        f"{words} ({condition['bumper']:g} m, {condition['stiffness'] / 1000:g} kN/m): {count}",
        loc="left",
        fontsize=12,
    )
    axes.set_ylabel("torque $M$")
    axes.set_ylim(-1.1, 1.1)
    axes.set_xlim(0, t[-1])


def _draw_map(axes: Axes, rows: list[Row], across: Scale, up: Scale) -> None:
    """The share of hits that bounced, in every field of a table.

    What is not varied is as in the paper.
    """
    counts = [[rate(of(rows, {**PAPER, across[0]: x, up[0]: y})) for x in across[1]] for y in up[1]]
    shares = np.array(
        [[100 * done / tried if tried else np.nan for done, tried in line] for line in counts]
    )
    axes.pcolormesh(shares, cmap="cividis", vmin=0, vmax=100, edgecolors="white", linewidth=1)
    for (row, column), share in np.ndenumerate(shares):
        if not np.isnan(share):
            axes.text(
                column + 0.5,
                row + 0.5,
                f"{share:.0f}",
                ha="center",
                va="center",
                color="black" if share > 60 else "white",
            )
    for axis, (_, values, words, factor) in ((axes.xaxis, across), (axes.yaxis, up)):
        axis.set_ticks(np.arange(len(values)) + 0.5, [f"{factor * value:g}" for value in values])
        axis.set_label_text(words)


def _draw_apart(axes: Axes, rows: list[Row]) -> None:
    counts = [rate(of(rows, {**PAPER, "apart": apart})) for apart in APARTS]
    shares = np.array([100 * done / tried if tried else np.nan for done, tried in counts])
    low, high = (
        100 * np.array(bounds) for bounds in zip(*(wilson(*count) for count in counts), strict=True)
    )
    axes.errorbar(
        APARTS,
        shares,
        np.abs([shares - low, high - shares]),
        color=COLOURS[0],
        marker="o",
        capsize=4,
    )
    axes.set_xlabel("between the wheels (rad)")
    axes.set_xticks(np.arange(5) * np.pi / 4, ["0", "π/4", "π/2", "3π/4", "π"])
    axes.set_ylim(0, 104)


def _draw_hits(axes: Axes, hits: list[Row]) -> None:
    """M before and after each hit at which the wall was felt."""
    felt = [(number, row) for number, row in enumerate(hits, 1) if row["before"] is not None]
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    for name, color, marker in (("before", "black", "o"), ("after", COLOURS[1], "s")):
        axes.plot(
            [number for number, _ in felt],
            [row[name] for _, row in felt],
            marker,
            color=color,
            label=f"{name} the wall",
        )
    axes.set_xlabel("hit")
    axes.set_ylabel("torque $M$, mean of both wheels")
    axes.set_ylim(-1.1, 1.1)
    axes.legend(ncols=2)
