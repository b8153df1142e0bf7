"""Trains that are kicked to goals.

Their paths from above, beside trains with random kicks, and how many have arrived by when.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from host.bodies.steering import KICK_S, LEFT, LOOK_S, RIGHT, Array
from host.experiments.bodies.train_goal import (
    AWAY_M,
    LIMIT_S,
    PLANNED,
    RANDOM,
    REACHED_M,
    WAYS,
    Numbers,
    Row,
)
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings

_LOOKS: dict[str, dict[str, Any]] = {
    way: {"color": colour, "linestyle": dash}
    for way, colour, dash in zip(
        WAYS, (COLOURS[0], COLOURS[3], COLOURS[6]), ("-", "--", ":"), strict=True
    )
}
_MARKS = {
    LEFT: ("^", COLOURS[2], "kick to the left"),
    RIGHT: ("v", COLOURS[1], "kick to the right"),
}
_GOAL: Any = {"facecolor": COLOURS[4], "edgecolor": "black"}
# The first goals are shown, in columns and rows, and how far (m) ahead and to the left is seen.
_ACROSS, _DOWN = 3, 2
_SEEN_X_M, _SEEN_Y_M = 6.2, 7.4


def panels(options: Mapping[str, Any]) -> list[str]:
    """The names of the panels."""
    shown = min(_ACROSS * _DOWN, options["goals"])
    return [*(_goal_label(number) for number in range(1, shown + 1)), "reached"]


def _goal_label(number: int) -> str:
    return f"goal-{number}"


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    by_way = {way: [row for row in rows if row["way"] == way] for way in WAYS}
    shown = min(_ACROSS * _DOWN, len(by_way[PLANNED]))
    across = min(_ACROSS, shown)
    with styled():
        figure = Figure(**SIZE)
        halves = figure.add_gridspec(1, 2, width_ratios=(1.8, 1.0))
        panels: Any = (
            halves[0]
            .subgridspec(ceil(shown / across), across)
            .subplots(sharex=True, sharey=True, squeeze=False)
        )
        for number, axes in enumerate(panels.flat, start=1):
            axes.set_label(_goal_label(number))
        for axes, planned, by_chance in zip(
            panels.flat, by_way[PLANNED][:shown], by_way[RANDOM][:shown], strict=False
        ):
            _draw_paths(axes, planned, by_chance)
        for axes in panels.flat[shown:]:
            axes.set_axis_off()
        panels[-1, across // 2].set_xlabel("ahead of the train at the start (m)")
        panels[0, 0].set_ylabel("to its left (m)")
        axes = figure.add_subplot(halves[1], label="reached")
        for way, trips in by_way.items():
            _draw_share(axes, trips, way)
        axes.set(xlabel="time (s)", ylabel="goals reached (%)", xlim=(0, LIMIT_S), ylim=(-3, 103))
        figure.legend(handles=_legend(), loc="outside lower center", ncols=4, fontsize=11)
        words = ", ".join(f"{entry['way']} {entry['reached']}" for entry in numbers["ways"])
        figure.suptitle(
            f"Goals {AWAY_M:g} m away that a train reaches, of {len(by_way[PLANNED])}: {words}",
            fontsize=15,
        )
    return figure


def _draw_paths(axes: Axes, planned: Row, by_chance: Row) -> None:
    for row, width in ((by_chance, 1.0), (planned, 1.8)):
        axes.plot(*_course(row)[:, :2].T, **_LOOKS[row["way"]], linewidth=width)
    course, every = _course(planned), round(KICK_S / LOOK_S)
    for choice, (marker, colour, _) in _MARKS.items():
        at = [
            number * every
            for number, chosen in enumerate(planned["choices"])
            if chosen == choice and number * every < len(course)
        ]
        axes.plot(
            *course[at, :2].T,
            marker=marker,
            markersize=4.5,
            color=colour,
            linestyle="none",
            zorder=3,
        )
    axes.plot(0, 0, marker=">", markersize=7, color="black", zorder=4)
    x, y = planned["goal_m"]
    axes.add_patch(Circle((x, y), REACHED_M, **_GOAL, zorder=4))
    axes.set(xlim=(-_SEEN_X_M, _SEEN_X_M), xticks=(-5, 0, 5), aspect="equal")
    axes.set(ylim=(-_SEEN_Y_M, _SEEN_Y_M), yticks=(-5, 0, 5))
    if planned["reached_s"] is None:
        axes.set_title(f"missed, {planned['nearest_m']:.2f} m", fontsize=12)
    else:
        axes.set_title(f"there after {planned['reached_s']:.1f} s", fontsize=12)


def _course(row: Row) -> Array:
    """A course until it is at the goal, (times, 3)."""
    course = np.array(row["course"])
    return course if row["reached_s"] is None else course[: round(row["reached_s"] / LOOK_S) + 1]


def _draw_share(axes: Axes, trips: list[Row], way: str) -> None:
    times = sorted(row["reached_s"] for row in trips if row["reached_s"] is not None)
    shares = 100 * np.arange(len(times) + 1) / len(trips)
    axes.step([0.0, *times, LIMIT_S], [*shares, shares[-1]], where="post", **_LOOKS[way])


def _legend() -> list[Line2D]:
    start: Any = {"marker": ">", "markersize": 9, "color": "black"}
    goal: Any = {
        "marker": "o",
        "markersize": 10,
        "markerfacecolor": _GOAL["facecolor"],
        "markeredgecolor": _GOAL["edgecolor"],
    }
    kicks = [
        Line2D([], [], linestyle="none", marker=marker, color=colour, label=label)
        for marker, colour, label in _MARKS.values()
    ]
    return [
        *(Line2D([], [], **look, label=way) for way, look in _LOOKS.items()),
        Line2D([], [], linestyle="none", **start, label="start"),
        *kicks,
        Line2D([], [], linestyle="none", **goal, label="goal"),
    ]
