"""Lines of bifurcations in the plane of two constants, over the phases from rest.

Beside it the lines that are close to the Hopf line, as k relative to that of the Hopf line.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings
from host.theory.analysis.chaos_edges import LIFE_S
from host.theory.analysis.hopf import critical_k
from host.theory.analysis.phases import PHASES
from host.theory.model.wheel import Wheel
from host.theory.studies.lines_report import Numbers
from host.theory.studies.lines_rows import (
    ChaosEdgeRow,
    CyclePointRow,
    LinesRow,
    PointRow,
    SpecialRow,
    chaos_edges_of,
    phases_of,
    points_of,
    specials_of,
)

PANELS = ("plane", "near-hopf")

_LINES: dict[tuple[str, str], tuple[str, Any, str]] = {
    ("Hopf", "Hopf"): (COLOURS[6], "-", "Hopf"),
    ("merging", "merging"): (COLOURS[1], "-", "merging"),
    ("FB", "fold"): (COLOURS[0], "--", "folds, forth and back"),
    ("LLM", "fold"): (COLOURS[2], (0, (5, 1, 1, 1, 1, 1)), "folds, rotations"),
    ("LLM", "neimark-sacker"): (COLOURS[3], "-.", "Neimark-Sacker, rotations"),
    ("FB", "neimark-sacker"): (COLOURS[3], ":", "Neimark-Sacker, forth and back"),
    ("LLM", "pitchfork"): (COLOURS[4], "-.", "pitchforks, rotations"),
    ("FB", "pitchfork"): (COLOURS[4], ":", "pitchforks, forth and back"),
    ("windows", "period-doubling"): (COLOURS[6], (0, (1, 1)), "period doublings, windows"),
    ("windows", "fold"): (COLOURS[0], "-", "folds, windows"),
    ("windows", "neimark-sacker"): (COLOURS[3], (0, (4, 1, 1, 1)), "Neimark-Sacker, windows"),
    ("windows", "pitchfork"): (COLOURS[2], (0, (3, 1)), "pitchforks, windows"),
}
_MARKERS = {
    "Bautin": ("o", "Bautin point"),
    "neutral saddle": ("s", "neutral saddle"),
    "crosses Hopf": ("x", "crosses the Hopf line"),
    "cusp": ("^", "cusp"),
    "resonance 1:3": ("3", "resonance 1:3"),
    "resonance 1:4": ("+", "resonance 1:4"),
}
# The panel beside the Hopf line ends there.
_CLOSE = 2.0
_GREYS = {"S": "#ffffff", "FB": "#e6e6e6", "LLM": "#d0dcea", "C": "#bdbdbd", "undecided": "#f0c0c0"}
_LABELS = {
    "k": "spring constant $k$",
    "tau": r"time constant $\tau$ (s)",
    "a": "gain $a$",
    "f": "friction $f$ (s)",
    "I": "moment of inertia $I$ (s$^2$)",
}


def draw(rows: list[LinesRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    letters = numbers["axes"]["x"], numbers["axes"]["y"]

    def above(row: PointRow | CyclePointRow | SpecialRow) -> float:
        values = dict(zip(letters, (row["x"], row["y"]), strict=True))
        wheel = Wheel(**{**numbers["constants"], **values})
        return wheel.k / critical_k(wheel)

    with styled():
        figure = Figure(**SIZE)
        plane, close = figure.subplots(1, 2)
        x_to, y_to = _draw_phases(plane, rows)
        beside = [row for row in rows if row["part"] != "windows"]
        for axes, own, x_of in ((plane, rows, _x), (close, beside, above)):
            _draw_lines(axes, own, x_of)
            _draw_specials(axes, own, x_of)
            axes.set_ylabel(_LABELS[letters[1]])
        _draw_chaos(plane, chaos_edges_of(rows))
        plane.set(xlabel=_LABELS[letters[0]], xlim=(0.0, x_to), ylim=(0.0, y_to))
        near = [
            above(row) for row in points_of(beside) if row["type"] in ("Hopf", "merging", "fold")
        ]
        close.set(
            xlabel="$k$, relative to the Hopf line",
            xlim=(min(near) - 0.01, min(max(near), _CLOSE) + 0.01),
            yscale="log",
        )
        share_legend(
            figure,
            [plane, close],
            loc="outside lower center",
            ncols=5,
            fontsize=10.5,
            title="\n".join(numbers["not_drawn"]),
            title_fontsize=10,
        )
        figure.suptitle("Bifurcations of a wheel in the plane of two constants", fontsize=16)
    return figure


def _x(row: PointRow | CyclePointRow | SpecialRow) -> float:
    return row["x"]


def _draw_phases(axes: Axes, rows: list[LinesRow]) -> tuple[float, float]:
    """Each phase in its grey. Returns the greatest x and y."""
    own = phases_of(rows)
    xs, ys = np.unique([row["x"] for row in own]), np.unique([row["y"] for row in own])
    numbers = np.array([PHASES.index(row["phase"]) for row in own]).reshape(len(ys), len(xs))
    x_to, y_to = (float(values[-1] + values[0]) for values in (xs, ys))
    axes.imshow(
        numbers,
        origin="lower",
        extent=(0.0, x_to, 0.0, y_to),
        aspect="auto",
        cmap=ListedColormap([_GREYS[name] for name in PHASES]),
        norm=BoundaryNorm(np.arange(len(PHASES) + 1) - 0.5, len(PHASES)),
        interpolation="nearest",
    )
    for name in PHASES:
        if PHASES.index(name) in numbers:
            style: Any = {"color": _GREYS[name], "markeredgecolor": "black", "markersize": 12}
            axes.plot([], [], "s", label=f"{name}, from rest", **style)
    return x_to, y_to


def _draw_chaos(axes: Axes, edges: list[ChaosEdgeRow]) -> None:
    """The crises of each side, with their intervals."""
    for side in ("lower", "upper"):
        own = sorted((row for row in edges if row["side"] == side), key=lambda row: row["y"])
        if not own:
            continue
        xs = np.array([[row["x"], row["leaves"], row["stays"]] for row in own]).T
        axes.errorbar(
            xs[0],
            [row["y"] for row in own],
            xerr=np.abs(xs[1:] - xs[0]).max(axis=0),
            color=COLOURS[4],
            ecolor="black",
            capsize=3.0,
            marker="D",
            markersize=5.0,
            markeredgecolor="black",
            label=f"crisis: chaos lives {LIFE_S:g} s",
        )


def _draw_lines(
    axes: Axes, rows: list[LinesRow], x_of: Callable[[PointRow | CyclePointRow | SpecialRow], float]
) -> None:
    def piece(row: PointRow | CyclePointRow) -> Any:
        return row["part"], row["band"], row["type"], row["piece"]

    for (part, _, type_, _), own in groupby(points_of(rows), piece):
        found = list(own)
        colour, style, label = _LINES[part, type_]
        axes.plot(
            [x_of(row) for row in found],
            [row["y"] for row in found],
            linestyle=style,
            color=colour,
            label=label,
        )


def _draw_specials(
    axes: Axes, rows: list[LinesRow], x_of: Callable[[PointRow | CyclePointRow | SpecialRow], float]
) -> None:
    for type_, (marker, label) in _MARKERS.items():
        found = [row for row in specials_of(rows) if row["type"] == type_]
        axes.plot(
            [x_of(row) for row in found],
            [row["y"] for row in found],
            marker,
            color="black",
            markerfacecolor="white",
            markersize=9,
            zorder=5,
            label=label if found else None,
        )
