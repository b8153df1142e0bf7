"""Every transition between the motion primitives; where rest coexists with locomotion.

And the wheels' speeds over one round.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.primitives import KS, STATES, rests, transitions
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row
from host.util.intervals import wilson

_WHEELS = {"left_hz": ("left", COLOURS[4], 3.4), "right_hz": ("right", COLOURS[0], 1.4)}
_TRIES = {
    "runs": ("runs", COLOURS[2], "o"),
    "stays": ("stays at rest after a pulse of $k$ to 0", COLOURS[1], "s"),
}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**SIZE)
        halves = figure.add_gridspec(2, 1, height_ratios=(1.9, 1))
        upper = halves[0].subgridspec(1, 2, width_ratios=(1.2, 1))
        _draw_matrix(figure.add_subplot(upper[0]), rows)
        _draw_rest(figure.add_subplot(upper[1]), rows)
        _draw_round(figure.add_subplot(halves[1]), rows)
        figure.suptitle(
            "Motion primitives, from each other by kicks, and where the robot may rest", fontsize=16
        )
    return figure


def _draw_matrix(axes: Axes, rows: list[Row]) -> None:
    """Rate, with the counts, and the median time of each transition."""
    rates = np.full((len(STATES), len(STATES)), np.nan)
    for row, begin in enumerate(STATES):
        for column, end in enumerate(STATES):
            tries = transitions(rows, begin, end)
            reached = [done for done in tries if done["reached"]]
            if tries:
                rates[row, column] = len(reached) / len(tries)
                times = (
                    f"\n{np.median([done['seconds'] for done in reached]):.1f} s" if reached else ""
                )
                colour = "black" if rates[row, column] > 0.5 else "white"
                axes.text(
                    column,
                    row,
                    f"{len(reached)}/{len(tries)}{times}",
                    ha="center",
                    va="center",
                    fontsize=11,
                    color=colour,
                )
    axes.imshow(rates, cmap="cividis", vmin=0, vmax=1.35, aspect="auto")
    names = [name.replace("-", "\n") for name in STATES]
    axes.set_xticks(range(len(STATES)), names, fontsize=11)
    axes.set_yticks(range(len(STATES)), names, fontsize=11)
    axes.set(xlabel="to", ylabel="from")
    axes.set_title("reached / tried, and median time", fontsize=12, loc="left")
    axes.spines[:].set_visible(False)


def _draw_rest(axes: Axes, rows: list[Row]) -> None:
    """How often the robot runs at a k, and stays at rest there, with 95 % intervals."""
    for name, (label, colour, marker) in _TRIES.items():
        counts = [rests(rows, k, name) for k in KS]
        low, high = 100 * np.array([wilson(*count) for count in counts]).T
        axes.fill_between(KS, low, high, color=colour, alpha=0.2, linewidth=0)
        axes.plot(
            KS,
            [100 * done / of if of else np.nan for done, of in counts],
            color=colour,
            marker=marker,
            markersize=5,
            label=label,
        )
    axes.set_xscale("log")
    axes.set_xticks([0.5, 1, 2, 4, 8], ["0.5", "1", "2", "4", "8"])
    axes.minorticks_off()
    axes.set(xlabel="spring constant $k$", ylabel="of the tries (%)", ylim=(-4, 104))
    axes.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=2,
        fontsize=11,
        columnspacing=1.0,
        handletextpad=0.4,
    )


def _draw_round(axes: Axes, rows: list[Row]) -> None:
    """Both wheels' speeds, and where k was lowered for the robot to stay at rest."""
    samples = [row for row in rows if row["kind"] == "sample"]
    t = [row["t_s"] for row in samples]
    for name, (label, colour, width) in _WHEELS.items():
        axes.plot(
            t, [row[name] for row in samples], color=colour, linewidth=width, label=f"{label} wheel"
        )
    full = max((row["k"] for row in samples), default=0.0)
    lowered = [row["k"] < full for row in samples]
    height = axes.get_xaxis_transform()
    axes.fill_between(
        t,
        0,
        1,
        where=lowered,
        color="grey",
        alpha=0.3,
        linewidth=0,
        transform=height,
        label="$k$ lowered",
    )
    axes.set(
        xlabel="time (s), one round of all transitions",
        ylabel=r"$\omega/2\pi$ (Hz)",
        ylim=(-2.6, 2.6),
    )
    axes.margins(x=0)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, fontsize=11)
