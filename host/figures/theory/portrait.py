"""Portraits in (phi, nu), one for each k.

Laid out like the paper's figure of the homoclinic route, from locomotion down to rest.
"""

from __future__ import annotations

from math import pi
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.theory.analysis.phases import Phase
from host.theory.model.wheel import Array
from host.theory.studies.portrait_rows import (
    LinePart,
    PointRow,
    PortraitRow,
    SummaryRow,
    points,
    summaries,
)

Marked = Literal["saddle", "stable", "unstable"]
_NAMES: dict[Phase, str] = {
    "S": "rest",
    "FB": "forth and back",
    "LLM": "locomotion",
    "C": "irregular",
}
_MARKERS: dict[Marked, tuple[str, str]] = {
    "saddle": ("s", "white"),
    "stable": ("o", "black"),
    "unstable": ("o", "white"),
}
# Which slice of the four dimensions is shown (host.theory.model.turning).
_SLICE = (
    "Slice for the stable manifolds, where trajectories start too: the potentials of a wheel that"
    " has always\nturned at its present speed,"
    r" $x_1 = (\cos\varphi + \omega\tau\sin\varphi)/(1 + \omega^2\tau^2)$,"
    r" $x_2 = (\sin\varphi - \omega\tau\cos\varphi)/(1 + \omega^2\tau^2)$."
    "\nUnstable manifolds, limit cycles and trajectories are projections."
)
_STABLE, _UNSTABLE, _CYCLE = COLOURS[4], COLOURS[0], "#c00000"


def draw(rows: list[PortraitRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    found = sorted(summaries(rows), key=lambda row: -row["k"])
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 2.4 + 2.6 * len(found))})
        panels = figure.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
        for axes, row in zip(panels, found, strict=True):
            _draw(axes, points(rows, row["k"]), row)
        panels[-1].set_xlabel(r"wheel angle $\varphi$")
        panels[-1].set_xticks(
            np.arange(-4, 5) * pi / 4, [f"{degrees}°" for degrees in range(-180, 181, 45)]
        )
        figure.legend(
            *panels[0].get_legend_handles_labels(),
            loc="outside lower center",
            ncols=3,
            fontsize=12,
            title=_SLICE,
            title_fontsize=11,
        )
    return figure


def _draw(axes: Axes, rows: list[PointRow], found: SummaryRow) -> None:
    axes.set_label(f"k={found['k']:g}")
    _draw_lines(axes, rows)
    _draw_fixpoints(axes, rows)
    most = found["fastest"] / (2 * pi)
    axes.set(xlim=(-pi, pi), ylim=(-most, most), ylabel=r"$\nu = \omega/2\pi$ (Hz)")
    axes.set_title(rf"$k$ = {found['k']:g}: {_NAMES[found['kind']]}", fontsize=14)


def _draw_lines(axes: Axes, rows: list[PointRow]) -> None:
    """Manifolds, trajectories and limit cycles."""
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
    axes.plot([], [], color=_STABLE, label="stable manifolds of the saddles, in a slice")
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


def _draw_fixpoints(axes: Axes, rows: list[PointRow]) -> None:
    for kind, (marker, face) in _MARKERS.items():
        angles = np.array([row["phi"] for row in rows if _marked(row) == kind])
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


def _marked(row: PointRow) -> Marked | None:
    """The kind of fixpoint as it is marked; None for a point of a line."""
    if row["part"] == "saddle":
        return "saddle"
    if row["part"] in ("stable focus", "stable node"):
        return "stable"
    return "unstable" if row["part"] in ("unstable focus", "unstable node") else None


def _points(rows: list[PointRow], part: LinePart, line: int = 0) -> Array:
    """(phi in rad, nu in Hz) of a line's points, (points, 2)."""
    own = [
        (row["phi"], row["omega"] / (2 * pi))
        for row in rows
        if row["part"] == part and row["line"] == line
    ]
    return np.array(own).reshape(-1, 2)


def _draw_turned(axes: Axes, points: Array, quarters: Any, **style: Any) -> None:
    """A line in copies that are turned by quarter turns; its angle is wrapped into one turn."""
    for quarter in quarters:
        phi = (points[:, 0] + quarter * pi / 2 + pi) % (2 * pi) - pi
        jumps = np.flatnonzero(np.abs(np.diff(phi)) > pi) + 1
        axes.plot(np.insert(phi, jumps, np.nan), np.insert(points[:, 1], jumps, np.nan), **style)
