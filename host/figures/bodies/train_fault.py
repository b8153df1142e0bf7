"""Trains with a faulty wheel.

Order, speed and turning over how weak it is, and where such trains go.
"""

from __future__ import annotations

from itertools import groupby
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_fault import SIZES, WEAK
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row

_SHOWN = (
    ("weaker", 0, "none"),
    ("weaker", -50, "weaker by 50 %"),
    ("weaker", -100, "dead"),
    ("sizes", SIZES, f"radii ±{SIZES:g} %"),
)
# Faults that are no point on the axis of k stand beside it.
_BESIDE = {"car0_left": 16, "car1_left": 27, "car3_left": 38, "car4_left": 49, None: 66}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 9.0)})
        grid = figure.add_gridspec(3, 2, width_ratios=(1.5, 1))
        faults, axes = findings.numbers["faults"], figure.add_subplot(grid[0, 0])
        lines = [axes, *(figure.add_subplot(grid[line, 0], sharex=axes) for line in (1, 2))]
        for line, (name, label) in zip(
            lines,
            (
                ("order", "order"),
                ("speed_m_s", "speed (m/s)"),
                ("turning_rad_s", "turning (rad/s)"),
            ),
            strict=True,
        ):
            _draw_measure(line, faults, name, label)
        lines[0].set_ylim(0, 1.05)
        lines[1].set_ylim(bottom=0)
        lines[2].axhline(0, color="lightgrey", zorder=0)
        lines[2].set_xticks(
            [-100, -75, -50, -25, 0, *_BESIDE.values()],
            ["-100", "-75", "-50", "-25", "0", "1", "2", "4", "5", f"±{SIZES:g} %"],
            fontsize=11,
        )
        lines[2].set_xlabel(
            "$k$ of the left wheel of car 3 (%)  |  dead: left of car  |  radii", fontsize=12
        )
        _draw_ways(figure.add_subplot(grid[:, 1]), rows)
        figure.suptitle(
            "A train with a weak or dead wheel, or wheels of different size", fontsize=16
        )
    return figure


def _draw_measure(axes: Axes, faults: list[dict[str, Any]], name: str, label: str) -> None:
    for fault in faults:
        values = fault[name] if isinstance(fault[name], list) else [fault[name]]
        weaker = fault["part"] == "weaker"
        place = fault["percent"] if weaker else _BESIDE[fault["wheel"]]
        axes.plot(
            [place] * len(values),
            values,
            "o" if weaker else "s",
            color=COLOURS[0 if weaker else 1],
            markersize=6,
        )
    axes.set_ylabel(label)
    axes.axvline(8, color="lightgrey")
    axes.tick_params(axis="x", labelbottom=name == "turning_rad_s")


def _draw_ways(axes: Axes, rows: list[Row]) -> None:
    series = [row for row in rows if "t_s" in row and row["number"] == 0]
    ways = {
        key: list(way)
        for key, way in groupby(series, key=lambda row: (row["part"], row["wheel"], row["percent"]))
    }
    for number, (part, percent, label) in enumerate(_SHOWN):
        way = ways[part, None if part == "sizes" else WEAK, percent]
        axes.plot(
            [row["x_m"] for row in way],
            [row["y_m"] for row in way],
            color=COLOURS[number],
            label=label,
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
    axes.set_title("head, from above", fontsize=13)
    axes.legend(fontsize=11, title="fault", title_fontsize=11, loc="best")
