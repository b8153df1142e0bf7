"""Two panels of the figure `branch`: the merging over tau, and potentials of a turning wheel."""

from __future__ import annotations

from itertools import groupby
from math import degrees
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from host.figures.style import COLOURS, say_if_empty
from host.theory.studies.branch_tables import LineRow, TurnedRow

DASHED: Any = (0, (2.5, 1.2))
# Those of turning wheels of each k, which can be told apart in grey, too.
_WIDTHS = (1.2, 3.0)


def draw_line(axes: Axes, line: list[LineRow]) -> None:
    """The merging in units of the Hopf bifurcation's k, by the sign of the saddle quantity."""
    last: list[LineRow] = []
    for positive, group in groupby(line, key=lambda row: row["saddle_quantity"] > 0.0):
        points = list(group)
        stretch = last + points  # joined to the one before it
        axes.plot(
            [row["tau"] for row in stretch],
            [row["k"] / row["k_hopf"] for row in stretch],
            color=COLOURS[3] if positive else COLOURS[5],
            linewidth=2.5,
            linestyle=(0, (1.0, 0.5)) if positive else "-",
            label="unstable, folds" if positive else "stable",
        )
        last = points[-1:]
    say_if_empty(axes, "no merging from a tenth of the\nwheel's tau to ten times it")
    axes.axhline(1.0, color="black", linewidth=1.0)
    axes.set_title(r"the merging over $\tau$", fontsize=12)
    axes.set(xscale="log")
    axes.set_xlabel(r"time constant $\tau$ (s)", fontsize=12)
    axes.set_ylabel("$k_\\mathrm{merging} / k_\\mathrm{Hopf}$", fontsize=12)
    if line:
        axes.legend(
            fontsize=10.5,
            title="cycles near it:",
            title_fontsize=10.5,
            loc="upper right",
            handlelength=1.5,
        )


def draw_turning(axes: Axes, turned: dict[float, list[TurnedRow]]) -> None:
    """x1 of a turned wheel: formula, numbers, and the wheel that rolls by itself."""
    for colour, width, k in zip(COLOURS, _WIDTHS, sorted(turned), strict=False):
        own = sorted(turned[k], key=lambda row: row["phi"])
        angles = [degrees(row["phi"]) for row in own]
        axes.plot(
            angles,
            [row["x1"] for row in own],
            color=colour,
            linewidth=width,
            label=f"$k$ = {k:g}, formula",
        )
        dots = own[:: max(1, len(own) // 24)]
        axes.plot(
            [degrees(row["phi"]) for row in dots],
            [row["x1_numeric"] for row in dots],
            color=colour,
            linestyle="",
            marker=".",
        )
        if own[0]["x1_rolling"] is not None:
            rolling = np.array([row["x1_rolling"] for row in own], dtype=float)
            axes.plot(angles, rolling, color=colour, linestyle=DASHED)
    axes.plot([], [], color="dimgrey", linestyle="", marker=".", label="numbers")
    if any(own[0]["x1_rolling"] is not None for own in turned.values()):
        axes.plot([], [], color="dimgrey", linestyle=DASHED, label="a rolling wheel")
    axes.set_title("potential of a turned wheel", fontsize=12)
    axes.set_xlabel(r"angle $\varphi$ (°)", fontsize=12)
    axes.set_ylabel("$x_1$", fontsize=12)
    axes.set_xticks((0, 90, 180, 270, 360))
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.75 * (high - low))
    axes.legend(fontsize=10, loc="upper center", handlelength=1.5, ncols=2, columnspacing=1.0)
