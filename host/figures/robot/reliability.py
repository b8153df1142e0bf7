"""How surely kicks reverse a wheel against their length, and how long reversed wheels settle."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.reliability import LENGTHS, Row, points, rate
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.util.intervals import wilson
from robot.kicks import MEMBRANE, PHASE, POSITION

PANELS = ("rates", "times")

_CURVES: tuple[tuple[str, str, bool | None], ...] = (
    ("position inverted", POSITION, None),
    ("phase shift, + if forward, \N{MINUS SIGN} if backward", PHASE, True),
    ("phase shift, \N{MINUS SIGN} if forward, + if backward", PHASE, False),
)
# Markers and colours as in the paper, which has the first two.
_STYLES = (("o", COLOURS[2]), ("^", COLOURS[1]), ("s", COLOURS[0]))


def draw(rows: list[Row], findings: Findings) -> Figure:
    """Draw the rows."""
    with styled():
        figure = Figure(**SIZE)
        rates, times = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        for index, (label, mode, named) in enumerate(_CURVES):
            _draw_rate(rates, rows, index, label, mode, named)
        done, tried = rate(points(rows, MEMBRANE, 1))
        rates.axhline(
            100 * done / tried, color="black", linestyle=":", label="membrane inverted (one tick)"
        )
        rates.set_ylabel("reversed (%)")
        rates.set_ylim(-4, 104)
        for index, (_, mode, named) in enumerate(_CURVES):
            _draw_times(times, rows, index, mode, named)
        times.set_ylabel("settling time (s)\nof reversed wheels")
        times.set_xlabel("length of the kick (ticks)")
        times.set_xticks(LENGTHS)
        times.set_ylim(bottom=0)
        times.legend(*rates.get_legend_handles_labels(), loc="lower right", ncols=2, fontsize=11)
        kicks = [(mode, ticks, named) for _, mode, named in _CURVES for ticks in LENGTHS]
        trials = max(len(points(rows, *kick)) for kick in kicks)
        figure.suptitle(
            f"Which kicks reverse a wheel: {trials} trials a point, with 95 % intervals",
            fontsize=16,
        )
    return figure


def _draw_rate(
    axes: Axes, rows: list[Row], index: int, label: str, mode: str, named: bool | None
) -> None:
    counts = [rate(points(rows, mode, ticks, named)) for ticks in LENGTHS]
    shares = np.array([100 * done / tried if tried else np.nan for done, tried in counts])
    low, high = 100 * np.array([wilson(*count) for count in counts]).T
    errors = np.abs([shares - low, high - shares])
    place = np.array(LENGTHS) + 0.08 * (index - 1)
    marker, colour = _STYLES[index]
    axes.errorbar(place, shares, errors, color=colour, marker=marker, capsize=4, label=label)


def _draw_times(axes: Axes, rows: list[Row], index: int, mode: str, named: bool | None) -> None:
    """Draw median and quartiles of the settling times."""
    marker, colour = _STYLES[index]
    for ticks in LENGTHS:
        times = [
            row["settling_s"]
            for row in points(rows, mode, ticks, named)
            if row["reversed"] and row["settling_s"] is not None
        ]
        if times:
            low, median, high = np.quantile(times, (0.25, 0.5, 0.75))
            bars = [[median - low], [high - median]]
            place = ticks + 0.08 * (index - 1)
            axes.errorbar(place, median, bars, color=colour, marker=marker, capsize=4)
