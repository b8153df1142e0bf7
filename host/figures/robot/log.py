"""A whole log in one figure: angles, potentials and duty cycles, kicks and stops."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from host.figures.robot.kick import LINE, kick_words
from host.figures.style import COLOURS, SIZE, styled
from host.logs.curves import STOPS, Array, Curves
from robot.kicks import WHEELS

# More points of a curve than that cannot be told apart: each takes less than a pixel.
POINTS = 3000
# A figure names at most this many kicks; more names would cover each other.
NAMED_KICKS = 6
# Longer logs than this (s) are drawn over minutes.
MINUTES_S = 600.0
_KICK = "crimson"
_STOPS = {"stop": "black", "fault": COLOURS[4], "restart": "grey"}
_WHEEL = {"left": COLOURS[1], "right": COLOURS[0]}
_POTENTIALS = {"left": (COLOURS[1], COLOURS[4]), "right": (COLOURS[0], COLOURS[5])}


def draw(log: Curves, title: str) -> Figure:
    """Draw a log.

    Args:
        log: Its columns. It has at least one tick.
        title: The figure's title.

    Returns:
        The figure.
    """
    unit_s, unit = (60.0, "min") if log.t_s[-1] > MINUTES_S else (1.0, "s")
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(3, 1, sharex=True, height_ratios=(4, 5, 4))
        angles, potentials, duties = panels
        for side in WHEELS:
            wheel: Any = {"color": _WHEEL[side], "linestyle": LINE[side], "label": side}
            _line(angles, log, side + "_phi_rad", unit_s, **wheel)
            _line(duties, log, side + "_duty_pct", unit_s, drawstyle="steps-post", **wheel)
            for number, colour in enumerate(_POTENTIALS[side], 1):
                _line(
                    potentials,
                    log,
                    f"{side}_x{number}",
                    unit_s,
                    color=colour,
                    linestyle=LINE[side],
                    drawstyle="steps-post",
                    label=f"$x_{number}$ {side}",
                )
        for axes in panels:
            axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
            _mark(axes, log, unit_s)
        angles.set_ylabel(r"angle $\varphi$ (rad)")
        potentials.set_ylabel("potentials $x$")
        duties.set_ylabel("duty cycle (%)")
        duties.set_xlabel(f"time since the log began ({unit})")
        if log.t_s[-1] > 0.0:
            duties.set_xlim(0.0, log.t_s[-1] / unit_s)
        _name_kicks(angles, log, unit_s)
        for axes in (angles, potentials):
            axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.2)
        duties.legend(handles=_marks(log), loc="center left", bbox_to_anchor=(1.0, 0.5))
        figure.suptitle(title, fontsize=15)
        figure.align_ylabels()
    return figure


def _line(axes: Axes, log: Curves, name: str, unit_s: float, **style: Any) -> None:
    """A curve over time, broken where ticks are missing."""
    t, values = _thin(log.t_s / unit_s, log.values[name])
    if len(t) == len(log.t_s):  # a gap in more than POINTS points is less than a pixel
        t = np.insert(t, log.breaks, np.nan)
        values = np.insert(values, log.breaks, np.nan)
    axes.plot(t, values, linewidth=1.4, **style)


def _thin(t: Array, values: Array) -> tuple[Array, Array]:
    """At most about POINTS points that look the same: the least and the greatest of each share."""
    share = len(t) * 2 // POINTS
    if share < 2:
        return t, values
    whole = len(t) // share * share
    parts = values[:whole].reshape(-1, share)
    thin = np.stack([parts.min(axis=1), parts.max(axis=1)], axis=1).ravel()
    return np.repeat(t[:whole:share], 2), thin


def _mark(axes: Axes, log: Curves, unit_s: float) -> None:
    """Shade kicks, and draw lines where motions ended."""
    for one in log.kicks:
        begin, end = one.begin_s / unit_s, one.end_s / unit_s
        axes.axvspan(begin, end, color=_KICK, alpha=0.3, linewidth=0)
        axes.axvline(begin, color=_KICK, linewidth=1.2)
    for time_s, name in log.stops:
        axes.axvline(time_s / unit_s, color=_STOPS[name], linewidth=1.8, linestyle="--")


def _marks(log: Curves) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=_WHEEL[side], linestyle=LINE[side], label=side) for side in WHEELS
    ]
    if log.kicks:
        handles.append(Patch(color=_KICK, alpha=0.4, label="kick"))
    found = {name for _, name in log.stops}
    handles += [
        Line2D([], [], color=_STOPS[name], linestyle="--", label=name)
        for name in STOPS
        if name in found
    ]
    return handles


def _name_kicks(axes: Axes, log: Curves, unit_s: float) -> None:
    """Name kicks above the panel, in two lines in turn."""
    if len(log.kicks) > NAMED_KICKS:
        return
    for number, one in enumerate(log.kicks):
        late = one.begin_s > 0.7 * log.t_s[-1]
        axes.annotate(
            kick_words(one.kick),
            (one.begin_s / unit_s, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 5 + 15 * (number % 2)),
            textcoords="offset points",
            ha="right" if late else "left",
            color=_KICK,
            fontsize=11,
        )
