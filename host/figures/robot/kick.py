"""The paper's timeline of a kick (fig. kick_control_timeline).

Potentials and torque of both wheels, and below how fast they turn.
"""

from __future__ import annotations

from math import isnan, nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from host.figures.caption import of_log
from host.figures.style import SIZE, save, styled
from host.kicking.robot_claims import STALL_TORQUE
from host.logs.curves import curves
from host.logs.log import Log
from host.logs.tap import Event
from robot.kicks import WHEELS

# What to show of one kick: two turns of the wheels before it, and enough time after it to settle.
KICK_WINDOW_S = (-1.0, 2.0)

# The colours of the paper's figure.
_POTENTIALS = {"left": ("saddlebrown", "darkorange"), "right": ("mediumblue", "deepskyblue")}
# Wheels differ without colour, too.
LINE: Any = {"left": "-", "right": (0, (4, 1))}
_WHEEL = {"left": "black", "right": "grey"}
_WIDTH = {"left": 4.2, "right": 2.0}  # so that both show where they agree
_KICK = "crimson"
_PLATE: Any = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1}


class Span(NamedTuple):
    """A kick as it acted: from when to when (s of the robot's clock), and its name."""

    begin_s: float
    end_s: float
    label: str


def spans(log: Log, begin: int = 0) -> list[Span]:
    """The kicks that acted from record number `begin` on, each until it ended or was stopped."""
    found = []
    for row, kick in log.kicks():
        after = row
        while (
            after < len(log)
            and log.records[after].kick
            and log.records[after].tick < kick["begin"] + kick["ticks"]
        ):
            after += 1
        if begin <= row < after:
            last = log.records[after - 1]
            end_s = log.records[after].t_s if after < len(log) else last.t_s + last.dt_s
            found.append(Span(log.records[row].t_s, end_s, kick_words(kick)))
    return found


def kick_words(kick: Event) -> str:
    """A kick's name, as in 'phase kick, 4 ticks, left wheel'."""
    ticks = f"{kick['ticks']} tick{'s' if kick['ticks'] > 1 else ''}"
    wheel = "" if len(kick["wheels"]) > 1 else f", {kick['wheels'][0]} wheel"
    return f"{kick['mode']} kick, {ticks}{wheel}"


def draw(
    log: Log,
    path: str | Path,
    title: str,
    window: tuple[float, float] | None = None,
    zero_tick: int | None = None,
) -> Path:
    """Draw a log as a PNG. After a restart of the robot, only the rest is drawn.

    Args:
        log: the log.
        path: the file; a file that is there already is replaced.
        title: title of the figure.
        window: from when to when (s) to draw, in the figure's time; None for all of the log.
        zero_tick: the tick that begins at time 0; by default the first of the first kick, or of the
            log if it has no kick.

    Raises:
        ValueError: The log has no ticks, or not that one.
    """
    log = log.until_now()
    begin = max([0, *log.restarts()])
    if begin >= len(log):
        raise ValueError("there are no ticks in the log to draw")
    kicks = spans(log, begin)
    zero_s = kicks[0].begin_s if kicks else log.records[begin].t_s
    if zero_tick is not None:
        zero_s = next(
            (record.t_s for record in log.records[begin:] if record.tick == zero_tick), nan
        )
        if isnan(zero_s):
            raise ValueError(f"tick {zero_tick} is not in the log")
    first_s, last_s = log.records[begin].t_s - zero_s, log.records[-1].t_s - zero_s
    if window is not None:
        first_s, last_s = max(first_s, window[0]), min(last_s, window[1])
    inside = [Span(span.begin_s - zero_s, span.end_s - zero_s, span.label) for span in kicks]
    inside = [span for span in inside if span.begin_s <= last_s and span.end_s >= first_s]
    with styled():
        figure = Figure(**SIZE)
        neurons, speeds = figure.subplots(2, 1, sharex=True, height_ratios=(5, 2))
        figure.suptitle(title, fontsize=16)
        _draw_neurons(neurons, log, begin, zero_s)
        _draw_speeds(speeds, log, begin, zero_s)
        for axes in (neurons, speeds):
            for span in inside:
                axes.axvspan(span.begin_s, span.end_s, color=_KICK, alpha=0.3, linewidth=0)
                axes.axvline(span.begin_s, color=_KICK, linewidth=1.2)
        _name(neurons, inside, first_s, last_s)
        speeds.set_xlim(first_s, last_s)
        speeds.set_xlabel("time since the kick (s)" if kicks else "time (s)")
        figure.align_ylabels()
    return save(figure, path, of_log(curves(log.stream()).params, log.info, title))


def _line(
    axes: Axes, log: Log, begin: int, zero_s: float, values: NDArray[Any], **style: Any
) -> None:
    """A curve over time, broken where ticks are missing."""
    breaks = np.flatnonzero(np.diff(log.column("tick")[begin:]) != 1) + 1
    t = log.column("t_s")[begin:] - zero_s
    axes.plot(np.insert(t, breaks, np.nan), np.insert(values[begin:], breaks, np.nan), **style)


def _draw_neurons(axes: Axes, log: Log, begin: int, zero_s: float) -> None:
    axes.axhspan(
        -STALL_TORQUE,
        STALL_TORQUE,
        color="lightgrey",
        alpha=0.6,
        linewidth=0,
        label=f"$|M| < {STALL_TORQUE:g}$: stall",
    )
    for side in WHEELS:
        for number, color in enumerate(_POTENTIALS[side], 1):
            _line(
                axes,
                log,
                begin,
                zero_s,
                log.column(f"{side}_x{number}"),
                color=color,
                linestyle=LINE[side],
                drawstyle="steps-post",
                label=f"$x_{number}$ {side}",
            )
    for side in WHEELS:
        style: Any = {
            "color": _WHEEL[side],
            "linewidth": _WIDTH[side],
            "drawstyle": "steps-post",
            "label": f"$M$ {side}",
        }
        _line(axes, log, begin, zero_s, log.column(side + "_torque"), **style)
    axes.set_ylabel("potentials $x$, torque $M$")
    axes.set_yticks((-1, -0.5, 0, 0.5, 1))


def _draw_speeds(axes: Axes, log: Log, begin: int, zero_s: float) -> None:
    axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    for side in WHEELS:
        _line(
            axes,
            log,
            begin,
            zero_s,
            log.omega(side) / (2 * np.pi),
            color=_WHEEL[side],
            linewidth=_WIDTH[side],
            label=side,
        )
    axes.legend(ncols=2, handlelength=1.4)
    axes.set_ylabel("speed\n$\\omega/2\\pi$ (Hz)")


def _name(axes: Axes, kicks: list[Span], first_s: float, last_s: float) -> None:
    """Name the kicks above the curves, in lines that avoid overlap, and put the legend on top."""
    character_s = (last_s - first_s) / 105
    line_ends: list[float] = []
    for span in kicks:
        width_s = character_s * len(span.label)
        fits = span.begin_s + width_s <= last_s
        left_s = span.begin_s if fits else span.begin_s - width_s
        level = next(
            (level for level, end_s in enumerate(line_ends) if end_s <= left_s), len(line_ends)
        )
        line_ends[level : level + 1] = [left_s + width_s]
        place: Any = (
            {"ha": "left", "xytext": (5, 0)} if fits else {"ha": "right", "xytext": (-5, 0)}
        )
        spot = (span.end_s if fits else span.begin_s, 1.22 + 0.2 * level)
        axes.annotate(
            span.label,
            spot,
            textcoords="offset points",
            va="center",
            color=_KICK,
            bbox=_PLATE,
            **place,
        )
    axes.set_ylim(-1.15, 1.15 + 0.2 * len(line_ends))
    axes.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=7,
        columnspacing=1.2,
        handlelength=1.4,
        handletextpad=0.5,
    )
