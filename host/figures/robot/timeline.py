"""One round of the three kicks as in the paper's timeline, each wheel in a panel of its own.

Beside it stands how far the wheels slipped and how long they took to settle.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.timeline import KICKS
from host.experiments.robot.timeline_rows import (
    TickRow,
    TimelineRow,
    kick_rows,
    settled_kicks,
    tick_rows,
)
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings
from robot.kicks import MEMBRANE, PHASE, POSITION, WHEELS

PANELS = (
    *(f"{mode}-{side}" for mode in KICKS for side in WHEELS),
    "slips",
    "settling",
)
# The colours of the paper's figure.
_STYLES: dict[str, dict[str, dict[str, Any]]] = {
    "left": {
        "left_x1": {"color": "saddlebrown", "label": "$x_1$ left"},
        "left_x2": {"color": "darkorange", "label": "$x_2$ left", "linestyle": "--"},
        "left_torque": {"color": "black", "linewidth": 3.0, "label": "$M$ left"},
    },
    "right": {
        "right_x1": {"color": "mediumblue", "label": "$x_1$ right"},
        "right_x2": {"color": "deepskyblue", "label": "$x_2$ right", "linestyle": "--"},
        "right_torque": {"color": "grey", "linewidth": 3.0, "label": "$M$ right"},
    },
}
_KICK = "crimson"
_MODES = {MEMBRANE: (COLOURS[0], "o"), POSITION: (COLOURS[1], "s"), PHASE: (COLOURS[2], "^")}


def draw(rows: list[TimelineRow], findings: Findings) -> Figure:
    """Draw the rows."""
    with styled():
        figure = Figure(**SIZE)
        halves = figure.add_gridspec(1, 2, width_ratios=(2.6, 1))
        courses: Any = (
            halves[0].subgridspec(len(KICKS), len(WHEELS)).subplots(sharex=True, sharey=True)
        )
        for panels, mode in zip(courses, KICKS, strict=True):
            for axes, side in zip(panels, WHEELS, strict=True):
                _draw_series(axes, tick_rows(rows, mode), side)
            ticks = max((row["ticks"] for row in kick_rows(rows, mode)), default=1)
            title = f"{mode} kicks, {ticks} tick{'s' if ticks > 1 else ''}"
            panels[0].set_title(title, loc="left", fontsize=12, pad=3)
        courses[1, 0].set_ylabel("potentials $x$, torque $M$")
        for axes in courses[-1]:
            axes.set_xlabel("time since the first kick (s)")
        below: Any = {"loc": "outside lower left", "ncols": 7, "columnspacing": 1.1}
        share_legend(figure, courses[0], fontsize=11, handlelength=1.6, **below)
        others = halves[1].subgridspec(2, 1)
        _draw_slips(figure.add_subplot(others[0]), rows)
        _draw_settling(figure.add_subplot(others[1]), rows)
        rounds = len({row["trial"] for row in rows})
        figure.suptitle(
            f"Three kicks, there and back: one of {rounds} rounds, and all of them", fontsize=16
        )
    return figure


def _draw_series(axes: Axes, ticks: list[TickRow], side: str) -> None:
    t = [row["t_s"] for row in ticks]
    for name, style in _STYLES[side].items():
        axes.plot(t, [row[name] for row in ticks], **{"linewidth": 1.5, **style})  # type: ignore[literal-required]
    labelled = False
    for row, after in pairwise(ticks):
        if row["kicked"]:
            axes.axvspan(
                row["t_s"],
                after["t_s"],
                color=_KICK,
                alpha=0.45,
                linewidth=0,
                label="" if labelled else "kick",
            )
            labelled = True
    axes.set_ylim(-1.25, 1.25)
    axes.margins(x=0)


def _draw_slips(axes: Axes, rows: list[TimelineRow]) -> None:
    """Draw each kick's slip against the relative phase before it, and the greatest drift."""
    for mode, (colour, marker) in _MODES.items():
        done = settled_kicks(kick_rows(rows, mode))
        before = np.degrees([kick.before_rad for kick in done])
        slips = np.degrees([kick.slip_rad for kick in done])
        axes.plot(before, slips, marker, color=colour, markersize=5, alpha=0.8, label=mode)
    drifts = [abs(kick.drift_rad) for kick in settled_kicks(kick_rows(rows))]
    drift = float(np.degrees(max(drifts, default=0.0)))
    axes.axhspan(-drift, drift, color="grey", alpha=0.3, linewidth=0, label="drift")
    axes.set(xlabel="relative phase before (°)", ylabel="phase slip (°)", xlim=(-180, 180))
    axes.set_xticks(range(-180, 181, 90))
    above: Any = {"loc": "lower center", "bbox_to_anchor": (0.45, 1.0), "ncols": 4}
    axes.legend(fontsize=10, columnspacing=0.6, handletextpad=0.1, handlelength=1.2, **above)


def _draw_settling(axes: Axes, rows: list[TimelineRow]) -> None:
    """Draw the slower wheel's settling times, a column of scattered points for each mode."""
    rng = np.random.default_rng(0)
    longest = 0.1
    for place, (mode, (colour, marker)) in enumerate(_MODES.items()):
        times = [kick.settling_s for kick in settled_kicks(kick_rows(rows, mode))]
        places = place + rng.uniform(-0.2, 0.2, len(times))
        axes.plot(places, times, marker, color=colour, markersize=5, alpha=0.8)
        longest = max([longest, *times])
    axes.set_xticks(range(len(_MODES)), list(_MODES), fontsize=11)
    axes.set(ylabel="settling time (s)", ylim=(0, 1.1 * longest), xlim=(-0.5, len(_MODES) - 0.5))
