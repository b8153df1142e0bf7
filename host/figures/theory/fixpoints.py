"""Left, the force of the rods on a resting wheel, with its eight zeros.

Right, the eigenvalues of the two kinds of fixpoints.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.theory.model.wheel import OMEGA, Wheel, numpy_rates, resting
from host.theory.studies.fixpoints_rows import (
    FixpointsRow,
    OneWheelRow,
    eigenvalues,
    of_one_wheel,
)

_KINDS = (("even $n$", 0, COLOURS[0], "o"), ("odd $n$", 1, COLOURS[1], "s"))


def draw(rows: list[FixpointsRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    one = of_one_wheel(rows)
    with styled():
        figure = Figure(**SIZE)
        left, right = figure.subplots(1, 2, width_ratios=(1.2, 1))
        _draw_force(left, one)
        for name, odd, colour, marker in _KINDS:
            row = one[odd]
            parts = np.array(eigenvalues(row))
            right.plot(
                *parts.T,
                marker,
                color=colour,
                markersize=9,
                fillstyle="none",
                markeredgewidth=2,
                label=f"{name}: {row['kind']}",
            )
        right.axvline(0.0, color="dimgrey", linewidth=1.2)
        right.set(xlabel="real part (1/s): growth", ylabel="imaginary part (rad/s): turning")
        right.margins(0.12)
        right.locator_params(axis="x", nbins=6)
        figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        figure.suptitle(
            "A wheel can rest at eight angles; at odd multiples of 45° never for long", fontsize=16
        )
    return figure


def _draw_force(axes: Axes, one: list[OneWheelRow]) -> None:
    """In units of the spring constant, which does not move the zeros."""
    angles = np.linspace(-0.2, 2 * np.pi + 0.2, 1000)
    unit = Wheel(k=1.0, I=1.0, f=0.0)
    axes.plot(angles, numpy_rates(*resting(angles), *unit)[OMEGA], color="black")
    axes.axhline(0.0, color="dimgrey", linewidth=1.2)
    for _, odd, colour, marker in _KINDS:
        own = [row for row in one if row["n"] % 2 == odd]
        axes.plot(
            [row["phi"] for row in own],
            [0.0 for _ in own],
            marker,
            color=colour,
            markersize=9,
            markeredgewidth=2,
            markerfacecolor=colour if own[0]["stable"] else "white",
        )
    axes.set(xlabel=r"wheel angle $\varphi$", ylabel=r"force $F^{\mathrm{tan}} / k$ at rest")
    axes.set_xticks(np.arange(0, 9, 2) * np.pi / 4, ["0", "90°", "180°", "270°", "360°"])
