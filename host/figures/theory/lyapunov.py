"""Chaos: a time series, the largest exponent along k and over the plane, and chaotic transients."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from host.figures.style import COLOURS, SIZE, styled
from host.figures.theory.lyapunov_transients import draw_lives, draw_survival
from host.runs.contract import Findings
from host.theory.analysis.attractors import BACK, CHAOS, KINDS, REST, ROLL, Kind
from host.theory.studies.lyapunov_numbers import Constants, Numbers
from host.theory.studies.lyapunov_rows import (
    ANY,
    ROLLS,
    GridRow,
    LyapunovRow,
    SeriesRow,
    StartKind,
    line_of,
    lives_of,
    plane_of,
    series_of,
)

SHOWN_S = 40.0
_COLOUR: dict[Kind, str] = {
    KINDS[REST]: COLOURS[6],
    KINDS[BACK]: COLOURS[4],
    KINDS[ROLL]: COLOURS[0],
    KINDS[CHAOS]: COLOURS[1],
}
_MARKER: dict[Kind, str] = {KINDS[REST]: "s", KINDS[BACK]: "^", KINDS[ROLL]: "o", KINDS[CHAOS]: "."}
_SMALL = 11


def draw(rows: list[LyapunovRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    constants = numbers["constants"]
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 14.5)})
        grid = figure.add_gridspec(4, 2, height_ratios=(2.0, 3.4, 3.6, 3.2))
        _draw_series(figure.add_subplot(grid[0, :]), series_of(rows), numbers)
        _draw_line(figure.add_subplot(grid[1, :]), line_of(rows), numbers)
        panels = [figure.add_subplot(grid[2, column]) for column in range(2)]
        _draw_planes(figure, panels, plane_of(rows), constants)
        draw_survival(figure.add_subplot(grid[3, 0]), lives_of(rows), numbers)
        draw_lives(figure.add_subplot(grid[3, 1]), numbers)
        figure.suptitle(_title(numbers), fontsize=16)
    return figure


def _title(numbers: Numbers) -> str:
    constants, point = numbers["constants"], numbers["point"]
    rate, error = numbers["exponents"][0], numbers["standard_errors"][0]
    where = f"$k$ = {constants['k']:g}, $\\tau$ = {constants['tau']:g} s"
    return (
        f"{where}: {point['kind']}, $\\lambda_1$ = {_rounded(rate)} ± {_rounded(error)} /s,"
        f" dimension {point['dimension']:.2f}"
    )


def _rounded(value: float) -> str:
    """With three digits after the point, and no sign before zero."""
    return f"{round(value, 3) + 0.0:.3f}"


def _draw_series(axes: Axes, series: list[SeriesRow], numbers: Numbers) -> None:
    shown = [row for row in series if row["t_s"] <= SHOWN_S]
    axes.plot(
        [row["t_s"] for row in shown], [row["force"] for row in shown], color="black", linewidth=1.3
    )
    axes.axhline(0.0, color="grey", linewidth=0.8)
    axes.set_xlim(0, SHOWN_S)
    axes.set_xlabel("time (s)")
    axes.set_ylabel(r"torque $F_\mathrm{tan}$")
    spectrum = ", ".join(
        f"{_rounded(rate)} ± {_rounded(error)}"
        for rate, error in zip(numbers["exponents"], numbers["standard_errors"], strict=True)
    )
    axes.set_title(f"spectrum: {spectrum} /s", fontsize=12, loc="left")


def _draw_line(axes: Axes, rows: list[GridRow], numbers: Numbers) -> None:
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
    axes.set_title(f"$\\tau$ = {numbers['constants']['tau']:g} s", fontsize=13, loc="right")


def _draw_planes(
    figure: Figure, panels: list[Axes], rows: list[GridRow], constants: Constants
) -> None:
    """The largest exponent over the plane, of either start."""
    titles: dict[StartKind, str] = {
        ANY: "wheels that start anyhow",
        ROLLS: "wheels that roll at first",
    }
    most = max(0.2, *(row["exponent"] for row in rows))
    norm = TwoSlopeNorm(0.0, -1.0, most)
    for axes, start in zip(panels, titles, strict=True):
        own = [row for row in rows if row["start"] == start]
        ks, taus = sorted({row["k"] for row in own}), sorted({row["tau"] for row in own})
        values = np.full((len(taus), len(ks)), np.nan)
        for row in own:
            values[taus.index(row["tau"]), ks.index(row["k"])] = row["exponent"]
        extent = (0.0, ks[-1] + ks[0], 0.0, taus[-1] + taus[0])
        image = axes.imshow(
            values, origin="lower", aspect="auto", extent=extent, cmap="PuOr_r", norm=norm
        )
        axes.plot(
            constants["k"],
            constants["tau"],
            marker="*",
            color="white",
            markeredgecolor="black",
            markersize=15,
        )
        axes.set_xlabel("spring constant $k$")
        axes.set_title(titles[start], fontsize=13, loc="left")
    panels[0].set_ylabel(r"time constant $\tau$ (s)")
    bar = figure.colorbar(image, ax=panels, pad=0.02, extend="min")
    bar.set_label(r"$\lambda_1$ (1/s); $\bigstar$: the point above")
