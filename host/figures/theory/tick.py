"""What a tick does: the lines in k against its length, how a small swing grows, how fast a wheel rolls, and what latency adds."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row
from host.theory.studies.tick import CONTINUOUS, NEW, OLD, ORDERS, RUNNING_K, part_of

_COLOUR = {NEW: COLOURS[0], OLD: COLOURS[1], CONTINUOUS: "black"}
_LINE = {
    "k_c": ("-", "rest ends"),
    "k_rolls": ("--", "rolling begins"),
    "k_stops": ("-.", "rolling ends"),
}
_NAME = {
    NEW: "step first, act on new $x$ (robot)",
    OLD: "act on $x$ of the tick before",
    CONTINUOUS: "continuous model",
}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers = findings.numbers
    tick_ms, latency_ms = 1000 * numbers["tick_s"], 1000 * numbers["latency_s"]
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 7.4)})
        (lines, growth), (speed, latency) = figure.subplots(2, 2)
        _draw_against(lines, rows, "tick", _names(rows), tick_ms)
        lines.plot(0, numbers["k_hopf"], "ko", markersize=5, clip_on=False)
        if numbers[CONTINUOUS]["k_rolls"]:
            lines.plot(0, numbers[CONTINUOUS]["k_rolls"], "ko", markersize=5, clip_on=False)
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
            ylabel="growth of a small swing (1/s)",
            title=f"at a tick of {tick_ms:g} ms",
        )
        _draw_against(speed, rows, "tick", ("hz",), tick_ms)
        if numbers[CONTINUOUS]["hz"]:
            speed.axhline(numbers[CONTINUOUS]["hz"], color="black")
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
        handles: dict[str, Any] = {}
        for axes in (lines, growth):
            handles |= dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=3,
            fontsize=11,
            columnspacing=1.4,
        )
        figure.suptitle(_headline(numbers), fontsize=16)
    return figure


def _headline(numbers: dict[str, Any]) -> str:
    shifts = [numbers[order]["shift_pct"] for order in ORDERS]
    if None in shifts:
        return f"A tick of {1000 * numbers['tick_s']:g} ms is too long for these neurons"
    new, old = (f"{shift:+.1f} %".replace("-", "\u2212") for shift in shifts)
    return (
        f"A tick of {1000 * numbers['tick_s']:g} ms moves $k_c$ by {new} or {old}, by the order"
        " within it"
    )


def _names(rows: list[Row]) -> tuple[str, ...]:
    """The lines to draw; where rolling ends only if that is not where it begins."""
    known = [row for row in rows if row.get("k_rolls") and row["k_stops"]]
    apart = any(abs(row["k_rolls"] / row["k_stops"] - 1) > 1e-3 for row in known)
    return ("k_c", "k_rolls", "k_stops") if apart else ("k_c", "k_rolls")


def _draw_against(
    axes: Axes, rows: list[Row], part: str, names: tuple[str, ...], here_ms: float
) -> None:
    for order in ORDERS:
        own = [row for row in part_of(rows, part) if row["order"] == order]
        for name in names:
            line, words = _LINE.get(name, ("-", ""))
            values = [float("nan") if row[name] is None else row[name] for row in own]
            label = f"{words}: {_NAME[order]}" if name != "hz" else None
            axes.plot(
                [1000 * row[part + "_s"] for row in own],
                values,
                line,
                color=_COLOUR[order],
                label=label,
            )
    axes.axvline(here_ms, color="lightgrey", linewidth=1.0, zorder=0)


def _draw_growth(axes: Axes, rows: list[Row]) -> None:
    axes.axhline(0.0, color="lightgrey", linewidth=1.0, zorder=0)
    for order in (CONTINUOUS, *ORDERS):
        own = [row for row in part_of(rows, "growth") if row["order"] == order]
        label = _NAME[order] if order == CONTINUOUS else None
        axes.plot(
            [row["k"] for row in own],
            [row["growth_per_s"] for row in own],
            color=_COLOUR[order],
            label=label,
        )
