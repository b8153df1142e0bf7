"""What kicks do to a running train, over the number of kicked wheels and the kick's length."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_kick import (
    BRAKED,
    GOES_ON,
    LENGTHS_S,
    MIXED,
    REVERSED,
    STOPS,
    WHEELS,
    KickNumbers,
    Numbers,
    Row,
)
from host.figures.heat_map import draw_heat_map
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from robot.kicks import MEMBRANE, POSITION

PANELS = ("reversed", "stopped", "braked", "speeds")
# The colour, marker and hatch of each outcome.
_LOOKS = {
    REVERSED: (COLOURS[0], "o", ""),
    GOES_ON: (COLOURS[5], "^", ""),
    STOPS: ("#999999", "s", "//"),
    MIXED: (COLOURS[4], "D", "xx"),
}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    membrane = [kick for kick in numbers["kicks"] if kick["mode"] == MEMBRANE]
    position = [kick for kick in numbers["kicks"] if kick["mode"] == POSITION]
    with styled():
        figure = Figure(**SIZE)
        (reversed_, stopped), (braked, speeds) = figure.subplots(2, 2)
        _draw_map(reversed_, position, REVERSED, "reversed (%)")
        _draw_map(stopped, position, STOPS, "stopped for good (%)")
        _draw_braked(braked, rows)
        _draw_speeds(speeds, rows)
        done, tried = (
            sum(kick["reversed"] for kick in membrane),
            sum(kick["trials"] for kick in membrane),
        )
        figure.suptitle(
            f"Kicking some of a running train's wheels ({numbers['preset']}); membrane inversion"
            f" reversed {done} of {tried}",
            fontsize=14,
        )
    return figure


def _draw_map(axes: Axes, kicks: list[KickNumbers], outcome: str, title: str) -> None:
    percent = {
        (kick["wheels"], kick["seconds"]): 100 * kick["outcomes"].get(outcome, 0) / kick["trials"]
        for kick in kicks
    }
    table = [[percent[wheels, seconds] for seconds in LENGTHS_S] for wheels in WHEELS]
    draw_heat_map(axes, table, 100.0)
    lengths = [f"{seconds:g}" for seconds in LENGTHS_S]
    axes.set_xticks(np.arange(len(LENGTHS_S)) + 0.5, lengths, fontsize=11)
    axes.set_yticks(np.arange(len(WHEELS)) + 0.5, [str(wheels) for wheels in WHEELS])
    axes.set(xlabel="length of the position inversion (s)", ylabel="wheels kicked")
    axes.set_title(title, fontsize=13)


def _draw_braked(axes: Axes, rows: list[Row]) -> None:
    """Draw what becomes of trains that a position inversion of any length has braked."""
    braked = [
        row
        for row in rows
        if row["mode"] == POSITION and abs(row["end_rad_s"]) < BRAKED * abs(row["before_rad_s"])
    ]
    counts = {
        outcome: np.array(
            [
                sum((row["wheels"], row["outcome"]) == (wheels, outcome) for row in braked)
                for wheels in WHEELS
            ]
        )
        for outcome in _LOOKS
    }
    trials = np.array([sum(row["wheels"] == wheels for row in braked) for wheels in WHEELS])
    below = np.zeros(len(WHEELS))
    for outcome, (colour, _, hatch) in _LOOKS.items():
        share = 100 * counts[outcome] / np.maximum(trials, 1)
        axes.bar(WHEELS, share, bottom=below, color=colour, hatch=hatch, edgecolor="white")
        below += share
    for wheels, count in zip(WHEELS, trials, strict=True):
        axes.text(wheels, 101, f"{count}", ha="center", fontsize=11)
    axes.set(
        xlabel="wheels kicked",
        ylabel="outcomes (%)",
        xticks=WHEELS,
        ylim=(0, 112),
    )
    axes.set_title(f"once braked below {BRAKED:.0%} of its speed (top: trials)", fontsize=12)


def _draw_speeds(axes: Axes, rows: list[Row]) -> None:
    """Draw how fast the train still is when a kick ends, and what became of it.

    The more wheels are kicked, and the longer, the more it brakes: kicked wheels brake, others
    drive.
    """
    for outcome, (colour, marker, _) in _LOOKS.items():
        points = [
            (
                row["seconds"] * (2 * row["wheels"] - 10) / 10,
                row["end_rad_s"] * np.sign(row["before_rad_s"]),
            )
            for row in rows
            if row["seconds"] is not None and row["outcome"] == outcome
        ]
        axes.plot(
            [x for x, _ in points],
            [y for _, y in points],
            marker,
            color=colour,
            label=outcome if points else "",
            markersize=5,
            alpha=0.8,
        )
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    axes.set(
        xlabel=r"length $\times$ (2 kicked $-$ 10)/10 (s)",
        ylabel="mean $\\omega$ when\nthe kick ends (rad/s)",
    )
    axes.legend(fontsize=11)
