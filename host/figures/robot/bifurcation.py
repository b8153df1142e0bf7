"""Torque and speed against k, with k lowered and raised, over the paper's k, and near k_c.

Near k_c there is nothing to see but limit cycles that were held, so without these no such panel.
The measured limit cycles, those that feedback held and those that wheels ran on by themselves,
scatter by some per mille in k. Each direction's line is a polynomial that is fitted to them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from host.experiments.robot.bifurcation import SIGN, Numbers
from host.experiments.robot.bifurcation_rows import (
    BifurcationRow,
    BranchRow,
    SweepRow,
    held_cycles,
    sweep_rows,
)
from host.figures.style import COLOURS, SIZE, styled
from host.kicking.robot_claims import STALL_TORQUE
from host.runs.contract import Findings

Quantity = Literal["torque", "hz"]

_COLOUR = {"forward": COLOURS[0], "backward": COLOURS[1], "rest": "black"}
_WAYS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("down", "$k$ lowered", {"marker": "o", "fillstyle": "full", "markersize": 5}),
    ("up", "$k$ raised", {"marker": "^", "fillstyle": "none", "markersize": 7}),
)
_CYCLE: Any = {"marker": "s", "fillstyle": "none", "markersize": 5, "linestyle": ""}
_UNSTABLE: Any = (0, (2, 1))
# The paper's enlarged panel, and the surroundings of k_c.
_PAPER_K = (0.0, 2.0)
_NEAR_K = (-0.012, 0.03)
# Fits take cycles up to this k. Held ones count more: one stands for a speed.
_FITTED_K, _HELD_WEIGHT, _DEGREE = 2.2, 3.0, 4
_LABELS: dict[Quantity, tuple[str, str, float, float]] = {
    "torque": ("torque $M$", "$|M|$", 1.1, 0.4),
    "hz": (r"speed $\omega/2\pi$ (Hz)", r"$|\omega|/2\pi$ (Hz)", 2.3, 0.65),
}


class Line(NamedTuple):
    """The fitted limit cycles of one direction, from the slowest on; `fold` is that of least k."""

    k: NDArray[np.float64]
    hz: NDArray[np.float64]
    torque: NDArray[np.float64]
    fold: int


def panels(options: Mapping[str, Any]) -> tuple[str, ...]:
    """The panels of a run with these options."""
    return _names(near=options["branch"] > 0)


def _names(*, near: bool) -> tuple[str, ...]:
    places = ("", "-2", "-near") if near else ("", "-2")
    return tuple(f"{quantity}{place}" for quantity in ("torque", "speed") for place in places)


def draw(rows: list[BifurcationRow], findings: Findings) -> Figure:
    """Draw the rows."""
    numbers: Numbers = findings.numbers
    k_c = numbers["k_c"]["by descent"]
    greatest_k = max((row["k"] for row in sweep_rows(rows)), default=8.0)
    spans = [(-0.1, greatest_k + 0.2), _PAPER_K]
    held = held_cycles(rows)
    if held:
        spans.append((k_c + _NEAR_K[0], k_c + _NEAR_K[1]))
    lines = {motion: line for motion in SIGN if (line := _fit(rows, motion)) is not None}
    with styled():
        figure = Figure(**SIZE)
        grid = figure.subplots(2, len(spans), sharex="col")
        for axes, name in zip(grid.flat, _names(near=bool(held)), strict=True):
            axes.set_label(name)
        quantities: tuple[Quantity, ...] = ("torque", "hz")
        for across, quantity in zip(grid, quantities, strict=True):
            label, absolute, most, most_near = _LABELS[quantity]
            for axes, span in zip(across, spans, strict=True):
                near = bool(held) and axes is across[-1]
                _draw_sweeps(axes, rows, quantity, signed=not near)
                if axes is not across[0]:
                    _draw_lines(axes, lines, quantity, signed=not near)
                axes.axvline(k_c, color="dimgrey", linestyle=":", linewidth=1.4)
                axes.set(xlim=span, ylim=(-0.03 * most_near, most_near) if near else (-most, most))
            across[0].set_ylabel(label)
            if held:
                _draw_held(across[-1], held, quantity)
                across[-1].set_ylabel(absolute)
        for axes in grid[0]:
            axes.axhspan(-STALL_TORQUE, STALL_TORQUE, color="lightgrey", linewidth=0, zorder=0)
        for axes in grid[1]:
            axes.set_xlabel("spring constant $k$")
        if held:
            grid[1, 2].xaxis.set_major_locator(MultipleLocator(0.01))
        last = grid[0, -1]
        place: Any = {"ha": "right", "va": "top", "transform": last.get_xaxis_transform()}
        last.text(k_c, 0.95, f"$k_c$ = {k_c:.3f} ", fontsize=11, **place)
        figure.align_ylabels()
        handles = _handles(rows, fitted=bool(lines))
        figure.legend(handles=handles, loc="outside lower left", ncols=5, fontsize=11)
        figure.suptitle(
            "Locomotion ends in a jump at $k_c$; above it, a robot at rest may stay there",
            fontsize=16,
        )
    return figure


def _state(row: SweepRow) -> str:
    if row["rests"]:
        return "rest"
    return "forward" if row["hz"] > 0 else "backward"


def _draw_sweeps(
    axes: Axes, rows: list[BifurcationRow], quantity: Quantity, *, signed: bool
) -> None:
    for way, _, style in _WAYS:
        for state, colour in _COLOUR.items():
            points = [row for row in sweep_rows(rows) if row["way"] == way and _state(row) == state]
            values = [row[quantity] if signed else abs(row[quantity]) for row in points]
            axes.plot([row["k"] for row in points], values, color=colour, linestyle="", **style)


def _fit(rows: list[BifurcationRow], motion: str) -> Line | None:
    """The limit cycles of a direction; None if too few of them were held."""
    held = [row for row in held_cycles(rows) if row["motion"] == motion]
    ran = [row for row in sweep_rows(rows) if _state(row) == motion and row["k"] <= _FITTED_K]
    if len(held) <= _DEGREE + 1:
        return None
    hz, torque, k = (np.abs([row[name] for row in (*held, *ran)]) for name in ("hz", "torque", "k"))
    weights = [_HELD_WEIGHT] * len(held) + [1.0] * len(ran)
    speeds = np.linspace(hz.min(), hz.max(), 500)
    ks = np.exp(np.polyval(np.polyfit(hz, np.log(k), _DEGREE, w=weights), speeds))
    torques = np.asarray(np.polyval(np.polyfit(hz, torque, _DEGREE, w=weights), speeds))
    return Line(ks, speeds, torques, int(ks.argmin()))


def _draw_lines(axes: Axes, lines: dict[str, Line], quantity: Quantity, *, signed: bool) -> None:
    """Draw the fitted limit cycles, dashed where they are unstable: slower than that of least k."""
    for motion, line in lines.items():
        values = getattr(line, quantity) * (SIGN[motion] if signed else 1)
        colour = _COLOUR[motion]
        axes.plot(line.k[line.fold :], values[line.fold :], color=colour)
        slow = slice(line.fold + 1)
        axes.plot(line.k[slow], values[slow], color=colour, linestyle=_UNSTABLE)


def _draw_held(axes: Axes, cycles: list[BranchRow], quantity: Quantity) -> None:
    for motion in SIGN:
        own = [row for row in cycles if row["motion"] == motion]
        values = [abs(row[quantity]) for row in own]
        axes.plot([row["k"] for row in own], values, color=_COLOUR[motion], **_CYCLE)


def _handles(rows: list[BifurcationRow], *, fitted: bool) -> list[Any]:
    """The legend's entries for what is drawn."""
    drawn = {_state(row) for row in sweep_rows(rows)}
    handles: list[Any] = [
        Patch(color=colour, label=state) for state, colour in _COLOUR.items() if state in drawn
    ]
    handles += [
        Line2D([], [], color="grey", linestyle="", label=words, **style)
        for _, words, style in _WAYS
    ]
    if held_cycles(rows):
        handles.append(Line2D([], [], color="grey", label="held by feedback", **_CYCLE))
    if fitted:
        handles.append(Line2D([], [], color="grey", label="limit cycle, fitted"))
        handles.append(Line2D([], [], color="grey", linestyle=_UNSTABLE, label="unstable"))
    handles.append(Patch(color="lightgrey", label=f"stall, $|M|<{STALL_TORQUE:g}$"))
    return handles
