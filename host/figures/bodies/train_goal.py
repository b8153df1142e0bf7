"""Trains that are kicked to goals.

Their paths from above, beside trains kicked by chance, and how many have arrived when.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from host.bodies.steering import KICK_S, LEFT, LOOK_S, RIGHT
from host.experiments.bodies.train_goal import LIMIT_S, PLANNED, RANDOM, REACHED_M, WAYS
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row

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
# Which goals are shown, the first ones, and how far (m) along and across the start.
_ACROSS, _DOWN, _SEEN_M = 3, 2, (6.2, 7.4)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    by_way = {way: [row for row in rows if row["way"] == way] for way in WAYS}
    shown = _ACROSS * _DOWN
    with styled():
        figure = Figure(**SIZE)
        halves: Any = figure.subfigures(1, 2, width_ratios=(1.6, 1.0))
        left, right = halves
        panels = left.subplots(_DOWN, _ACROSS, sharex=True, sharey=True)
        for axes, planned, by_chance in zip(
            panels.flat, by_way[PLANNED][:shown], by_way[RANDOM][:shown], strict=False
        ):
            _draw_paths(axes, planned, by_chance)
        for axes in panels.flat[len(by_way[PLANNED]) :]:
            axes.set_axis_off()
        left.supxlabel("ahead of the train at first (m)", fontsize=13)
        left.supylabel("to its left (m)", fontsize=13)
        axes = right.subplots()
        for way, own in by_way.items():
            _draw_share(axes, own, way)
        axes.set(xlabel="time (s)", ylabel="goals reached (%)", xlim=(0, LIMIT_S), ylim=(-3, 103))
        figure.legend(handles=_legend(), loc="outside lower center", ncols=4, fontsize=11)
        counts = {entry["way"]: entry for entry in findings.numbers["ways"]}
        words = ", ".join(f"{way} {counts[way]['reached']}" for way in WAYS)
        figure.suptitle(
            f"Of {len(by_way[PLANNED])} goals 3 m away a train reaches, by {words}", fontsize=15
        )
    return figure


def _draw_paths(axes: Any, planned: Row, by_chance: Row) -> None:
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
    axes.add_patch(Circle(planned["goal_m"], REACHED_M, **_GOAL, zorder=4))
    for side, seen_m in zip("xy", _SEEN_M, strict=True):
        axes.set(**{side + "lim": (-seen_m, seen_m), side + "ticks": (-5, 0, 5)}, aspect="equal")
    reached = planned["reached_s"]
    axes.set_title(
        (
            f"missed, {planned['nearest_m']:.2f} m"
            if reached is None
            else f"there after {reached:.1f} s"
        ),
        fontsize=12,
    )


def _course(row: Row) -> Any:
    """A course until it is at the goal."""
    course = np.array(row["course"])
    return course if row["reached_s"] is None else course[: round(row["reached_s"] / LOOK_S) + 1]


def _draw_share(axes: Any, own: list[Row], way: str) -> None:
    times = sorted(row["reached_s"] for row in own if row["reached_s"] is not None)
    shares = 100 * np.arange(len(times) + 1) / len(own)
    axes.step([0.0, *times, LIMIT_S], [*shares, shares[-1]], where="post", **_LOOKS[way])


def _legend() -> list[Line2D]:
    return [
        *(Line2D([], [], **look, label=way) for way, look in _LOOKS.items()),
        Line2D([], [], marker=">", markersize=9, color="black", linestyle="none", label="start"),
        *(
            Line2D([], [], marker=marker, color=colour, linestyle="none", label=label)
            for marker, colour, label in _MARKS.values()
        ),
        Line2D(
            [],
            [],
            marker="o",
            markersize=10,
            markerfacecolor=COLOURS[4],
            markeredgecolor="black",
            linestyle="none",
            label="goal",
        ),
    ]
