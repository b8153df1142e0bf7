"""Every transition between motion primitives, where rest coexists with motion, and one round."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.primitives import KS, STATES
from host.experiments.robot.primitives_rows import (
    PrimitivesRow,
    TransitionRow,
    rests,
    samples,
    transitions,
)
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.util.intervals import wilson

PANELS = ("transitions", "rest", "round")
_ABOVE: Any = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "fontsize": 11}


def draw(rows: list[PrimitivesRow], findings: Findings) -> Figure:
    """Draw the rows."""
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


def _draw_matrix(axes: Axes, rows: list[PrimitivesRow]) -> None:
    """Draw the rate, the counts and the median time of each transition."""
    rates = np.full((len(STATES), len(STATES)), np.nan)
    for row, begin in enumerate(STATES):
        for column, end in enumerate(STATES):
            tries = transitions(rows, begin, end)
            if tries:
                rates[row, column] = np.mean([done["reached"] for done in tries])
                centred: Any = {"ha": "center", "va": "center", "fontsize": 11}
                colour = "black" if rates[row, column] > 0.5 else "white"
                axes.text(column, row, _score(tries), color=colour, **centred)
    axes.imshow(rates, cmap="cividis", vmin=0, vmax=1.35, aspect="auto")
    names = [name.replace("-", "\n") for name in STATES]
    axes.set_xticks(range(len(STATES)), names, fontsize=11)
    axes.set_yticks(range(len(STATES)), names, fontsize=11)
    axes.set(xlabel="to", ylabel="from")
    axes.set_title("reached / tried, and median time", fontsize=12, loc="left")
    axes.spines[:].set_visible(False)


def _score(tries: list[TransitionRow]) -> str:
    """Reached / tried, and below it the median time."""
    times = [done["seconds"] for done in tries if done["reached"]]
    median = f"\n{np.median(times):.1f} s" if times else ""
    return f"{len(times)}/{len(tries)}{median}"


def _draw_rest(axes: Axes, rows: list[PrimitivesRow]) -> None:
    """Draw how often the robot runs at each k, and stays at rest there, with 95 % intervals."""
    _draw_tries(axes, rows, "runs", "runs", COLOURS[2], "o")
    _draw_tries(axes, rows, "stays", "stays at rest after a pulse of $k$ to 0", COLOURS[1], "s")
    axes.set_xscale("log")
    axes.set_xticks([0.5, 1, 2, 4, 8], ["0.5", "1", "2", "4", "8"])
    axes.minorticks_off()
    axes.set(xlabel="spring constant $k$", ylabel="of the tries (%)", ylim=(-4, 104))
    axes.legend(ncols=2, columnspacing=1.0, handletextpad=0.4, **_ABOVE)


def _draw_tries(
    axes: Axes,
    rows: list[PrimitivesRow],
    what: Literal["runs", "stays"],
    label: str,
    colour: str,
    marker: str,
) -> None:
    counts = [rests(rows, k, what) for k in KS]
    low, high = 100 * np.array([wilson(*count) for count in counts]).T
    shares = [100 * done / of if of else np.nan for done, of in counts]
    axes.fill_between(KS, low, high, color=colour, alpha=0.2, linewidth=0)
    axes.plot(KS, shares, color=colour, marker=marker, markersize=5, label=label)


def _draw_round(axes: Axes, rows: list[PrimitivesRow]) -> None:
    """Draw both wheels' speeds, and where k was lowered for the robot to stay at rest."""
    shown = samples(rows)
    t = [row["t_s"] for row in shown]
    left, right = [row["left_hz"] for row in shown], [row["right_hz"] for row in shown]
    axes.plot(t, left, color=COLOURS[4], linewidth=3.4, label="left wheel")
    axes.plot(t, right, color=COLOURS[0], linewidth=1.4, label="right wheel")
    full = max((row["k"] for row in shown), default=0.0)
    lowered = [row["k"] < full for row in shown]
    grey: Any = {"color": "grey", "alpha": 0.3, "linewidth": 0, "label": "$k$ lowered"}
    axes.fill_between(t, 0, 1, where=lowered, transform=axes.get_xaxis_transform(), **grey)
    axes.set(
        xlabel="time (s), one round of all transitions",
        ylabel=r"$\omega/2\pi$ (Hz)",
        ylim=(-2.6, 2.6),
    )
    axes.margins(x=0)
    axes.legend(ncols=3, **_ABOVE)
