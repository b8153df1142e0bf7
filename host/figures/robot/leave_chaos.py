"""Kicks out of chaos: what robots do afterwards, for each kick and choice of parameters."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from host.experiments.robot.leave_chaos import (
    AFTERWARDS,
    DEFAULT,
    ENDS,
    REST_SET,
    STAY,
    Row,
    shares,
)
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings

PANELS = ("kick-alone", "k-8", "k-0.3")
_HATCHES = ("", "//", "..", "")
_TITLES = {
    STAY: "by the kick alone",
    DEFAULT: "kick, then k = 8, tau = 0.25 s",
    REST_SET: "kick, then k = 0.3, tau = 0.25 s",
}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    found = shares(rows)
    kicks = list(dict.fromkeys((one["kick"], one["ticks"]) for one in found))
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(1, len(AFTERWARDS), sharey=True)
        for axes, afterwards in zip(panels, AFTERWARDS, strict=True):
            left = np.zeros(len(kicks))
            for end, colour, hatch in zip(ENDS, COLOURS, _HATCHES, strict=False):
                own = [one for one in found if (one["afterwards"], one["end"]) == (afterwards, end)]
                widths = np.array([100 * one["robots"] / one["of"] for one in own])
                style: Any = {"color": colour, "hatch": hatch, "edgecolor": "white"}
                axes.barh(range(len(kicks)), widths, left=left, label=end, **style)
                left += widths
            axes.set_title(_TITLES[afterwards], fontsize=14)
            axes.set_xlabel("robots (%)")
        names = [
            f"{kick}, {ticks} tick{'s' * (ticks > 1)}" if ticks else kick for kick, ticks in kicks
        ]
        panels[0].set_yticks(range(len(kicks)), names)
        panels[0].invert_yaxis()
        share_legend(figure, panels, loc="outside lower center", ncols=len(ENDS))
        figure.suptitle(f"Kicks out of chaos: what {found[0]['of']} robots do afterwards")
    return figure
