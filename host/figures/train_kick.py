"""What kicks do to a running train: reversed, stopped, or slowed down, over the number of wheels and the kick's length."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.experiment import Findings, Row
from host.experiments.train_kick import LENGTHS_S, REVERSED, STOPS, WHEELS
from host.figures.style import COLOURS, SIZE, styled
from robot.kicks import MEMBRANE, POSITION


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    kicks = {(kick["mode"], kick["wheels"], kick["seconds"]): kick for kick in findings.numbers["kicks"]}
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 9.0)})
        (reversed_, stopped), (shares, speeds) = figure.subplots(2, 2)
        _draw_map(reversed_, kicks, REVERSED, "reversed (%)")
        _draw_map(stopped, kicks, STOPS, "stopped for good (%)")
        _draw_shares(shares, kicks)
        _draw_speeds(speeds, rows)
        trials = findings.numbers["kicks"][0]["trials"]
        figure.suptitle(
            f"Kicking some of a running train's ten wheels ({findings.numbers['preset']}; {trials} trials of each kick)", fontsize=15
        )
    return figure


def _draw_map(axes: Axes, kicks: dict[Any, dict[str, Any]], outcome: str, title: str) -> None:
    table = np.array([[_percent(kicks[POSITION, wheels, seconds], outcome) for seconds in LENGTHS_S] for wheels in WHEELS])
    axes.pcolormesh(table, cmap="cividis", vmin=0, vmax=100, edgecolors="white", linewidth=1)
    for (row, column), share in np.ndenumerate(table):
        axes.text(column + 0.5, row + 0.5, f"{share:.0f}", ha="center", va="center", color="black" if share > 60 else "white", fontsize=11)
    axes.set_xticks(np.arange(len(LENGTHS_S)) + 0.5, [f"{seconds:g}" for seconds in LENGTHS_S], fontsize=11)
    axes.set_yticks(np.arange(len(WHEELS)) + 0.5, [str(wheels) for wheels in WHEELS])
    axes.set(xlabel="length of the position inversion (s)", ylabel="wheels kicked")
    axes.set_title(title, fontsize=13)


def _percent(kick: dict[str, Any], outcome: str) -> float:
    return float(100 * kick["outcomes"].get(outcome, 0) / kick["trials"])


def _draw_shares(axes: Axes, kicks: dict[Any, dict[str, Any]]) -> None:
    """Each number of wheels with the length that is best for it."""
    best = [max((kicks[POSITION, wheels, seconds] for seconds in LENGTHS_S), key=lambda kick: int(kick["reversed"])) for wheels in WHEELS]
    inverted = [kicks[MEMBRANE, wheels, None] for wheels in WHEELS]
    for number, (own, name) in enumerate(((best, "position, its best length"), (inverted, "membrane"))):
        share = np.array([kick["reversed"] / kick["trials"] for kick in own])
        low, high = np.array([kick["interval"] for kick in own]).T
        style: dict[str, Any] = {"color": COLOURS[number], "marker": "os"[number], "capsize": 4, "label": name}
        axes.errorbar(np.array(WHEELS) + 0.12 * number, 100 * share, 100 * np.abs([share - low, high - share]), **style)
    axes.set(xlabel="wheels kicked", ylabel="reversed (%)", ylim=(-3, 103), xticks=range(0, 11, 2))
    axes.legend(fontsize=11, loc="upper left")


def _draw_speeds(axes: Axes, rows: list[Row]) -> None:
    """How fast the train still is when a kick ends, of what it was, and what became of it."""
    own = [row for row in rows if row["mode"] == POSITION]
    for number, outcome in enumerate(dict.fromkeys(row["outcome"] for row in own)):
        found = [row for row in own if row["outcome"] == outcome]
        ends = [row["end_rad_s"] * np.sign(row["before_rad_s"]) for row in found]
        places = [row["seconds"] * (2 * row["wheels"] - 10) / 10 for row in found]
        axes.plot(places, ends, "os^D"[number], color=COLOURS[number], label=outcome, markersize=5, alpha=0.7)
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    axes.set(xlabel="length (s) times share of kicked less that of other wheels", ylabel=r"mean $\omega$ when the kick ends (rad/s)")
    axes.legend(fontsize=11)
