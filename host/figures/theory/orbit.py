"""The orbit diagram: points on the section over a constant, as it rises and as it falls."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import SIZE, styled
from host.figures.theory.motions import COLOUR, LETTERS, MARKER, UNITS, handles
from host.figures.theory.section import SECTIONS, Coordinate
from host.runs.contract import Findings
from host.theory.analysis.attractors import KINDS, REST
from host.theory.studies.orbit_report import Numbers, Window
from host.theory.studies.orbit_rows import WAYS, OrbitRow

PANELS = ("up", "down")

# The room that the period of a window takes, as a part of the axis.
_LABEL = 0.03
# The titles of the panels stand this far (points) above them: the periods are in between.
_TITLE_PAD = 22


def draw(rows: list[OrbitRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    over, (column, label, equation) = numbers["over"], SECTIONS[numbers["on"]]
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(2, 1, sharex=True, sharey=True)
        values = [row["value"] for row in rows]
        panels[0].set_xlim(min(values), max(values))
        for axes, way, words in zip(panels, WAYS, ("rises", "falls"), strict=True):
            _draw(axes, [row for row in rows if row["way"] == way], column)
            _name_windows(axes, [own for own in numbers["windows"] if own["way"] == way])
            axes.set_ylabel(label)
            axes.set_title(f"{LETTERS[over]} {words}", fontsize=13, loc="left", pad=_TITLE_PAD)
        panels[1].set_xlabel(LETTERS[over] + (f" ({UNITS[over].strip()})" if over in UNITS else ""))
        figure.legend(
            handles=handles({row["kind"] for row in rows}), loc="outside lower center", ncols=5
        )
        figure.suptitle(
            f"Orbit diagram on the Poincaré section {equation}, up to the symmetries", fontsize=16
        )
    return figure


def _draw(axes: Axes, rows: list[OrbitRow], column: Coordinate) -> None:
    """The points; those of a wheel at rest are at 0."""
    for kind, colour in COLOUR.items():
        for repeats, size in ((True, 3.0), (False, 2.0)):
            own = [row for row in rows if row["kind"] == kind and bool(row["period"]) == repeats]
            axes.plot(
                [row["value"] for row in own],
                np.array([0.0 if kind == KINDS[REST] else row.get(column) for row in own], float),
                MARKER[kind],
                color=colour,
                markersize=size,
                markeredgewidth=0.5 if MARKER[kind] in "x+" else 0,
            )


def _name_windows(axes: Axes, windows: list[Window]) -> None:
    """Write the period of each window above it, if there is room."""
    left, right = axes.get_xlim()
    free = left
    for own in windows:
        middle = (own["from"] + own["to"]) / 2
        if own["period"] and middle >= free:
            axes.text(
                middle,
                1.0,
                str(own["period"]),
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
                fontsize=11,
                color=COLOUR[own["kind"]],
            )
            free = middle + _LABEL * (right - left)
