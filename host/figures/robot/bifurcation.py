"""Torque and speed against k, k lowered and raised, with the stall.

Right, around k_c and without signs, the unstable cycles dashed.
"""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.bifurcation import SIGN, STALL_TORQUE, held, least_k
from host.figures.style import COLOURS, SIZE, styled
from host.kicking.outcome import FORWARD
from host.runs.contract import Findings, Row

_COLOUR = {"forward": COLOURS[0], "backward": COLOURS[1], "rest": "black"}
_QUANTITIES = (
    ("torque", "torque $M$", "$|M|$", 1.1, 0.45),
    ("hz", r"$\omega/2\pi$ (Hz)", r"$|\omega|/2\pi$ (Hz)", 2.3, 0.75),
)
_WAYS = {"down": ("o", "full"), "up": ("^", "none")}
_NEAR_K = (-0.015, 0.03)  # around k_c


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    k_c = findings.numbers["k_c"]["by descent"]
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(2, 2, sharex="col")
        for (wide, near), (quantity, label, absolute, most, most_near) in zip(
            panels, _QUANTITIES, strict=True
        ):
            _draw_sweeps(wide, rows, quantity, signed=True)
            _draw_sweeps(near, rows, quantity, signed=False)
            _draw_cycles(near, rows, quantity)
            for axes in (wide, near):
                axes.axvline(k_c, color="dimgrey", linestyle=":", linewidth=1.4)
            wide.set(ylabel=label, ylim=(-most, most))
            near.set(ylabel=absolute, ylim=(-0.03 * most_near, most_near))
        for axes in panels[0]:
            axes.axhspan(
                -STALL_TORQUE,
                STALL_TORQUE,
                color="grey",
                alpha=0.25,
                linewidth=0,
                label=f"stall, $|M|<{STALL_TORQUE}$",
            )
        panels[0, 0].set_xlim(-0.1, 8.2)
        panels[0, 1].set_xlim(k_c + _NEAR_K[0], k_c + _NEAR_K[1])
        panels[0, 1].text(k_c - 0.002, 0.43, f"$k_c$ = {k_c:.3f}", ha="right", va="top")
        for axes in panels[1]:
            axes.set_xlabel("spring constant $k$")
        figure.align_ylabels()
        known = {
            label: handle
            for axes in panels[0]
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(
            known.values(),
            known.keys(),
            loc="outside lower center",
            ncols=4,
            fontsize=11,
            columnspacing=1.5,
        )
        figure.suptitle(
            "Locomotion ends in a jump at $k_c$; above it, a robot at rest may stay there",
            fontsize=16,
        )
    return figure


def _draw_sweeps(axes: Axes, rows: list[Row], quantity: str, *, signed: bool) -> None:
    sweep = [row for row in rows if row["part"] == "sweep"]
    for way, (marker, fill) in _WAYS.items():
        for state, colour in _COLOUR.items():
            points = [row for row in sweep if row["way"] == way and _state(row) == state]
            values = [row[quantity] if signed else abs(row[quantity]) for row in points]
            style: Any = {
                "marker": marker,
                "fillstyle": fill,
                "color": colour,
                "linestyle": "",
                "markersize": 6 if way == "down" else 8,
            }
            axes.plot(
                [row["k"] for row in points],
                values,
                label=f"{state}, $k$ {'lowered' if way == 'down' else 'raised'}",
                **style,
            )


def _state(row: Row) -> str:
    if row["rests"]:
        return "rest"
    return "forward" if row["hz"] > 0 else "backward"


def _draw_cycles(axes: Axes, rows: list[Row], quantity: str) -> None:
    """Each direction's limit cycles by speed, dashed below the one of least k."""
    for motion in SIGN:
        cycles = sorted(
            (row for row in held(rows) if row["motion"] == motion),
            key=lambda row: float(row["held_hz"]),
        )
        node = least_k(cycles)
        if node is None:
            continue
        fold = cycles.index(node)
        for part, line, label in (
            (cycles[: fold + 1], (0, (2, 1)), "unstable cycle"),
            (cycles[fold:], "-", "stable cycle"),
        ):
            style: Any = {"linestyle": line, "color": _COLOUR[motion]}
            axes.plot(
                [row["k"] for row in part],
                [abs(row[quantity]) for row in part],
                label=f"{motion}, {label}",
                **style,
            )
        if motion == FORWARD:
            lowest = cycles[0]
            spot = lowest["k"] + 0.0008, abs(lowest[quantity])
            axes.text(*spot, "unstable", va="center", fontsize=12)
