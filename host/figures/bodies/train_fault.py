"""Trains with a faulty wheel: order, speed and turning for each fault, and their paths."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_fault import (
    SIZES,
    WEAK,
    Fault,
    FaultNumbers,
    Numbers,
    PositionRow,
    Row,
    positions,
)
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings

PANELS = ("order", "speed", "turning", "paths")
# The paths that are shown, and their names.
_SHOWN: tuple[tuple[Fault, str], ...] = (
    ({"part": "weaker", "wheel": WEAK, "percent": 0}, "none"),
    ({"part": "weaker", "wheel": WEAK, "percent": -50}, "weaker by 50 %"),
    ({"part": "weaker", "wheel": WEAK, "percent": -100}, "dead"),
    ({"part": "sizes", "wheel": None, "percent": SIZES}, f"radii ±{SIZES:g} %"),
)
_LINES = ("-", "--", "-.", ":")
# Faults that are no point on the axis of k have a place to its right.
_BESIDE = {"car0_left": 16, "car1_left": 27, "car3_left": 38, "car4_left": 49, None: 66}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    faults = numbers["faults"]
    places = [_place(fault) for fault in faults]
    with styled():
        figure = Figure(**SIZE)
        grid = figure.add_gridspec(3, 2, width_ratios=(1.5, 1))
        order = figure.add_subplot(grid[0, 0])
        speed = figure.add_subplot(grid[1, 0], sharex=order)
        turning = figure.add_subplot(grid[2, 0], sharex=order)
        _draw_measure(order, faults, places, [[fault["order"]] for fault in faults])
        _draw_measure(speed, faults, places, [[fault["speed_m_s"]] for fault in faults])
        _draw_measure(turning, faults, places, [fault["turning_rad_s"] for fault in faults])
        order.set(ylabel="order", ylim=(0, 1.05))
        fastest = max(fault["speed_m_s"] for fault in faults)
        speed.set(ylabel="speed (m/s)", ylim=(0, 1.15 * fastest or None))
        turning.set_ylabel("turning (rad/s)")
        turning.axhline(0, color="lightgrey", zorder=0)
        turning.set_xticks(
            [-100, -75, -50, -25, 0, *_BESIDE.values()],
            ["-100", "-75", "-50", "-25", "0", "1", "2", "4", "5", f"±{SIZES:g} %"],
            fontsize=11,
        )
        turning.set_xlabel(
            "$k$ of the left wheel of car 3 (%)  |  dead: left of car  |  radii", fontsize=12
        )
        for axes in (order, speed):
            axes.tick_params(axis="x", labelbottom=False)
        _draw_paths(figure.add_subplot(grid[:, 1]), positions(rows))
        figure.suptitle(
            "A train with a weak or dead wheel, or wheels of different size", fontsize=16
        )
    return figure


def _place(fault: FaultNumbers) -> float:
    return fault["percent"] if fault["part"] == "weaker" else _BESIDE[fault["wheel"]]


def _draw_measure(
    axes: Axes, faults: list[FaultNumbers], places: list[float], values: list[list[float]]
) -> None:
    """Draw the values of each fault at its place."""
    for fault, place, own in zip(faults, places, values, strict=True):
        weaker = fault["part"] == "weaker"
        axes.plot(
            [place] * len(own),
            own,
            "o" if weaker else "s",
            color=COLOURS[0 if weaker else 1],
            markersize=6,
        )
    axes.axvline(8, color="lightgrey")


def _draw_paths(axes: Axes, moments: list[PositionRow]) -> None:
    for colour, line, (fault, label) in zip(COLOURS, _LINES, _SHOWN, strict=False):
        path = [row for row in moments if fault.items() <= row.items()]
        axes.plot(
            [row["x_m"] for row in path],
            [row["y_m"] for row in path],
            color=colour,
            linestyle=line,
            label=label,
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
    axes.set_title("head, from above", fontsize=13)
    axes.legend(fontsize=11, title="fault", title_fontsize=11, loc="best")
