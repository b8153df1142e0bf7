"""The four exponents at a point, with errors, and a time series of the torque."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.answers import Answer
from host.runs.contract import Findings
from host.theory.studies.lyapunov_numbers import Numbers
from host.theory.studies.lyapunov_rows import LyapunovRow, SeriesRow, series_of

PANELS = ("series", "exponents")

SHOWN_S = 40.0
# The axis of torques is at least so long, so that rest does not look like motion.
_LEAST = 0.1


def draw(rows: list[LyapunovRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        series, exponents = figure.subplots(2, 1, height_ratios=(1.2, 1.0))
        _draw_series(series, series_of(rows))
        _draw_exponents(exponents, numbers)
        figure.suptitle(_title(numbers), fontsize=16)
    return figure


def _title(numbers: Numbers) -> str:
    constants = numbers["constants"]
    where = f"$k$ = {constants['k']:g}, $\\tau$ = {constants['tau']:g} s"
    title = f"{where}: {numbers['verdict']}, dimension {numbers['dimension']:.2f}"
    point = numbers["point"]
    others = [
        f"{own['wheels'] / point['of_wheels']:.0%} of starts lead to another attractor: {name}"
        for name, own in list(point["attractors"].items())[1:]
    ]
    return "\n".join([title, *others])


def _draw_series(axes: Axes, series: list[SeriesRow]) -> None:
    shown = [row for row in series if row["t_s"] <= SHOWN_S]
    axes.plot(
        [row["t_s"] for row in shown], [row["force"] for row in shown], color="black", linewidth=1.3
    )
    axes.axhline(0.0, color="grey", linewidth=0.8)
    low, high = axes.get_ylim()
    axes.set(xlim=(0.0, SHOWN_S), ylim=(min(low, -_LEAST), max(high, _LEAST)))
    axes.set_xlabel("time (s)")
    axes.set_ylabel(r"torque $F_\mathrm{tan}$")


def _draw_exponents(axes: Axes, numbers: Numbers) -> None:
    """Each exponent with its 95 % interval, on an axis that is linear around 0."""
    values, errors = np.array(numbers["exponents"]), np.array(numbers["standard_errors"])
    names = [f"$\\lambda_{number}$" for number in range(1, 5)]
    for number, (value, error) in enumerate(zip(values, errors, strict=True)):
        colour = COLOURS[1] if value > 5 * error and value > 0.0 else COLOURS[0]
        axes.errorbar(number, value, 1.96 * error, fmt="o", color=colour, capsize=6, markersize=7)
        words = "  " + Answer("", float(value), float(error)).in_words()
        axes.annotate(words, (number, value), (8, 6), textcoords="offset points", fontsize=12)
    axes.axhline(0.0, color="grey", linewidth=0.8, zorder=0)
    axes.set_yscale("symlog", linthresh=0.1)
    axes.set_xlim(-0.4, 3.9)
    axes.set_ylim(2 * min(values.min(), -0.1), 3 * max(values.max(), 0.1))
    axes.set_xticks(range(4), names)
    axes.set_ylabel("exponent (1/s)")
