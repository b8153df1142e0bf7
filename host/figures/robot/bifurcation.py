"""Torque and speed against k, with k lowered and raised.

Right: near k_c, without signs, and with the limit cycles; unstable ones are dashed.
"""

from __future__ import annotations

from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from host.experiments.robot.bifurcation import SIGN, Numbers
from host.experiments.robot.bifurcation_rows import (
    BifurcationRow,
    BranchRow,
    SweepRow,
    held_cycles,
    least_k,
    sweep_rows,
)
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.kicking.outcome import FORWARD
from host.kicking.robot_claims import STALL_TORQUE
from host.runs.contract import Findings

Quantity = Literal["torque", "hz"]

_COLOUR = {"forward": COLOURS[0], "backward": COLOURS[1], "rest": "black"}
_WAYS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("down", {"marker": "o", "fillstyle": "full", "markersize": 6}),
    ("up", {"marker": "^", "fillstyle": "none", "markersize": 8}),
)
_WORDS = {"down": "lowered", "up": "raised"}
_NEAR_K = (-0.015, 0.03)  # around k_c


def draw(rows: list[BifurcationRow], findings: Findings) -> Figure:
    """Draw the rows."""
    numbers: Numbers = findings.numbers
    k_c = numbers["k_c"]["by descent"]
    with styled():
        figure = Figure(**SIZE)
        upper, lower = figure.subplots(2, 2, sharex="col")
        _draw_quantity(upper, rows, "torque", "torque $M$", "$|M|$", 1.1, 0.45)
        speeds = (r"speed $\omega/2\pi$ (Hz)", r"$|\omega|/2\pi$ (Hz)")
        _draw_quantity(lower, rows, "hz", *speeds, 2.3, 0.75)
        for axes in (*upper, *lower):
            axes.axvline(k_c, color="dimgrey", linestyle=":", linewidth=1.4)
        stall: Any = {"color": "grey", "alpha": 0.25, "linewidth": 0}
        for axes in upper:
            axes.axhspan(-STALL_TORQUE, STALL_TORQUE, label=f"stall, $|M|<{STALL_TORQUE}$", **stall)
        greatest_k = max((row["k"] for row in rows if row["part"] == "sweep"), default=8.0)
        upper[0].set_xlim(-0.1, greatest_k + 0.2)
        upper[1].set_xlim(k_c + _NEAR_K[0], k_c + _NEAR_K[1])
        upper[1].xaxis.set_major_locator(MultipleLocator(0.01))
        upper[1].text(k_c - 0.002, 0.43, f"$k_c$ = {k_c:.3f}", ha="right", va="top")
        for axes in lower:
            axes.set_xlabel("spring constant $k$")
        figure.align_ylabels()
        below: Any = {"loc": "outside lower center", "ncols": 4, "columnspacing": 1.5}
        share_legend(figure, upper, fontsize=11, **below)
        figure.suptitle(
            "Locomotion ends in a jump at $k_c$; above it, a robot at rest may stay there",
            fontsize=16,
        )
    return figure


def _draw_quantity(
    panels: tuple[Axes, Axes],
    rows: list[BifurcationRow],
    quantity: Quantity,
    label: str,
    absolute: str,
    most: float,
    most_near: float,
) -> None:
    """Draw a quantity over all k (left), and without its sign near k_c (right)."""
    wide, near = panels
    _draw_sweeps(wide, rows, quantity, signed=True)
    _draw_sweeps(near, rows, quantity, signed=False)
    _draw_cycles(near, held_cycles(rows), quantity)
    wide.set(ylabel=label, ylim=(-most, most))
    near.set(ylabel=absolute, ylim=(-0.03 * most_near, most_near))


def _draw_sweeps(
    axes: Axes, rows: list[BifurcationRow], quantity: Quantity, *, signed: bool
) -> None:
    sweep = sweep_rows(rows)
    for way, style in _WAYS:
        for state, colour in _COLOUR.items():
            points = [row for row in sweep if row["way"] == way and _state(row) == state]
            values = [row[quantity] if signed else abs(row[quantity]) for row in points]
            axes.plot(
                [row["k"] for row in points],
                values,
                color=colour,
                linestyle="",
                label=f"{state}, $k$ {_WORDS[way]}",
                **style,
            )


def _state(row: SweepRow) -> str:
    if row["rests"]:
        return "rest"
    return "forward" if row["hz"] > 0 else "backward"


def _draw_cycles(axes: Axes, held_cycles: list[BranchRow], quantity: Quantity) -> None:
    """Draw each direction's limit cycles, dashed where they are slower than that of least k."""
    for motion in SIGN:
        cycles = [row for row in held_cycles if row["motion"] == motion]
        cycles.sort(key=lambda row: row["held_hz"])
        node = least_k(cycles)
        if node is None:
            continue
        fold = cycles.index(node)
        unstable, stable = cycles[: fold + 1], cycles[fold:]
        for part, line, label in (
            (unstable, (0, (2, 1)), "unstable cycle"),
            (stable, "-", "stable cycle"),
        ):
            style: Any = {"linestyle": line, "color": _COLOUR[motion]}
            axes.plot(
                [row["k"] for row in part],
                [abs(row[quantity]) for row in part],
                label=f"{motion}, {label}",
                **style,
            )
        if motion == FORWARD:
            spot = cycles[0]["k"] + 0.0008, abs(cycles[0][quantity])
            axes.text(*spot, "unstable", va="center", fontsize=12)
