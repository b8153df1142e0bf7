"""Maps of the largest exponent over k and tau: the robot's, with older rods, and the model's."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from host.experiments.robot.exponents import KS, TAUS_S, WHOSE, Row
from host.figures.heat_map import draw_heat_map
from host.figures.style import SIZE, styled
from host.runs.contract import Findings

PANELS = ("robot", "older-rods", "model")


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    found = {(row["whose"], row["tau_s"], row["k"]): row["exponent"] for row in rows}
    largest = max(found.values())
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(1, len(WHOSE), sharey=True)
        for axes, whose in zip(panels, WHOSE, strict=True):
            values = np.array([[found[whose, tau_s, k] for k in KS] for tau_s in TAUS_S])
            draw_heat_map(
                axes, values, largest, lambda row, column, value: f"{value:z.1f}", fontsize=9
            )
            axes.set_xticks(np.arange(len(KS)) + 0.5, [f"{k:g}" for k in KS], fontsize=11)
            axes.set_yticks(np.arange(len(TAUS_S)) + 0.5, [f"{tau_s:g}" for tau_s in TAUS_S])
            axes.set_xlabel("$k$ (1)")
            axes.set_title(whose, fontsize=14)
        panels[0].set_ylabel("$\\tau$ (s)")
        figure.suptitle(
            "Largest Lyapunov exponent (1/s): above 0 where motion is chaotic", fontsize=16
        )
    return figure
