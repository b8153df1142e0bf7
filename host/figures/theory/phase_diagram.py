"""std(omega) and |mean(omega)| over (k, tau), with the inset, the phases and their lines.

Where k is swept, the picture shows it swept up; a dotted line shows what differs with k swept down.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from host.figures.style import SIZE, styled
from host.runs.contract import Findings
from host.theory.analysis.hopf import critical_k, estimate
from host.theory.analysis.phases import Phase
from host.theory.model.wheel import Array, Wheel, wheel_of
from host.theory.studies.phase_diagram_report import Numbers
from host.theory.studies.phase_diagram_rows import (
    Panel,
    PhaseDiagramRow,
    PointRow,
    of_panel,
    points,
)

PANELS = ("std", "mean")

Quantity = Literal["omega_std", "omega_mean"]
_QUANTITIES: tuple[tuple[Quantity, str], ...] = (
    ("omega_std", r"std($\omega$) (rad/s)"),
    ("omega_mean", r"$|\langle\omega\rangle|$ (rad/s)"),
)
# The phases that are named in each panel.
_NAMED: dict[Panel, tuple[Phase, ...]] = {"plane": ("LLM", "C"), "inset": ("S", "FB", "LLM")}
_DARK: Any = {"frameon": True, "facecolor": "#444444", "labelcolor": "white"}
# Where the inset and its colour bar are, in parts of the panel.
_INSET, _BAR = (0.47, 0.48, 0.4, 0.45), (0.885, 0.48, 0.02, 0.45)
# What is behind them, so that white words can be read: its corner and size.
_GROUND: Any = {"xy": (0.4, 0.4), "width": 0.585, "height": 0.56}
# Colours reach at least so far (rad/s), or rest would look like motion.
_LEAST = 0.1


def draw(rows: list[PhaseDiagramRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    diagram = points(rows)
    numbers: Numbers = findings.numbers
    wheel = wheel_of(numbers["constants"])
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(1, 2, sharey=True)
        for axes, (quantity, label) in zip(panels, _QUANTITIES, strict=True):
            image = _draw_panel(axes, diagram, "plane", quantity, wheel)
            figure.colorbar(image, ax=axes, label=label, location="top", shrink=0.8)
            _draw_edge_of_chaos(axes, of_panel(diagram, "plane", "down"))
            _draw_inset(figure, axes, diagram, quantity, wheel)
            axes.set_xlabel(r"spring constant $k$")
        figure.axes[0].set_ylabel(r"time constant $\tau$ (s)")
        figure.legend(
            *figure.axes[0].get_legend_handles_labels(),
            loc="outside lower center",
            ncols=3,
            fontsize=12,
            **_DARK,
        )
    return figure


def _draw_panel(
    axes: Axes, diagram: list[PointRow], panel: Panel, quantity: Quantity, wheel: Wheel
) -> Any:
    """A quantity over (k, tau), with the lines and the names of the phases; returns the image."""
    shown = of_panel(diagram, panel, diagram[0]["way"])
    ks, taus, values = _grid(shown, quantity)
    image = axes.imshow(
        values,
        origin="lower",
        extent=(0.0, float(ks[-1] + ks[0]), 0.0, float(taus[-1] + taus[0])),
        aspect="auto",
        vmin=0.0,
        vmax=max(_LEAST, float(np.nanmax(values))),
        cmap="inferno",
        interpolation="nearest",
    )
    _draw_lines(axes, wheel)
    if quantity == "omega_std":
        _name_phases(axes, shown, _NAMED[panel])
    return image


def _draw_inset(
    figure: Figure, axes: Axes, diagram: list[PointRow], quantity: Quantity, wheel: Wheel
) -> None:
    """The inset, with a colour bar of its own."""
    axes.add_patch(Rectangle(**_GROUND, facecolor="#333333", transform=axes.transAxes, zorder=3))
    inset, bar = axes.inset_axes(_INSET), axes.inset_axes(_BAR)
    figure.colorbar(_draw_panel(inset, diagram, "inset", quantity, wheel), cax=bar)
    for part in (inset, bar):
        part.tick_params(colors="white", labelsize=10)
        for spine in part.spines.values():
            spine.set(color="white", visible=True)


def _grid(rows: list[PointRow], name: Literal[Quantity, "chaotic"]) -> tuple[Array, Array, Array]:
    """k, (ks,), tau, (taus,), and the absolute values of a column, (taus, ks)."""
    ks, taus = np.unique([row["k"] for row in rows]), np.unique([row["tau"] for row in rows])
    values = np.full((len(taus), len(ks)), np.nan)
    values[
        np.searchsorted(taus, [row["tau"] for row in rows]),
        np.searchsorted(ks, [row["k"] for row in rows]),
    ] = [abs(row[name]) for row in rows]
    return ks, taus, values


def _draw_lines(axes: Axes, wheel: Wheel) -> None:
    (_, k_to), (_, tau_to) = axes.get_xlim(), axes.get_ylim()
    taus = np.geomspace(tau_to / 1000, tau_to, 400)
    if wheel.rods == 1:
        lines = [(critical_k, "whitesmoke", "rest at 90° becomes unstable; at 0° it never does")]
    else:
        lines = [
            (critical_k, "whitesmoke", "rest becomes unstable, exactly"),
            (estimate, "darkgrey", r"$k_c = 2f/(a\tau)$"),
        ]
    for line, colour, label in lines:
        axes.plot(
            [line(wheel._replace(tau=float(tau))) for tau in taus],
            taus,
            "--",
            color=colour,
            linewidth=1.5,
            label=label,
        )
    axes.set(xlim=(0.0, k_to), ylim=(0.0, tau_to))


def _draw_edge_of_chaos(axes: Axes, rows: list[PointRow]) -> None:
    """Where it is with k swept down, if it was; the picture itself has k swept up."""
    if any(row["chaotic"] for row in rows):
        axes.contour(
            *_grid(rows, "chaotic"),
            levels=[0.5],
            colors="deepskyblue",
            linestyles="dotted",
            linewidths=2.0,
        )
        axes.plot(
            [],
            [],
            ":",
            color="deepskyblue",
            linewidth=2.0,
            label="edge of chaos with $k$ swept down (picture: up)",
        )


def _name_phases(axes: Axes, rows: list[PointRow], names: tuple[Phase, ...]) -> None:
    """Each name in the middle of its phase, below the inset."""
    below = 0.39 * axes.get_ylim()[1]
    for name in names:
        own = [
            (row["k"], row["tau"]) for row in rows if row["phase"] == name and row["tau"] < below
        ]
        if len(own) > len(rows) / 100:
            k, tau = np.median(own, axis=0)
            axes.text(
                k, tau, name, color="white", fontsize=14, weight="bold", ha="center", va="center"
            )
