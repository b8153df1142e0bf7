"""One round of the three kicks as in the paper's timeline.

Beside it how far the wheels slipped and how long they took to settle.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.timeline import KICKS, kicks, settling
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row

# The colours of the paper's figure.
_LINES = {
    "left_x1": ("saddlebrown", 1.6, "$x_1$ left"),
    "left_x2": ("darkorange", 1.6, "$x_2$ left"),
    "right_x1": ("mediumblue", 1.6, "$x_1$ right"),
    "right_x2": ("deepskyblue", 1.6, "$x_2$ right"),
    "left_torque": ("black", 4.0, "$M$ left"),
    "right_torque": ("grey", 2.0, "$M$ right"),
}
_KICK = "crimson"
_MODES = dict(
    zip(KICKS, zip((COLOURS[0], COLOURS[1], COLOURS[2]), "os^", strict=True), strict=True)
)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**SIZE)
        halves = figure.add_gridspec(1, 2, width_ratios=(1.7, 1))
        left = halves[0].subgridspec(3, 1)
        panels = [figure.add_subplot(left[index]) for index in range(len(KICKS))]
        for axes, mode in zip(panels, KICKS, strict=True):
            _draw_series(
                axes, [row for row in rows if row["kind"] == "tick" and row["mode"] == mode]
            )
            ticks = next(
                (row["ticks"] for row in rows if row["kind"] == "kick" and row["mode"] == mode), 1
            )
            axes.set_title(
                f"{mode} kicks, {ticks} tick{'s' if ticks > 1 else ''}",
                loc="left",
                fontsize=12,
                pad=3,
            )
        panels[1].set_ylabel("potentials $x$, torque $M$")
        panels[-1].set_xlabel("time since the first kick (s)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(
            handles,
            labels,
            loc="outside lower left",
            ncols=7,
            fontsize=11,
            columnspacing=1.1,
            handlelength=1.3,
        )
        right = halves[1].subgridspec(2, 1)
        chances = [figure.add_subplot(right[index]) for index in range(2)]
        _draw_slips(chances[0], rows)
        _draw_settling(chances[1], rows)
        figure.suptitle(
            f"Three kicks, there and back: one of {len({row['trial'] for row in rows})} rounds, and"
            " all of them",
            fontsize=16,
        )
    return figure


def _draw_series(axes: Axes, ticks: list[Row]) -> None:
    t = [row["t_s"] for row in ticks]
    for name, (colour, width, label) in _LINES.items():
        axes.plot(t, [row[name] for row in ticks], color=colour, linewidth=width, label=label)
    labelled = False
    for row, after in pairwise(ticks):
        if row["kicked"]:
            axes.axvspan(
                row["t_s"],
                after["t_s"],
                color=_KICK,
                alpha=0.45,
                linewidth=0,
                label="" if labelled else "kick",
            )
            labelled = True
    axes.set_ylim(-1.1, 1.1)
    axes.margins(x=0)


def _draw_slips(axes: Axes, rows: list[Row]) -> None:
    """Each kick's slip against the relative phase before it, with how much that drifts in as long without a kick."""
    for mode, (colour, marker) in _MODES.items():
        done = kicks(rows, mode)
        before = np.degrees([row["relative_before_rad"] for row in done])
        slips = np.degrees([row["slip_rad"] for row in done])
        axes.plot(before, slips, marker, color=colour, markersize=5, alpha=0.8, label=mode)
    drift = max((float(np.degrees(abs(row["drift_rad"]))) for row in kicks(rows)), default=0.0)
    axes.axhspan(-drift, drift, color="grey", alpha=0.3, linewidth=0, label="unkicked")
    axes.set(xlabel="relative phase before (°)", ylabel="phase slip (°)", xlim=(-180, 180))
    axes.set_xticks(range(-180, 181, 90))
    above: Any = {"loc": "lower center", "bbox_to_anchor": (0.45, 1.0), "ncols": 4}
    axes.legend(fontsize=10, columnspacing=0.6, handletextpad=0.1, handlelength=1.2, **above)


def _draw_settling(axes: Axes, rows: list[Row]) -> None:
    """How long the slower wheel took: a column of points for each kind of kick, spread a little."""
    rng = np.random.default_rng(0)
    for place, (mode, (colour, marker)) in enumerate(_MODES.items()):
        times = settling(kicks(rows, mode))
        axes.plot(
            place + rng.uniform(-0.2, 0.2, len(times)),
            times,
            marker,
            color=colour,
            markersize=5,
            alpha=0.8,
        )
    axes.set_xticks(range(len(_MODES)), list(_MODES), fontsize=12)
    axes.set(
        ylabel="settling time (s)",
        ylim=(0, 1.1 * max([*settling(kicks(rows)), 0.1])),
        xlim=(-0.5, len(_MODES) - 0.5),
    )
