"""What kicks do to a running train.

Reversed, stopped, or slowed down, over the number of wheels and the kick's length.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from host.experiments.bodies.train_kick import BRAKED, LENGTHS_S, MIXED, ON, REVERSED, STOPS, WHEELS
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row
from robot.kicks import MEMBRANE, POSITION

_COLOURS = {REVERSED: COLOURS[0], ON: COLOURS[5], STOPS: "#999999", MIXED: COLOURS[4]}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    kicks = {
        (kick["mode"], kick["wheels"], kick["seconds"]): kick for kick in findings.numbers["kicks"]
    }
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 9.0)})
        (reversed_, stopped), (braked, speeds) = figure.subplots(2, 2)
        _draw_map(reversed_, kicks, REVERSED, "reversed (%)")
        _draw_map(stopped, kicks, STOPS, "stopped for good (%)")
        _draw_braked(braked, rows)
        _draw_speeds(speeds, rows)
        inverted = [kick for (mode, _, _), kick in kicks.items() if mode == MEMBRANE]
        words = (
            f"{sum(kick['reversed'] for kick in inverted)} of"
            f" {sum(kick['trials'] for kick in inverted)}"
        )
        figure.suptitle(
            f"Kicking some of a running train's wheels ({findings.numbers['preset']}); membrane"
            f" inversion reversed {words}",
            fontsize=14,
        )
    return figure


def _draw_map(axes: Axes, kicks: dict[Any, dict[str, Any]], outcome: str, title: str) -> None:
    table = np.array(
        [
            [_percent(kicks[POSITION, wheels, seconds], outcome) for seconds in LENGTHS_S]
            for wheels in WHEELS
        ]
    )
    axes.pcolormesh(table, cmap="cividis", vmin=0, vmax=100, edgecolors="white", linewidth=1)
    for (row, column), share in np.ndenumerate(table):
        axes.text(
            column + 0.5,
            row + 0.5,
            f"{share:.0f}",
            ha="center",
            va="center",
            color="black" if share > 60 else "white",
            fontsize=11,
        )
    axes.set_xticks(
        np.arange(len(LENGTHS_S)) + 0.5, [f"{seconds:g}" for seconds in LENGTHS_S], fontsize=11
    )
    axes.set_yticks(np.arange(len(WHEELS)) + 0.5, [str(wheels) for wheels in WHEELS])
    axes.set(xlabel="length of the position inversion (s)", ylabel="wheels kicked")
    axes.set_title(title, fontsize=13)


def _percent(kick: dict[str, Any], outcome: str) -> float:
    return float(100 * kick["outcomes"].get(outcome, 0) / kick["trials"])


def _draw_braked(axes: Axes, rows: list[Row]) -> None:
    """What becomes of a train that a position inversion has braked, whatever its length, by the number of wheels."""
    braked = [
        row
        for row in rows
        if row["mode"] == POSITION and abs(row["end_rad_s"]) < BRAKED * abs(row["before_rad_s"])
    ]
    counts = [
        [
            sum((row["wheels"], row["outcome"]) == (wheels, outcome) for row in braked)
            for outcome in _COLOURS
        ]
        for wheels in WHEELS
    ]
    below = np.zeros(len(WHEELS))
    for share, (outcome, colour) in zip(_shares(counts).T, _COLOURS.items(), strict=True):
        axes.bar(WHEELS, share, bottom=below, color=colour, label=outcome)
        below += share
    for wheels, own in zip(WHEELS, counts, strict=True):
        axes.text(wheels, 101, f"{sum(own)}", ha="center", fontsize=11)
    axes.set(
        xlabel="wheels kicked",
        ylabel="of the trials that it brakes (%)",
        xticks=WHEELS,
        ylim=(0, 112),
    )
    axes.set_title(f"braked below {BRAKED:.0%} of its speed: then", fontsize=13)


def _shares(counts: list[list[int]]) -> NDArray[np.float64]:
    table = np.array(counts, dtype=float)
    return np.asarray(100 * table / np.maximum(table.sum(axis=1, keepdims=True), 1))


def _draw_speeds(axes: Axes, rows: list[Row]) -> None:
    """How fast the train still is when a kick ends, and what became of it."""
    own = [row for row in rows if row["mode"] == POSITION]
    for outcome, colour in _COLOURS.items():
        found = [row for row in own if row["outcome"] == outcome]
        ends = [row["end_rad_s"] * np.sign(row["before_rad_s"]) for row in found]
        places = [row["seconds"] * (2 * row["wheels"] - 10) / 10 for row in found]
        axes.plot(places, ends, "o", color=colour, label=outcome, markersize=5, alpha=0.8)
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    axes.set(
        xlabel=r"length $\times$ (2 kicked $-$ 10)/10 (s)",
        ylabel=r"mean $\omega$ when the kick ends (rad/s)",
    )
    axes.legend(fontsize=11)
