"""Which way wheels go when they are started: counts, how their share settles, what decides it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.starts import Numbers, Row
from host.figures.style import ABOVE, COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.util.intervals import wilson
from robot.kicks import WHEELS

PANELS = ("counts", "shares", "offsets")
# The name, colour and hatch of each way.
_WAYS = {
    1: ("forward", COLOURS[0], ""),
    -1: ("backward", COLOURS[1], "//"),
    0: ("at rest", "grey", ".."),
}
_LINES = ("-", "--")
_BINS_DEG = np.arange(-180, 181, 20)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """Draw the rows."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        places = figure.subplot_mosaic([["counts", "shares"], ["offsets", "offsets"]])
        _draw_counts(places["counts"], numbers)
        _draw_shares(places["shares"], rows)
        _draw_offsets(places["offsets"], rows)
        figure.suptitle(
            f"{numbers['starts']} starts from rest: which way the wheels go", fontsize=16
        )
    return figure


def _draw_counts(axes: Axes, numbers: Numbers) -> None:
    """How many went each way, by wheel, with 95 % intervals."""
    for index, side in enumerate(WHEELS):
        counts = numbers["left"] if side == "left" else numbers["right"]
        ways = {1: counts["forward"], -1: counts["backward"], 0: counts["rest"]}
        total = max(1, sum(ways.values()))
        for place, (way, number) in enumerate(ways.items()):
            low, high = (total * edge for edge in wilson(number, total))
            label, colour, hatch = _WAYS[way]
            axes.bar(
                index + 0.27 * (place - 1),
                number,
                0.25,
                yerr=[[number - low], [high - number]],
                capsize=4,
                color=colour,
                hatch=hatch,
                edgecolor="white",
                label=label if index == 0 else None,
            )
    axes.axhline(numbers["starts"] / 2, color="black", linestyle=":", label="a half")
    axes.set_xticks(range(len(WHEELS)), [f"{side} wheel" for side in WHEELS])
    axes.set_ylabel("starts (95 % intervals)")
    axes.set_ylim(0, 1.25 * max(1, numbers["starts"]))
    axes.legend(fontsize=11, ncols=2, loc="upper center")


def _draw_shares(axes: Axes, rows: list[Row]) -> None:
    """The share of forward among the wheels that moved, start after start."""
    longest = 1
    for side, colour, line in zip(WHEELS, COLOURS[2:], _LINES, strict=False):
        forward = np.array([row["direction"] == 1 for row in rows if _moved(row, side)])
        longest = max(longest, len(forward))
        starts = np.arange(1, len(forward) + 1)
        style: Any = {"color": colour, "linestyle": line, "marker": "o", "markersize": 3}
        axes.plot(starts, np.cumsum(forward) / starts, label=f"{side} wheel", **style)
    starts = np.arange(1, longest + 1)
    half = 1.96 * 0.5 / np.sqrt(starts)
    axes.fill_between(
        starts,
        np.maximum(0, 0.5 - half),
        np.minimum(1, 0.5 + half),
        color="lightgrey",
        linewidth=0,
        label="95 % if both are equally likely",
    )
    axes.set_ylim(0, 1)
    axes.set_xlabel("starts of wheels that moved")
    axes.set_ylabel("share of forward")
    axes.legend(fontsize=10, ncols=3, **ABOVE)


def _moved(row: Row, side: str) -> bool:
    return row["wheel"] == side and bool(row["direction"])


def _draw_offsets(axes: Axes, rows: list[Row]) -> None:
    """How many wheels went each way, by where they stood."""
    found = {
        way: np.array([row["ahead_deg"] for row in rows if row["direction"] == way])
        for way in _WAYS
    }
    offsets = {way: own for way, own in found.items() if len(own)}
    labels, colours, hatches = zip(*(_WAYS[way] for way in offsets), strict=True)
    style: Any = {"color": colours, "hatch": hatches, "label": labels, "edgecolor": "white"}
    axes.hist(list(offsets.values()), bins=_BINS_DEG.tolist(), stacked=True, rwidth=0.9, **style)
    axes.axvline(0, color="black", linestyle=":")
    axes.set_xticks(range(-180, 181, 45))
    axes.set_xlabel("the wheel stood ahead of the angle that its potentials remember (°)")
    axes.set_ylabel("wheels")
    axes.legend(fontsize=11)
