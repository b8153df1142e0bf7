"""A train between two walls: the way of its middle, and how often it reversed.

With dead and bouncy walls, with its controller and with a constant torque.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_wall import (
    LEAST,
    TRAINS,
    KindNumbers,
    Numbers,
    Row,
    Train,
    moments,
    name_train,
)
from host.figures.bodies.from_above import scene_data, walls
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings

PANELS = tuple(f"{kind}-{row}" for row in (1, 2, 3) for kind in ("way", "reversals"))
# What is drawn: a name, whether there is a controller, whether walls are bouncy, and a style.
_LINES: tuple[tuple[str, bool, bool, dict[str, Any]], ...] = (
    ("dead walls", True, False, {"color": COLOURS[0]}),
    ("bouncy walls", True, True, {"color": COLOURS[1], "linestyle": "-."}),
    ("constant torque, dead walls", False, False, {"color": "black", "linestyle": "--"}),
)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    walls_m = [float(wall.middle[0]) for wall in walls(scene_data("walls"))]
    with styled():
        figure = Figure(**SIZE)
        grid = figure.subplots(len(TRAINS), 2, width_ratios=(3.2, 1), sharex="col")
        for (way, counts), train in zip(grid, TRAINS, strict=True):
            _draw_way(way, rows, train, walls_m)
            _draw_counts(
                counts, [kind for kind in numbers["kinds"] if train.items() <= kind.items()]
            )
        grid[-1][0].set_xlabel("time (s)")
        figure.suptitle(
            f"A train between two walls {np.ptp(walls_m):g} m apart (grey): first run of each, and"
            " all runs' reversals",
            fontsize=15,
        )
        share_legend(figure, grid[0], loc="outside lower center", ncols=4, fontsize=12)
    return figure


def _draw_way(axes: Axes, rows: list[Row], train: Train, walls_m: list[float]) -> None:
    for wall in walls_m:
        axes.axhline(wall, color="grey", linewidth=5, alpha=0.5)
    for name, controller, bouncy, style in _LINES:
        way = moments(rows, {**train, "controller": controller, "bouncy": bouncy})
        axes.plot([row["t_s"] for row in way], [row["x_m"] for row in way], label=name, **style)
    axes.set_title(name_train(train), loc="left", fontsize=13)
    axes.set(ylabel="middle, $x$ (m)", ylim=(-5, 5))
    axes.margins(x=0)


def _draw_counts(axes: Axes, kinds: list[KindNumbers]) -> None:
    axes.axhline(LEAST, color="black", linewidth=1, linestyle=":", label="claim B3")
    for kind in kinds:
        place, count = int(kind["bouncy"]), len(kind["reversals"])
        offsets = [place + 0.35 * ((number + 0.5) / count - 0.5) for number in range(count)]
        axes.plot(offsets, kind["reversals"], "os"[place], color=COLOURS[place])
    axes.set_xticks((0, 1), ("dead", "bouncy"))
    axes.set(xlim=(-0.5, 1.5), ylabel="reversals")
    axes.set_ylim(-0.5, max(LEAST + 1, *(max(kind["reversals"]) + 1 for kind in kinds)))
