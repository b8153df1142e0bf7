"""The Hopf line over tau with the paper's estimate.

Below: the first Lyapunov coefficient, and the frequency with which wheels swing.
"""

from __future__ import annotations

from math import pi

import numpy as np
from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.theory.studies.hopf_rows import HopfRow, line_of, point_of

PANELS = ("line", "ratio", "coefficient", "frequency")


def draw(rows: list[HopfRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    line, point = line_of(rows), point_of(rows)
    tau = np.array([row["tau"] for row in line])
    k = np.array([row["k_hopf"] for row in line])
    estimate = np.array([row["k_estimate"] for row in line])
    l1 = np.array([row["l1"] for row in line])
    omega = np.array([row["omega_hopf"] for row in line])
    born_stable = l1 < 0.0
    with styled():
        figure = Figure(**SIZE)
        (wide, ratio), (coefficient, frequency) = figure.subplots(2, 2, sharex=True)
        wide.loglog(tau, k, color=COLOURS[0], label="exact")
        wide.loglog(tau, estimate, "--", color="dimgrey", label=r"$k_c = 2f/(a\tau)$")
        wide.plot(
            point["tau"],
            point["k_hopf"],
            "o",
            color=COLOURS[0],
            label=rf"$\tau$ = {point['tau']:g} s: $k$ = {point['k_hopf']:.4f}",
        )
        wide.set_ylabel("spring constant $k$")
        wide.legend(fontsize=12, loc="upper right")
        wide.text(0.05, 0.08, "rest is stable", transform=wide.transAxes)
        ratio.semilogx(tau, estimate / k, color="dimgrey")
        ratio.set(ylabel=r"$k_c$ / exact", ylim=(0.0, 1.05))
        for mask, colour, words in (
            (born_stable, COLOURS[0], "cycles born stable"),
            (~born_stable, COLOURS[1], "cycles born unstable"),
        ):
            if mask.any():
                coefficient.semilogx(tau[mask], l1[mask], ".", color=colour, label=words)
        coefficient.axhline(0.0, color="dimgrey", linewidth=1.2)
        coefficient.set(
            ylabel="first Lyapunov\ncoefficient $l_1$", xlabel=r"time constant $\tau$ (s)"
        )
        coefficient.legend(fontsize=12)
        frequency.loglog(tau, omega / (2 * pi), color=COLOURS[0])
        frequency.set(ylabel="frequency (Hz)", xlabel=r"time constant $\tau$ (s)")
        figure.align_ylabels()
        figure.suptitle("Where a resting wheel begins to swing", fontsize=16)
    return figure
