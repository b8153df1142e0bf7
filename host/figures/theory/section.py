"""A Poincare section, the first-return map on it, and the power spectra."""

from __future__ import annotations

from itertools import groupby
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import ABOVE, SIZE, say_if_empty, styled
from host.figures.theory.motions import COLOUR, MARKER, handles
from host.runs.contract import Findings
from host.theory.engine.crossings import Surface
from host.theory.model.wheel import Array
from host.theory.studies.section_report import Numbers
from host.theory.studies.section_rows import (
    CrossingRow,
    FrequencyRow,
    SectionRow,
    crossings_of,
    spectrum_of,
)

PANELS = ("section", "returns", "potentials", "omega")

Coordinate = Literal["section_omega", "section_phi"]
Signal = Literal["potentials", "omega_power"]
# The coordinate along the section, its label, and the section's equation.
SECTIONS: dict[Surface, tuple[Coordinate, str, str]] = {
    "phi": ("section_omega", r"$\omega$ (rad/s)", r"$\sin 2\varphi = 0$"),
    "omega": ("section_phi", r"$\varphi$ (rad)", r"$\omega = 0$"),
}
# Powers are shown down to this part of the greatest; an axis is at least so long.
_LEAST, _SHORTEST = 1e-7, 0.02
_CROSS: Any = {"color": "black", "marker": "+", "markersize": 14, "linestyle": ""}


def draw(rows: list[SectionRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        (section, returns), (potentials, omega) = figure.subplots(2, 2, height_ratios=(1.5, 1.0))
        _draw_points(section, returns, crossings_of(rows), numbers)
        last = max(
            _draw_spectrum(potentials, spectrum_of(rows), "potentials"),
            _draw_spectrum(omega, spectrum_of(rows), "omega_power"),
        )
        for axes, label in ((potentials, "power of $x_1$, $x_2$"), (omega, r"power of $\omega$")):
            axes.set(xlim=(0.0, last), xlabel="frequency (Hz)", ylabel=f"{label}\n(greatest: 1)")
            if numbers["rotation"]:
                hertz = numbers["rotation"]["frequency_hz"]
                axes.axvline(hertz, color="black", linestyle=":", linewidth=1.2, label="rotation")
                axes.legend(**ABOVE)
            say_if_empty(axes, "no wheel moves: no power")
        figure.suptitle(
            f"Poincaré section {SECTIONS[numbers['on']][2]}, up to the symmetries", fontsize=16
        )
    return figure


def _draw_points(section: Axes, returns: Axes, rows: list[CrossingRow], numbers: Numbers) -> None:
    """The points of all wheels on the section, and each with the next one."""
    name, label, _ = SECTIONS[numbers["on"]]
    for _, group in groupby(rows, key=lambda row: (row["batch"], row["wheel"])):
        own = list(group)
        along, across = _column(own, name), _column(own, "section_x2")
        kind, size = own[0]["kind"], 8.0 if own[0]["period"] else 2.5
        style: Any = {"color": COLOUR[kind], "marker": MARKER[kind], "linestyle": ""}
        style |= {"markersize": size, "markeredgewidth": 0.5 if MARKER[kind] in "x+" else 0}
        section.plot(along, across, **style)
        returns.plot(along[:-1], along[1:], **style)
    rotation = numbers["rotation"]
    if rotation and numbers["on"] == "phi":
        words = f"{'' if rotation['stable'] else 'un'}stable rotation"
        section.plot(rotation["omega"], rotation["x2"], **_CROSS)
        returns.plot(rotation["omega"], rotation["omega"], label=words, **_CROSS)
        returns.legend(**ABOVE)
    for axes in (section, returns):
        say_if_empty(axes, "no wheel crosses the section")
    for axes in (section, returns):
        _widen(axes)
    if not returns.texts:  # there are points
        returns.axline((0.0, 0.0), slope=1.0, color="grey", linewidth=0.8, zorder=0)
    section.set(xlabel=label, ylabel="$x_2$")
    returns.set(xlabel=label, ylabel="the same at the next crossing")
    kinds = handles({row["kind"] for row in rows})
    section.legend(handles=kinds, ncols=len(kinds), **ABOVE)


def _column(rows: list[CrossingRow], name: str) -> Array:
    return np.array([row.get(name) for row in rows], dtype=float)


def _widen(axes: Axes) -> None:
    """Make axes so long that a single point does not look like many."""
    for limits, set_limits in ((axes.get_xlim(), axes.set_xlim), (axes.get_ylim(), axes.set_ylim)):
        middle, half = sum(limits) / 2, (limits[1] - limits[0]) / 2
        half = max(half, _SHORTEST * max(1.0, abs(middle)))
        set_limits(middle - half, middle + half)


def _draw_spectrum(axes: Axes, rows: list[FrequencyRow], name: Signal) -> float:
    """Harmonics of cycles as bars, densities as lines. Returns the last frequency with power."""
    last = 0.0
    for _, group in groupby(rows, key=lambda row: (row["kind"], row["period"])):
        own = list(group)
        frequency = np.array([row["frequency"] for row in own])
        power = np.array([row[name] for row in own])
        power, colour = power / power.max(), COLOUR[own[0]["kind"]]
        shown = power > _LEAST
        if own[0]["resolution"]:
            axes.plot(frequency, power, color=colour, linewidth=1.2)
        else:
            axes.vlines(frequency[shown], _LEAST, power[shown], color=colour, linewidth=2.5)
        last = max(last, 1.05 * float(frequency[shown].max()))
    axes.set_yscale("log")
    axes.set_ylim(_LEAST, 3.0)
    return last or 1.0
