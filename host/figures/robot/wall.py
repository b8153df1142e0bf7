"""A robot at a wall: the torque M while it bounces to and fro, and where it bounces.

Maps show the share of bounces over grip and k, over wall and bumper, and over the wheels' phases.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.wall import APARTS, BUMPERS, GRIPS, KS, STIFFNESSES
from host.experiments.robot.wall_rows import (
    PAPER,
    WITH_BUMPER,
    Condition,
    HitRow,
    SeriesRow,
    WallRow,
    count_bounces,
    hits_under,
    series_under,
)
from host.figures.heat_map import draw_heat_map
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings
from host.util.intervals import wilson


class Scale(NamedTuple):
    """An axis of a map: its values, its label, and a factor for the label's unit."""

    values: tuple[float, ...]
    label: str
    factor: float = 1.0


_SHOWN = ((PAPER, "the body's own width"), (WITH_BUMPER, "a wide, springy bumper"))
_OVER_K = Scale(KS, "$k$")
_OVER_GRIP = Scale(GRIPS, "grip of the tyres")
_OVER_BUMPER = Scale(BUMPERS, "width of the bumper (m)")
_OVER_STIFFNESS = Scale(STIFFNESSES, "stiffness of the wall (kN/m)", 0.001)
_TALL = {**SIZE, "figsize": (10.0, 9.6)}


def draw(rows: list[WallRow], findings: Findings) -> Figure:
    """Draw series and maps of simulated rows, or the hits alone of a robot's rows."""
    claim = findings.claims[0]
    low, high = claim.interval or (0.0, 1.0)
    simulated = bool(series_under(rows, PAPER))
    with styled():
        figure = Figure(**(_TALL if simulated else SIZE))
        figure.suptitle(
            f"At the wall, $k$ = 2: {claim.measured:.0%} of the hits bounce (95 % interval"
            f" {low:.0%} to {high:.0%})",
            fontsize=16,
        )
        if simulated:
            _draw_simulated(figure, rows)
        else:
            _draw_hits(figure.subplots(), hits_under(rows, PAPER))
    return figure


def _draw_simulated(figure: Figure, rows: list[WallRow]) -> None:
    grid = figure.add_gridspec(3, 3, height_ratios=(5, 5, 9))
    series = [figure.add_subplot(grid[place, :]) for place in range(len(_SHOWN))]
    for axes, (condition, words) in zip(series, _SHOWN, strict=True):
        _draw_series(axes, series_under(rows, condition), condition, words)
    series[-1].set_xlabel("time (s)")
    style: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.97), "handlelength": 1.4}
    share_legend(series[0], series, ncols=3, fontsize=11, **style)

    def over_floor(k: float, grip: float) -> Condition:
        return {**PAPER, "k": k, "grip": grip}

    def over_wall(bumper: float, stiffness: float) -> Condition:
        return {**PAPER, "bumper": bumper, "stiffness": stiffness}

    floor, wall, phases = (figure.add_subplot(grid[2, column]) for column in range(3))
    _draw_map(floor, rows, over_floor, _OVER_K, _OVER_GRIP)
    floor.set_title("bounced (%): floor and $k$", fontsize=12)
    _draw_map(wall, rows, over_wall, _OVER_BUMPER, _OVER_STIFFNESS)
    wall.set_title("bounced (%): body and wall", fontsize=12)
    _draw_apart(phases, rows)
    phases.set_title("bounced (%): phases", fontsize=12)


def _draw_series(axes: Axes, ticks: list[SeriesRow], condition: Condition, words: str) -> None:
    t = [row["t_s"] for row in ticks]
    torques = {
        "left": [row["left_torque"] for row in ticks],
        "right": [row["right_torque"] for row in ticks],
    }
    bounced = [row["t_s"] for row in ticks if row["bounce"]]
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    for number, time in enumerate(bounced):
        label = "bounce" if number == 0 else None
        axes.axvline(time, color=COLOURS[1], linewidth=1.6, zorder=0, label=label)
    for side, color, width in (("left", "black", 2.6), ("right", COLOURS[5], 1.4)):
        axes.plot(t, torques[side], color=color, linewidth=width, label=f"{side} wheel")
    count = f"{len(bounced)} bounce{'' if len(bounced) == 1 else 's'} in {t[-1]:.0f} s"
    axes.set_title(
        f"{words} ({condition['bumper']:g} m, {condition['stiffness'] / 1000:g} kN/m): {count}",
        loc="left",
        fontsize=12,
    )
    axes.set_ylabel("torque $M$")
    axes.set_ylim(-1.1, 1.1)
    axes.set_xlim(0, t[-1])


def _draw_map(
    axes: Axes,
    rows: list[WallRow],
    condition: Callable[[float, float], Condition],
    across: Scale,
    up: Scale,
) -> None:
    """Draw the share of hits that bounced under condition(x, y), for all x across and y up."""
    counts = [
        [count_bounces(hits_under(rows, condition(x, y))) for x in across.values] for y in up.values
    ]
    draw_heat_map(
        axes, [[_percent(count) for count in line] for line in counts], 100.0, fontsize=13
    )
    for axis, scale in ((axes.xaxis, across), (axes.yaxis, up)):
        labels = [f"{scale.factor * value:g}" for value in scale.values]
        axis.set_ticks(np.arange(len(labels)) + 0.5, labels)
        axis.set_label_text(scale.label)


def _percent(count: tuple[int, int]) -> float:
    done, tried = count
    return 100 * done / tried if tried else np.nan


def _draw_apart(axes: Axes, rows: list[WallRow]) -> None:
    counts = [count_bounces(hits_under(rows, {**PAPER, "apart": apart})) for apart in APARTS]
    shares = np.array([_percent(count) for count in counts])
    low, high = 100 * np.array([wilson(*count) for count in counts]).T
    errors = np.abs([shares - low, high - shares])
    axes.errorbar(APARTS, shares, errors, color=COLOURS[0], marker="o", capsize=4)
    axes.set_xlabel("between the wheels (rad)")
    axes.set_xticks(np.arange(5) * np.pi / 4, ["0", "π/4", "π/2", "3π/4", "π"])
    axes.set_ylim(0, 104)


def _draw_hits(axes: Axes, hits: list[HitRow]) -> None:
    """Draw M before and after each hit at which the wall was felt."""
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    numbers = np.arange(1, len(hits) + 1)
    before = np.array([row["before"] for row in hits], dtype=float)
    after = np.array([row["after"] for row in hits], dtype=float)
    axes.plot(numbers, before, "o", color="black", label="before the wall")
    axes.plot(numbers, after, "s", color=COLOURS[1], label="after the wall")
    axes.set_xlabel("hit")
    axes.set_ylabel("torque $M$, mean of both wheels")
    axes.set_ylim(-1.1, 1.1)
    axes.legend(ncols=2)
