"""What a tick does: thresholds in k, growth of a small swing, speed of rolling, and latency."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings
from host.theory.studies.tick import RUNNING_K
from host.theory.studies.tick_report import Numbers
from host.theory.studies.tick_rows import (
    CONTINUOUS,
    NEW,
    OLD,
    ORDERS,
    Continuous,
    LatencyRow,
    Order,
    TickRow,
    TickStudyRow,
    growth_of,
    motions,
    over_latencies,
    over_ticks,
)

PANELS = ("thresholds", "growth", "speed", "latency")

Part = Literal["tick", "latency"]
Threshold = Literal["k_c", "k_rolls", "k_stops"]
Column = Literal[Threshold, "hz"]

_COLOUR: dict[Order | Continuous, str] = {NEW: COLOURS[0], OLD: COLOURS[1], CONTINUOUS: "black"}
# The older order is thinner, so that it stands out without colours, too.
_WIDTH: dict[Order | Continuous, float] = {NEW: 2.6, OLD: 1.2, CONTINUOUS: 1.8}
_LINE: dict[Column, tuple[str, str]] = {
    "k_c": ("-", "rest ends"),
    "k_rolls": ("--", "rolling begins"),
    "k_stops": ("-.", "rolling ends"),
    "hz": ("-", ""),
}
_NAME: dict[Order | Continuous, str] = {
    NEW: "step first, act on new $x$ (robot)",
    OLD: "act on $x$ of the tick before",
    CONTINUOUS: "continuous model",
}


def draw(rows: list[TickStudyRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    tick_ms, latency_ms = 1000 * numbers["tick_s"], 1000 * numbers["latency_s"]
    with styled():
        figure = Figure(**SIZE)
        (lines, growth), (speed, latency) = figure.subplots(2, 2)
        _draw_against(lines, rows, "tick", _names(rows), tick_ms)
        lines.plot(0, numbers["k_hopf"], "ko", markersize=5, clip_on=False)
        if numbers["continuous"]["k_rolls"]:
            lines.plot(0, numbers["continuous"]["k_rolls"], "ko", markersize=5, clip_on=False)
        lines.axhline(
            numbers["k_estimate"], color="grey", linestyle=":", label=r"paper's $2f/(a\tau)$"
        )
        lines.set(
            xlabel="length of the tick (ms)",
            ylabel="spring constant $k$",
            title="where rest ends, and rolling begins",
        )
        _draw_growth(growth, rows)
        growth.set(
            xlabel="spring constant $k$",
            ylabel="growth of a\nsmall swing (1/s)",
            title=f"at a tick of {tick_ms:g} ms",
        )
        _draw_against(speed, rows, "tick", ("hz",), tick_ms)
        if numbers["continuous"]["hz"]:
            speed.axhline(numbers["continuous"]["hz"], color="black")
        speed.set(
            xlabel="length of the tick (ms)",
            ylabel=r"$\omega/2\pi$ (Hz)",
            title=f"how fast a wheel rolls at $k$ = {RUNNING_K:g}",
        )
        _draw_against(latency, rows, "latency", _names(rows), latency_ms)
        latency.axhline(numbers["k_hopf"], color="black")
        latency.set(
            xlabel="latency (ms)",
            ylabel="spring constant $k$",
            title=f"latency within a tick of {tick_ms:g} ms",
        )
        for axes in (lines, growth, speed, latency):
            axes.title.set_fontsize(13)
            axes.margins(x=0.02)
        share_legend(
            figure,
            (lines, growth),
            loc="outside lower center",
            ncols=3,
            fontsize=11,
            columnspacing=1.4,
        )
        figure.suptitle(_headline(numbers), fontsize=16)
    return figure


def _headline(numbers: Numbers) -> str:
    shifts = [numbers[order]["shift_pct"] for order in ORDERS]
    if None in shifts:
        return f"A tick of {1000 * numbers['tick_s']:g} ms is too long for these neurons"
    new, old = (f"{shift:+.1f} %".replace("-", "\u2212") for shift in shifts)
    return (
        f"A tick of {1000 * numbers['tick_s']:g} ms moves $k_c$ by {new} or {old}, by the order"
        " within it"
    )


def _names(rows: list[TickStudyRow]) -> tuple[Threshold, ...]:
    """The thresholds to draw: where rolling ends only if it is not where it begins."""
    for row in motions(rows):
        begins, ends = row["k_rolls"], row["k_stops"]
        if begins and ends and abs(begins / ends - 1) > 1e-3:
            return ("k_c", "k_rolls", "k_stops")
    return ("k_c", "k_rolls")


def _along(
    rows: list[TickStudyRow], part: Part, order: Order
) -> list[tuple[float, TickRow | LatencyRow]]:
    """The rows over ticks or latencies, each with its place on the axis in ms."""
    if part == "tick":
        return [(1000 * row["tick_s"], row) for row in over_ticks(rows, order)]
    return [(1000 * row["latency_s"], row) for row in over_latencies(rows, order)]


def _draw_against(
    axes: Axes, rows: list[TickStudyRow], part: Part, columns: tuple[Column, ...], here_ms: float
) -> None:
    for order in ORDERS:
        own = _along(rows, part, order)
        for column in columns:
            style, words = _LINE[column]
            values = [row[column] for _, row in own]
            axes.plot(
                [at_ms for at_ms, _ in own],
                np.array(values, dtype=float),
                style,
                color=_COLOUR[order],
                linewidth=_WIDTH[order],
                label=f"{words}: {_NAME[order]}" if words else None,
            )
    axes.axvline(here_ms, color="lightgrey", linewidth=1.0, zorder=0)


def _draw_growth(axes: Axes, rows: list[TickStudyRow]) -> None:
    axes.axhline(0.0, color="lightgrey", linewidth=1.0, zorder=0)
    for order in (CONTINUOUS, *ORDERS):
        own = growth_of(rows, order)
        axes.plot(
            [row["k"] for row in own],
            [row["growth_per_s"] for row in own],
            color=_COLOUR[order],
            linewidth=_WIDTH[order],
            label=_NAME[order] if order == CONTINUOUS else None,
        )
