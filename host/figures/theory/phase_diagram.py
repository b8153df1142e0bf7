"""std(omega) and |mean(omega)| over (k, tau), with the inset, the phases, the lines between them, and what differs with k swept down."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.figures.style import SIZE, styled
from host.runs.contract import Findings, Row
from host.theory.analysis.hopf import critical_k, estimate
from host.theory.model.wheel import Array, Wheel
from host.theory.studies.phase_diagram import phases

_QUANTITIES = (
    ("omega_std", r"std($\omega$) (rad/s)"),
    ("omega_mean", r"$|\langle\omega\rangle|$ (rad/s)"),
)
_DARK: Any = {"frameon": True, "facecolor": "#444444", "labelcolor": "white"}
_INSET = (0.5, 0.48, 0.47, 0.45)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    diagram = [row for row in rows if row["panel"] != "accuracy"]
    for row, name in zip(diagram, phases(diagram, findings.numbers["constants"]), strict=True):
        row["chaotic"], row["phase"] = float(name == "C"), name
    constants = findings.numbers["constants"]
    wheel, way = (
        Wheel(a=constants["a"], friction=constants["f"], inertia=constants["I"]),
        diagram[0]["way"],
    )
    with styled():
        figure = Figure(**{**SIZE, "figsize": (12.5, 6.4)})
        for axes, (quantity, label) in zip(
            figure.subplots(1, 2, sharey=True), _QUANTITIES, strict=True
        ):
            inset = axes.inset_axes(_INSET)
            for own, panel in ((axes, "plane"), (inset, "inset")):
                shown = [row for row in diagram if row["panel"] == panel]
                image = _draw(own, [row for row in shown if row["way"] == way], quantity)
                _draw_lines(own, wheel)
                if panel == "plane":
                    figure.colorbar(image, ax=axes, label=label, location="top", shrink=0.8)
                    _draw_edge_of_chaos(own, [row for row in shown if row["way"] == "down"])
                if quantity == "omega_std":
                    _name_phases(
                        own,
                        [row for row in shown if row["way"] == way],
                        ("S", "FB", "LLM") if own is inset else ("LLM", "C"),
                    )
            inset.set_title(
                f"colours to {image.get_clim()[1]:.2g} rad/s", color="white", fontsize=10, pad=3
            )
            inset.tick_params(colors="white", labelsize=10)
            for spine in inset.spines.values():
                spine.set(color="white", visible=True)
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


def _grid(rows: list[Row], name: str) -> tuple[Array, Array, Array]:
    """(k, tau, |values| (tau, k)) of a panel's rows."""
    ks, taus = (np.unique([row[axis] for row in rows]) for axis in ("k", "tau"))
    values = np.full((len(taus), len(ks)), np.nan)
    values[
        np.searchsorted(taus, [row["tau"] for row in rows]),
        np.searchsorted(ks, [row["k"] for row in rows]),
    ] = [abs(row[name]) for row in rows]
    return ks, taus, values


def _draw(axes: Axes, rows: list[Row], quantity: str) -> Any:
    ks, taus, values = _grid(rows, quantity)
    extent = (0.0, float(ks[-1] + ks[0]), 0.0, float(taus[-1] + taus[0]))
    return axes.imshow(
        values,
        origin="lower",
        extent=extent,
        aspect="auto",
        vmin=0.0,
        cmap="inferno",
        interpolation="nearest",
    )


def _draw_lines(axes: Axes, wheel: Wheel) -> None:
    (_, k_to), (_, tau_to) = axes.get_xlim(), axes.get_ylim()
    taus = np.geomspace(tau_to / 1000, tau_to, 400)
    lines = (
        (critical_k, "whitesmoke", "rest becomes unstable, exactly"),
        (estimate, "darkgrey", r"$k_c = 2f/(a\tau)$"),
    )
    for line, colour, label in lines:
        axes.plot(
            [line(wheel._replace(tau_s=float(tau))) for tau in taus],
            taus,
            "--",
            color=colour,
            linewidth=1.5,
            label=label,
        )
    axes.set(xlim=(0.0, k_to), ylim=(0.0, tau_to))


def _draw_edge_of_chaos(axes: Axes, rows: list[Row]) -> None:
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


def _name_phases(axes: Axes, rows: list[Row], names: tuple[str, ...]) -> None:
    """Each name in the middle of its phase, below the inset."""
    below = 0.5 * axes.get_ylim()[1]
    for name in names:
        own = [
            (row["k"], row["tau"]) for row in rows if row["phase"] == name and row["tau"] < below
        ]
        if len(own) > len(rows) / 100:
            k, tau = np.median(own, axis=0)
            axes.text(
                k, tau, name, color="white", fontsize=14, weight="bold", ha="center", va="center"
            )
