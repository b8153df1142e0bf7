"""The largest exponent along k, and how long chaotic transients last.

A colour says what a wheel does in the end: it is chaotic if the plotted exponent is above 0.
"""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from host.figures.style import COLOURS, SIZE, styled
from host.figures.theory.transients import draw_lives, draw_survival
from host.runs.contract import Findings
from host.theory.analysis.attractors import BACK, CHAOS, KINDS, REST, ROLL, Kind
from host.theory.studies.lyapunov_numbers import LineNumbers
from host.theory.studies.lyapunov_rows import GridRow, LineRow, line_of, lives_of

PANELS = ("line", "survival", "lives")

_COLOUR: dict[Kind, str] = {
    KINDS[REST]: COLOURS[6],
    KINDS[BACK]: COLOURS[4],
    KINDS[ROLL]: COLOURS[0],
    KINDS[CHAOS]: COLOURS[1],
}
_MARKER: dict[Kind, str] = {KINDS[REST]: "s", KINDS[BACK]: "^", KINDS[ROLL]: "o", KINDS[CHAOS]: "."}
_SMALL = 11


def draw(rows: list[LineRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: LineNumbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.2, 1.0))
        _draw_line(figure.add_subplot(grid[0, :]), line_of(rows), numbers)
        draw_survival(figure.add_subplot(grid[1, 0]), lives_of(rows), numbers)
        draw_lives(figure.add_subplot(grid[1, 1]), numbers)
        figure.suptitle(f"Route to chaos at $\\tau$ = {numbers['tau']:g} s", fontsize=16)
    return figure


def _draw_line(axes: Axes, rows: list[GridRow], numbers: LineNumbers) -> None:
    """Each wheel's largest exponent."""
    for kind in KINDS:
        own = [row for row in rows if row["kind"] == kind]
        style: Any = {
            "color": _COLOUR[kind],
            "marker": _MARKER[kind],
            "markersize": 5,
            "alpha": 0.6,
            "markeredgewidth": 0,
        }
        axes.plot(
            [row["k"] for row in own], [row["exponent"] for row in own], linestyle="", **style
        )
    axes.axhline(0.0, color="grey", linewidth=0.8, zorder=0)
    most_k = max(row["k"] for row in rows)
    axes.set_xlim(0, most_k)
    exponents = [row["exponent"] for row in rows]
    top, bottom = max(*exponents, 0.2), max(min(exponents), -0.6 * max(*exponents, 0.5))
    axes.set_ylim(1.1 * bottom - 0.02, 1.25 * top)
    begins, ends = numbers["crisis"], numbers["rolling_ends"]
    if begins and ends and begins["k"] < ends["k"]:
        axes.axvspan(begins["k"], ends["k"], color=COLOURS[2], alpha=0.3, linewidth=0)
        words = f"chaos and rolling coexist,\n$k$ = {begins['k']:.2f} to {ends['k']:.2f}"
        axes.annotate(
            words,
            (ends["k"], 1.1 * top),
            (8, 0),
            textcoords="offset points",
            ha="left",
            va="center",
            fontsize=_SMALL,
        )
    axes.set_xlabel("spring constant $k$")
    axes.set_ylabel(r"largest exponent $\lambda_1$ (1/s)")
    present = [kind for kind in KINDS if any(row["kind"] == kind for row in rows)]
    handles = [
        Line2D(
            [],
            [],
            color=_COLOUR[kind],
            marker=_MARKER[kind],
            linestyle="",
            markersize=8,
            label=kind,
        )
        for kind in present
    ]
    axes.legend(
        handles=handles,
        ncols=len(handles),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        fontsize=12,
        borderaxespad=0.1,
    )
