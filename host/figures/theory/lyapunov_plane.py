"""The largest exponent over the plane (k, tau), of wheels from both kinds of start."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from host.figures.style import SIZE, styled
from host.runs.contract import Findings
from host.theory.studies.lyapunov_rows import (
    ANY,
    ROLLS,
    GridRow,
    PlaneRow,
    StartKind,
    plane_of,
)

PANELS = ("any", "rolls")


def draw(rows: list[PlaneRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    with styled():
        figure = Figure(**SIZE)
        _draw_planes(figure, list(figure.subplots(1, 2, sharey=True)), plane_of(rows))
        figure.suptitle("The largest exponent of the model", fontsize=16)
    return figure


def _draw_planes(figure: Figure, panels: list[Axes], rows: list[GridRow]) -> None:
    """The largest exponent over the plane, of either start."""
    titles: dict[StartKind, str] = {
        ANY: "wheels that start anyhow",
        ROLLS: "wheels that roll at first",
    }
    most = max(0.2, *(row["exponent"] for row in rows))
    norm = TwoSlopeNorm(0.0, -1.0, most)
    for axes, start in zip(panels, titles, strict=True):
        own = [row for row in rows if row["start"] == start]
        ks, taus = sorted({row["k"] for row in own}), sorted({row["tau"] for row in own})
        values = np.full((len(taus), len(ks)), np.nan)
        for row in own:
            values[taus.index(row["tau"]), ks.index(row["k"])] = row["exponent"]
        extent = (0.0, ks[-1] + ks[0], 0.0, taus[-1] + taus[0])
        image = axes.imshow(
            values, origin="lower", aspect="auto", extent=extent, cmap="cividis", norm=norm
        )
        axes.set_xlabel("spring constant $k$")
        axes.set_title(titles[start], fontsize=13, loc="left")
    panels[0].set_ylabel(r"time constant $\tau$ (s)")
    bar = figure.colorbar(image, ax=panels, pad=0.02, extend="min")
    bar.set_label(r"$\lambda_1$ (1/s): 0 for cycles, below 0 at rest")
