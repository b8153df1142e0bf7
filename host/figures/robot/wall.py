"""A robot at a wall: the torque M while it drives to and fro, and where a wall reverses it.

Maps show the share of hits that reverse it over the axles' stiffness and the floor's grip, the
width of the front, and the battery's voltage. The share of a field's hits scatters by chance: a
field is framed unless its 95 % interval says that fewer reverse than the claim asks for.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.wall import (
    AXLES,
    BATTERIES,
    BUMPERS,
    GRIPS,
    MAP_HITS,
    MAPS,
    RANGE,
    TARGET,
)
from host.experiments.robot.wall_rows import (
    ON_AXLES,
    PAPER,
    ROBOT,
    Condition,
    HitRow,
    SeriesRow,
    WallRow,
    count_bounces,
    hits_under,
    series_under,
)
from host.figures.heat_map import draw_heat_map
from host.figures.style import COLOURS, SIZE, styled
from host.kicking.robot_claims import STALL_TORQUE
from host.runs.contract import Findings
from host.util.intervals import wilson


class Plane(NamedTuple):
    """A map: what it varies upward, its values and label, and those that a source gives or assumes.

    Attributes:
        title: Where in the other dimensions the map lies.
    """

    name: str
    values: tuple[float, ...]
    label: str
    known: tuple[float, float]
    title: str


_GRIPS = f"grip {ON_AXLES['grip']:g}"
_FRONT = f"front {ON_AXLES['bumper']:g} m"
_BATTERY = f"{ROBOT['battery_voltage']:g} V"
_PLANES = (
    Plane("grip", GRIPS, "grip of the tyres (1)", (1.34, 1.83), f"{_FRONT}, {_BATTERY}"),
    Plane(
        "bumper",
        BUMPERS,
        "width of the front (m)",
        (ROBOT["body_width"],) * 2,
        f"{_GRIPS}, {_BATTERY}",
    ),
    Plane(
        "battery_v",
        BATTERIES,
        "battery (V)",
        (ROBOT["battery_voltage"],) * 2,
        f"{_GRIPS}, {_FRONT}",
    ),
)
_SHOWN = (
    (PAPER, "rigid axles"),
    (ON_AXLES, f"axles of {ON_AXLES['axle']:g} N/m"),
)
_REGION: Any = {"color": COLOURS[1], "linewidth": 3.5, "solid_capstyle": "projecting"}
_KNOWN: Any = {"color": COLOURS[2], "linewidth": 6, "clip_on": False, "solid_capstyle": "butt"}


def panels(options: Mapping[str, Any]) -> list[str]:
    """The names of the panels: of a simulated robot, and then of another one."""
    torques = [f"torque-{place + 1}" for place in range(len(_SHOWN))]
    return [*torques, *(plane.name for plane in _PLANES), "hits"]


def draw(rows: list[WallRow], findings: Findings) -> Figure:
    """Draw series and maps of simulated rows, or the hits alone of a robot's rows."""
    simulated = bool(series_under(rows, PAPER))
    with styled():
        figure = Figure(**SIZE)
        hits = hits_under(rows, PAPER) or hits_under(rows, ON_AXLES)
        title = f"A wall reverses the robot ($k$ = {rows[0]['k']:g}) in {_words(hits)} hits"
        if simulated:
            title += f", and on soft axles in {_words(hits_under(rows, ON_AXLES))}"
        figure.suptitle(title, fontsize=17)
        if simulated:
            _draw_simulated(figure, rows)
        else:
            _draw_hits(figure.add_subplot(label="hits"), hits)
    return figure


def _words(hits: list[HitRow]) -> str:
    done, tried = count_bounces(hits)
    return f"{done} of {tried}"


def _draw_simulated(figure: Figure, rows: list[WallRow]) -> None:
    grid = figure.add_gridspec(2, 6, height_ratios=(5, 11))
    series = [
        figure.add_subplot(grid[0, 3 * place : 3 * place + 3], label=f"torque-{place + 1}")
        for place in range(len(_SHOWN))
    ]
    for axes, (condition, words) in zip(series, _SHOWN, strict=True):
        _draw_series(axes, series_under(rows, condition), condition, words)
    series[0].set_ylabel("torque $M$")
    series[0].legend(ncols=4, fontsize=10, loc="upper right", handlelength=1.4, columnspacing=1.2)
    for place, plane in enumerate(_PLANES):
        axes = figure.add_subplot(grid[1, 2 * place : 2 * place + 2], label=plane.name)
        _draw_plane(axes, rows, plane)
    handles = [
        figure.axes[-1].plot([], [], **style, label=label)[0]
        for style, label in (
            (_REGION, f"{100 * TARGET:.0f} % lies in the 95 % interval of the {MAP_HITS} hits"),
            (
                _KNOWN,
                "known or assumed of this robot",
            ),
        )
    ]
    figure.legend(handles=handles, loc="outside lower left", ncols=2, fontsize=12)


def _draw_series(axes: Axes, ticks: list[SeriesRow], condition: Condition, words: str) -> None:
    t = [row["t_s"] for row in ticks]
    torques = {
        "left": [row["left_torque"] for row in ticks],
        "right": [row["right_torque"] for row in ticks],
    }
    bounced = [row["t_s"] for row in ticks if row["bounce"]]
    _draw_stall(axes)
    for number, time in enumerate(bounced):
        label = "reversal" if number == 0 else None
        axes.axvline(time, color=COLOURS[1], linewidth=1.6, zorder=0, label=label)
    for side, color, width in (("left", "black", 2.6), ("right", COLOURS[5], 1.4)):
        axes.plot(t, torques[side], color=color, linewidth=width, label=f"{side} wheel")
    count = f"{len(bounced)} reversal{'' if len(bounced) == 1 else 's'}"
    front = f"grip {condition['grip']:g}, front {condition['bumper']:g} m"
    axes.set_title(f"{words}, {front}: {count}", loc="left", fontsize=12)
    axes.set_xlabel("time (s)")
    axes.set_ylim(-1.1, 1.9)
    axes.set_yticks((-1, 0, 1))
    axes.set_xlim(0, t[-1])


def _draw_stall(axes: Axes) -> None:
    label = f"stall, $|M|<{STALL_TORQUE:g}$"
    axes.axhspan(-STALL_TORQUE, STALL_TORQUE, color="lightgrey", linewidth=0, zorder=0, label=label)


def _draw_plane(axes: Axes, rows: list[WallRow], plane: Plane) -> None:
    """Draw the share of hits that reversed the robot, each axle's in a column."""
    counts = [count_bounces(hits_under(rows, condition)) for condition in MAPS[plane.name]]
    shares = np.array([done / tried if tried else np.nan for done, tried in counts])
    table = shares.reshape(len(plane.values), len(AXLES))
    draw_heat_map(axes, 100 * table, 100.0, fontsize=11)
    reached = [bool(tried) and wilson(done, tried)[1] >= TARGET for done, tried in counts]
    _outline(axes, np.reshape(reached, table.shape))
    axes.set_title(f"reversed (%): {plane.title}", fontsize=12)
    stiffnesses = ["rigid" if axle is None else f"{axle:g}" for axle in AXLES]
    axes.set_xticks(np.arange(len(AXLES)) + 0.5, stiffnesses, rotation=40)
    axes.set_yticks(np.arange(len(plane.values)) + 0.5, [f"{value:g}" for value in plane.values])
    axes.set_xlabel("axles' stiffness at the rim (N/m)")
    axes.set_ylabel(plane.label)
    known = [place for place, axle in enumerate(AXLES) if axle and _within(axle, RANGE)]
    axes.plot((known[0], known[-1] + 1), (0, 0), **_KNOWN)
    known = [place for place, value in enumerate(plane.values) if _within(value, plane.known)]
    axes.plot((0, 0), (known[0], known[-1] + 1), **_KNOWN)


def _within(value: float, bounds: tuple[float, float]) -> bool:
    """Whether bounds that are known to some per cent hold a value."""
    return 0.99 * bounds[0] <= value <= 1.01 * bounds[1]


def _outline(axes: Axes, inside: Any) -> None:
    """Draw the border of the fields that are inside."""
    padded = np.pad(inside, 1)
    for row, column in np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1]):
        axes.plot((column, column + 1), (row, row), **_REGION)
    for row, column in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1]):
        axes.plot((column, column), (row, row + 1), **_REGION)


def _draw_hits(axes: Axes, hits: list[HitRow]) -> None:
    """Draw M before and after each hit at which the wall was felt."""
    _draw_stall(axes)
    numbers = np.arange(1, len(hits) + 1)
    before = np.array([row["before"] for row in hits], dtype=float)
    after = np.array([row["after"] for row in hits], dtype=float)
    axes.plot(numbers, before, "o", color="black", label="before the wall")
    axes.plot(numbers, after, "s", color=COLOURS[1], label="after the wall")
    axes.set_xlabel("hit")
    axes.set_ylabel("torque $M$, mean of both wheels")
    axes.set_ylim(-1.1, 1.1)
    axes.legend(ncols=2)
