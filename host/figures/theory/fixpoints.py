"""Left, the force of the rods on a resting wheel, with its zeros.

Right, the eigenvalues of each kind of fixpoint.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.theory.studies.fixpoints_rows import (
    FixpointsRow,
    ForceRow,
    OneWheelRow,
    eigenvalues,
    of_force,
    of_one_kind,
    of_one_wheel,
)

PANELS = ("force", "eigenvalues")

_MARKERS = ((COLOURS[0], "o"), (COLOURS[1], "s"), (COLOURS[2], "^"), (COLOURS[3], "D"))


def draw(rows: list[FixpointsRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    one = of_one_wheel(rows)
    kinds = of_one_kind(one)
    with styled():
        figure = Figure(**SIZE)
        left, right = figure.subplots(1, 2, width_ratios=(1.2, 1))
        _draw_force(left, of_force(rows), kinds)
        for alike, (colour, marker) in zip(kinds, _MARKERS, strict=False):
            right.plot(
                *np.array(eigenvalues(alike[0])).T,
                marker,
                color=colour,
                markersize=9,
                fillstyle="none",
                markeredgewidth=2,
                label=f"{_places(alike)}: {alike[0]['kind']}",
            )
        right.axvline(0.0, color="dimgrey", linewidth=1.2)
        right.set(xlabel="real part (1/s): growth", ylabel="imaginary part (rad/s): turning")
        right.margins(0.12)
        right.locator_params(axis="x", nbins=6)
        figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        ends = " and ".join(_places(alike) for alike in kinds if alike[0]["kind"] == "saddle")
        figure.suptitle(
            f"A wheel can rest at {len(one)} angles; at {ends} never for long", fontsize=16
        )
    return figure


def _places(alike: list[OneWheelRow]) -> str:
    return ", ".join(f"{np.degrees(row['phi']):.4g}°" for row in alike)


def _draw_force(axes: Axes, force: list[ForceRow], kinds: list[list[OneWheelRow]]) -> None:
    """In units of the spring constant, which does not move the zeros."""
    axes.plot([row["phi"] for row in force], [row["force"] for row in force], color="black")
    axes.axhline(0.0, color="dimgrey", linewidth=1.2)
    for alike, (colour, marker) in zip(kinds, _MARKERS, strict=False):
        axes.plot(
            [row["phi"] for row in alike],
            [0.0 for _ in alike],
            marker,
            color=colour,
            markersize=9,
            markeredgewidth=2,
            markerfacecolor=colour if alike[0]["stable"] else "white",
        )
    axes.set(xlabel=r"wheel angle $\varphi$", ylabel=r"force $F^{\mathrm{tan}} / k$ at rest")
    axes.set_xticks(np.arange(0, 9, 2) * np.pi / 4, ["0", "90°", "180°", "270°", "360°"])
