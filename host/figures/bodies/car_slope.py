"""The car's way between slopes, from above, for each angle.

The one of its cars that saw most of the floor.
"""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from host.experiments.bodies.car_slope import ANGLES, runs_of
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row

_FOOT_M = 4.0


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 4.6)})
        panels = figure.subplots(1, len(ANGLES))
        lines = None
        for axes, angle in zip(panels, ANGLES, strict=True):
            run = max(
                (row for row in runs_of(rows) if row["angle"] == angle),
                key=lambda row: float(row["squares"]),
            )
            way = [
                row
                for row in rows
                if "t_s" in row and (row["angle"], row["number"]) == (angle, run["number"])
            ]
            points = np.array([[row["x_m"], row["y_m"]] for row in way])
            box = _FOOT_M * np.array([[-1, 1, 1, -1, -1], [-1, -1, 1, 1, -1]])
            axes.plot(*box, color="grey", linestyle="--", linewidth=1)
            t = np.array([row["t_s"] for row in way])
            lines = LineCollection(
                list(np.stack([points[:-1], points[1:]], axis=1)),
                cmap="cividis",
                array=t[:-1] / 60,
                linewidths=0.9,
            )
            axes.add_collection(lines)
            axes.plot(*points[-1], "o", color=COLOURS[1], markersize=5)
            half = 1.08 * max(_FOOT_M, float(np.abs(points).max()))
            axes.set(xlabel="$x$ (m)", xlim=(-half, half), ylim=(-half, half), aspect="equal")
            axes.locator_params(nbins=5)
            told = next(one for one in findings.numbers["angles"] if one["angle"] == angle)
            words = f"{told['inside']} of {told['cars']} inside, {told['flipped']} flipped"
            axes.set_title(
                f"{angle:g} rad: {words};\nshown: {run['path_m']:.0f} m, {run['reversals']}"
                " reversals",
                fontsize=11,
            )
        panels[0].set_ylabel("$y$ (m)")
        if lines is not None:
            figure.colorbar(lines, ax=panels, shrink=0.8, label="time (min)")
        minutes = max((row["t_s"] for row in rows if "t_s" in row), default=0.0) / 60
        figure.suptitle(
            f"A car between four slopes (dashed: their feet), for {minutes:.0f} min; dot: where it"
            " ends",
            fontsize=15,
        )
    return figure
