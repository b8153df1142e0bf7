"""Portraits in (phi, nu), one for each k.

As the paper's figure of the homoclinic route, from locomotion down to rest.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row
from host.theory.model.wheel import Array

_NAMES = {"S": "rest", "FB": "forth and back", "LLM": "locomotion", "C": "irregular"}
_MARKERS = {"saddle": ("s", "white"), "stable": ("o", "black"), "unstable": ("o", "white")}
_STABLE, _UNSTABLE, _CYCLE = COLOURS[4], COLOURS[0], "#c00000"


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    found = [row for row in rows if row["part"] == "found"]
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 2.4 + 2.6 * len(found))})
        panels = figure.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
        for axes, row in zip(panels, sorted(found, key=lambda row: -float(row["k"])), strict=True):
            _draw(axes, [point for point in rows if point["k"] == row["k"]], row)
        panels[-1].set_xlabel(r"wheel angle $\varphi$")
        panels[-1].set_xticks(
            np.arange(-4, 5) * pi / 4, [f"{degrees}°" for degrees in range(-180, 181, 45)]
        )
        figure.legend(
            *panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=12
        )
    return figure


def _draw(axes: Axes, rows: list[Row], found: Row) -> None:
    edges = _points(rows, "stable manifold")
    for turns in range(-2, 3):
        for sign in (1.0, -1.0):
            axes.plot(
                sign * edges[:, 0] + turns * pi / 2,
                sign * edges[:, 1],
                ".",
                color=_STABLE,
                markersize=2.2,
            )
    axes.plot([], [], color=_STABLE, label="stable manifolds of the saddles, cut")
    for line in sorted({row["line"] for row in rows if row["part"] == "trajectory"}):
        _draw_turned(axes, _points(rows, "trajectory", line), (0,), color="black", linewidth=0.9)
    axes.plot([], [], color="black", linewidth=0.9, label="trajectories")
    for line in (0, 1):
        _draw_turned(
            axes, _points(rows, "unstable manifold", line), range(4), color=_UNSTABLE, linewidth=1.4
        )
    axes.plot([], [], color=_UNSTABLE, label="unstable manifolds")
    cycle = _points(rows, "limit cycle")
    if len(cycle):
        for sign in (1.0, -1.0):
            _draw_turned(axes, sign * cycle, range(4), color=_CYCLE, linewidth=2.6)
    axes.plot([], [], color=_CYCLE, linewidth=2.6, label="limit cycles")
    for kind, (marker, face) in _MARKERS.items():
        angles = np.array(
            [
                row["phi"]
                for row in rows
                if row["part"].startswith(kind) and "manifold" not in row["part"]
            ]
        )
        angles = np.concatenate([angles, angles - 2 * pi])
        angles = angles[np.abs(angles) < pi + 0.01]
        label = "saddles" if kind == "saddle" else f"{kind} rest"
        axes.plot([], [], marker, color="black", markerfacecolor=face, markersize=8, label=label)
        if len(angles):
            axes.plot(
                angles,
                np.zeros_like(angles),
                marker,
                color="black",
                markerfacecolor=face,
                markersize=8,
                clip_on=False,
                zorder=5,
            )
    most = found["fastest"] / (2 * pi)
    axes.set(xlim=(-pi, pi), ylim=(-most, most), ylabel=r"$\nu = \omega/2\pi$ (Hz)")
    axes.set_title(rf"$k$ = {found['k']:g}: {_NAMES[found['kind']]}", fontsize=14)


def _points(rows: list[Row], part: str, line: int = 0) -> Array:
    """(phi, nu) of a line's points, (points, 2)."""
    own = [
        (row["phi"], row["omega"] / (2 * pi))
        for row in rows
        if row["part"] == part and row["line"] == line
    ]
    return np.array(own).reshape(-1, 2)


def _draw_turned(axes: Axes, points: Array, quarters: Any, **style: Any) -> None:
    """A line, turned by these quarter turns, with its angle wrapped into one turn."""
    for quarter in quarters:
        phi = (points[:, 0] + quarter * pi / 2 + pi) % (2 * pi) - pi
        broken = np.insert(
            points[:, 1], jumps := np.flatnonzero(np.abs(np.diff(phi)) > pi) + 1, np.nan
        )
        axes.plot(np.insert(phi, jumps, np.nan), broken, **style)
