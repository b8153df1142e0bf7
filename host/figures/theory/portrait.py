"""Portraits in (phi, nu), one for each k.

Laid out like the paper's figure of the homoclinic route, from locomotion down to rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import ceil, floor, pi
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import CubicSpline

from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.figures.theory.manifold_sides import sides
from host.runs.contract import Findings
from host.theory.analysis.phases import Phase
from host.theory.model.wheel import Array
from host.theory.studies.portrait import PAPERS_K
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
    "Stable manifolds: in the slice of wheels that have always turned at their present speed,"
    r" $x_1 = (\cos\varphi + \omega\tau\sin\varphi)/(1 + \omega^2\tau^2)$,"
    r" $x_2 = (\sin\varphi - \omega\tau\cos\varphi)/(1 + \omega^2\tau^2)$,"
    "\nwhere trajectories start too. Unstable manifolds, limit cycles and trajectories:"
    " projections, over the first turn of each."
)
_SIDES = ("forward", "backward")
_STABLE, _UNSTABLE = (COLOURS[4], "#f0d000"), (COLOURS[0], "#5fbf8f")
_CYCLE = "#c00000"
# As shapes, thousands of points would make a large file.
_POINTS: Any = {"markersize": 3.6, "markeredgewidth": 0, "rasterized": True}
# A curve is drawn until it has moved this far from its start (rad), or this far in all.
_TURN, _WAY = 2 * pi, 6 * pi
# Between two points of a drawn curve, rad.
_FINE = 0.05


def panels(options: Mapping[str, Any]) -> list[str]:
    """The names of the panels."""
    return [_label(k) for k in (PAPERS_K if options["k"] is None else [options["k"]])]


def _label(k: float) -> str:
    return f"k={k:g}"


def draw(rows: list[PortraitRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    found = sorted(summaries(rows), key=lambda row: -row["k"])
    with styled():
        figure = Figure(**SIZE)
        column = figure.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
        for axes, row in zip(column, found, strict=True):
            _draw(axes, points(rows, row["k"]), row)
        column[-1].set_xlabel(r"wheel angle $\varphi$")
        column[-1].set_xticks(
            np.arange(-4, 5) * pi / 4, [f"{degrees}°" for degrees in range(-180, 181, 45)]
        )
        share_legend(
            figure,
            column,
            loc="outside lower center",
            ncols=5,
            fontsize=10.5,
            title=_SLICE,
            title_fontsize=10,
        )
    return figure


def _draw(axes: Axes, rows: list[PointRow], found: SummaryRow) -> None:
    axes.set_label(_label(found["k"]))
    most = found["fastest"] / (2 * pi)
    _draw_lines(axes, rows, most)
    _draw_fixpoints(axes, rows)
    axes.set(xlim=(-pi, pi), ylim=(-most, most), ylabel=r"$\nu = \omega/2\pi$ (Hz)")
    axes.set_title(rf"$k$ = {found['k']:g}: {_NAMES[found['kind']]}", fontsize=13)


def _draw_lines(axes: Axes, rows: list[PointRow], most: float) -> None:
    """Manifolds, trajectories and limit cycles. most: the greatest speed shown, Hz."""
    edges = _points(rows, "stable manifold")
    edges = np.concatenate([edges, -edges])
    forward = sides(edges, float(np.abs(edges[:, 1]).max(initial=0.01 * most)))
    for own, colour, side in zip((forward, ~forward), _STABLE, _SIDES, strict=True):
        for turns in range(-2, 3):
            phi = edges[own, 0] + turns * pi / 2
            axes.plot(phi, edges[own, 1], ".", color=colour, **_POINTS)
        if own.any():
            axes.plot([], [], color=colour, linewidth=2.6, label=f"stable manifolds, {side}")
    for line in sorted({row["line"] for row in rows if row["part"] == "trajectory"}):
        _draw_turned(
            axes,
            _curve(_points(rows, "trajectory", line)),
            (0,),
            color="black",
            linewidth=0.9,
            label="trajectories",
        )
    for line, (colour, side) in enumerate(zip(_UNSTABLE, _SIDES, strict=True)):
        _draw_turned(
            axes,
            _curve(_points(rows, "unstable manifold", line)),
            range(4),
            color=colour,
            linewidth=1.4,
            label=f"unstable manifolds, {side}",
        )
    cycle = _points(rows, "limit cycle")
    if len(cycle):
        for sign in (1.0, -1.0):
            _draw_turned(
                axes,
                sign * _curve(cycle),
                range(4),
                color=_CYCLE,
                linewidth=2.6,
                label="limit cycles",
            )


def _draw_fixpoints(axes: Axes, rows: list[PointRow]) -> None:
    for kind, (marker, face) in _MARKERS.items():
        angles = np.array([row["phi"] for row in rows if _marked(row) == kind])
        angles = np.concatenate([angles, angles - 2 * pi])
        angles = angles[np.abs(angles) < pi + 0.01]
        if len(angles):
            axes.plot(
                angles,
                np.zeros_like(angles),
                marker=marker,
                color="black",
                markerfacecolor=face,
                markersize=8,
                clip_on=False,
                zorder=5,
                linestyle="",
                label="saddles" if kind == "saddle" else f"{kind} rest",
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


def _curve(points: Array) -> Array:
    """A curve of states at equal times, smooth and not longer than can be told apart."""
    moved = np.abs(points[:, 0] - points[0, 0])
    way = np.append(0.0, np.cumsum(np.abs(np.diff(points[:, 0]))))
    shown = points[: int(np.argmax((moved > _TURN) | (way > _WAY))) or None]
    if len(shown) < 3:
        return shown
    times = np.arange(len(shown))
    each = int(np.ceil(np.abs(np.diff(shown[:, 0])).max() / _FINE))
    fine = np.linspace(0.0, times[-1], each * times[-1] + 1)
    return np.asarray(CubicSpline(times, shown)(fine))


def _draw_turned(axes: Axes, points: Array, quarters: Iterable[int], **style: Any) -> None:
    """A curve in copies that are turned by quarter turns, and by as many turns as it passes."""
    least, most = points[:, 0].min(), points[:, 0].max()
    for quarter in quarters:
        turned = points[:, 0] + quarter * pi / 2
        for turn in range(
            floor((-pi - most - quarter * pi / 2) / (2 * pi)),
            ceil((pi - least - quarter * pi / 2) / (2 * pi)) + 1,
        ):
            axes.plot(turned + turn * 2 * pi, points[:, 1], **style)
