"""Basins of starts in (phi, omega) and of kicks in phase and length, for both models."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from host.theory.analysis.outcomes import BACK, BACKWARD, FORWARD, OTHER, REST, Outcome
from host.theory.studies.basins import rolls
from host.theory.studies.basins_report import Numbers, reversals
from host.theory.studies.basins_rows import (
    CONTINUOUS,
    LENGTHS_S,
    MODEL_NAMES,
    SAMPLED,
    BasinsRow,
    KickRow,
    ModelName,
    StartRow,
    kicks_of,
    starts_of,
)
from robot.kicks import MEMBRANE, PHASE, POSITION

_LABELS = {(POSITION, 0): "position", (PHASE, 1): "phase-plus", (PHASE, -1): "phase-minus"}
_KINDS = {
    (POSITION, 0): "positions inverted",
    (PHASE, 1): r"phase shifted $+3\pi/4$",
    (PHASE, -1): r"phase shifted $-3\pi/4$",
}
# Wells, by their angle within the turn; then directions; then what is neither.
# Their lightness differs, too.
_WELLS = ("#006d4f", "#f0e442", "#cc79a7", "#e5e5e5")
_SHADES = (*_WELLS, COLOURS[0], COLOURS[4], "#111111", "#ffffff")
_SHADE_OF: dict[Outcome, int] = {FORWARD: 4, BACKWARD: 5, OTHER: 6, REST: 7, BACK: 7}
_CURVES: dict[ModelName, Any] = {
    CONTINUOUS: {"color": "black"},
    SAMPLED: {"color": COLOURS[2], "marker": "o", "linestyle": "", "markersize": 5},
}
_MAP = ListedColormap(_SHADES)
# Which slice of the four dimensions is shown (host.theory.analysis.outcomes.starting_states).
_SLICE = (
    r"Starts: in the slice with the potentials of rest at their angle,"
    r" $x_1 = \cos\varphi$, $x_2 = \sin\varphi$."
)


def panels(options: Mapping[str, Any]) -> list[str]:
    """The names of the panels; those of kicks are missing if no wheel rolls."""
    starts = [_starts_label(model) for model in MODEL_NAMES]
    if not rolls(options):
        return starts
    return [
        *starts,
        *(_kicks_label(kind, model) for model in MODEL_NAMES for kind in _LABELS),
        *(_reversed_label(kind) for kind in _LABELS),
    ]


def _starts_label(model: ModelName) -> str:
    return f"starts-{model}"


def _kicks_label(kind: tuple[str, int], model: ModelName) -> str:
    return f"kicks-{_LABELS[kind]}-{model}"


def _reversed_label(kind: tuple[str, int]) -> str:
    return f"reversed-{_LABELS[kind]}"


def draw(rows: list[BasinsRow], findings: Findings) -> Figure:
    """The figure of the study's rows; without the kicks, if no wheel rolls."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        if len(numbers["no_wheel_rolls"]) == len(MODEL_NAMES):
            grid: Any = figure.subplots(1, 2, sharey=True)
            used = _draw_basins(grid, rows, findings)
            figure.legend(
                handles=_patches(used),
                loc="outside lower center",
                ncols=4,
                title=_SLICE,
                title_fontsize=11,
            )
            figure.suptitle(
                "Which start leads where; at these constants no wheel rolls that could be kicked",
                fontsize=17,
            )
            return figure
        grid = figure.subplots(3, 4, width_ratios=(1.5, 1, 1, 1))
        figure.supxlabel(_SLICE, fontsize=11)
        for axes in grid.flat:
            axes.tick_params(labelsize=10)
        used = _draw_basins(grid[:2, 0], rows, findings)
        for line, model in zip(grid, MODEL_NAMES, strict=False):
            for axes, kind in zip(line[1:], _KINDS, strict=True):
                axes.set_label(_kicks_label(kind, model))
                used |= _draw_kicks(axes, kicks_of(rows, model, *kind), model)
                axes.set_ylabel(f"{model}:\nlength (ms)", fontsize=11)
                axes.set_xlabel("phase of rolling (°)", fontsize=11)
        for (top, _, bottom), (kind, name) in zip(grid[:, 1:].T, _KINDS.items(), strict=True):
            top.set_title(name, fontsize=12)
            bottom.set_label(_reversed_label(kind))
            _draw_shares(bottom, rows, kind)
            bottom.set_ylabel("reversed (%)", fontsize=11)
        _explain(grid[2, 0], used, rows)
        figure.suptitle(
            "Which start, and which kick of a wheel that rolls forward, leads where", fontsize=17
        )
    return figure


def _draw_basins(panels: Any, rows: list[BasinsRow], findings: Findings) -> set[int]:
    """The starts of both models; returns the shades that were used."""
    titles = {
        CONTINUOUS: "starts, continuous model",
        SAMPLED: f"starts, sampled every {1000 * findings.numbers['tick_s']:g} ms",
    }
    used: set[int] = set()
    for axes, (model, title) in zip(panels, titles.items(), strict=True):
        axes.set_label(_starts_label(model))
        used |= _draw_starts(axes, starts_of(rows, model))
        axes.set_title(title, fontsize=12)
        axes.set_xlabel(r"angle $\varphi$ at the start", fontsize=11)
        axes.set_ylabel("$\\omega/2\\pi$ at\nthe start (Hz)", fontsize=11)
    return used


def _shade(outcome: Outcome, quarters: int | None = None) -> int:
    """The number of a shade; quarters: the number of the well, if a wheel ends in one."""
    if outcome in (REST, BACK) and quarters is not None:
        return quarters % 4
    return _SHADE_OF[outcome]


def _draw_starts(axes: Axes, starts: list[StartRow]) -> set[int]:
    points = int(len(starts) ** 0.5)
    shades = np.array([_shade(row["outcome"], row["quarters"]) for row in starts])
    shades = shades.reshape(points, points)
    greatest = abs(starts[0]["omega"]) * points / (points - 1) / (2 * pi)
    axes.imshow(shades, extent=(-pi, pi, -greatest, greatest), vmin=-0.5, vmax=7.5, **_image())
    axes.set_xticks(
        [-pi, -pi / 2, 0, pi / 2, pi], ["$-\\pi$", "$-\\pi/2$", "0", "$\\pi/2$", "$\\pi$"]
    )
    return set(shades.ravel().tolist())


def _image() -> dict[str, Any]:
    return {"origin": "lower", "aspect": "auto", "cmap": _MAP, "interpolation": "nearest"}


def _draw_kicks(axes: Axes, kicks: list[KickRow], model: ModelName) -> set[int]:
    """Outcomes over length and phase, whose values need not be evenly spaced."""
    lengths_ms = 1000 * np.array(LENGTHS_S[model])
    axes.set(xlim=(0, 90), ylim=(0, 400), xticks=(0, 30, 60, 90))
    if not kicks:
        axes.text(45, 200, "no wheel rolls here", ha="center")
        return set()
    phases = np.array([row["phase_deg"] for row in kicks[: len(kicks) // len(lengths_ms)]])
    shades = np.array([_shade(row["outcome"]) for row in kicks]).reshape(len(lengths_ms), -1)
    half = (lengths_ms[1] - lengths_ms[0]) / 2
    sides = np.concatenate([[0.0], (phases[1:] + phases[:-1]) / 2, [90.0]])
    axes.pcolormesh(
        sides,
        np.append(lengths_ms - half, lengths_ms[-1] + half),
        shades,
        cmap=_MAP,
        vmin=-0.5,
        vmax=7.5,
        rasterized=True,
    )
    return set(shades.ravel().tolist())


def _draw_shares(axes: Axes, rows: list[BasinsRow], kind: tuple[str, int]) -> None:
    for model, style in _CURVES.items():
        shares = reversals(kicks_of(rows, model, *kind))
        axes.plot(
            [1000 * length_s for length_s in shares],
            [100 * share for share in shares.values()],
            **style,
        )
    axes.set_xlabel("length of the kick (ms)", fontsize=11)
    axes.set(xlim=(0, 400), ylim=(-3, 103))


def _patches(used: set[int]) -> list[Artist]:
    """What the shades mean."""
    names = [f"bound to $\\varphi$ = {name}" for name in ("0", "$\\pi/2$", "$\\pi$", "$-\\pi/2$")]
    names += [
        "rolls forward",
        "rolls backward",
        "irregular, or not settled",
        "rests, or goes forth and back",
    ]
    return [
        Patch(facecolor=_SHADES[shade], edgecolor="grey", label=names[shade])
        for shade in sorted(used)
    ]


def _explain(axes: Axes, used: set[int], rows: list[BasinsRow]) -> None:
    """What the shades and the curves mean, and what the kick without a length does."""
    handles = [
        *_patches(used),
        *(Line2D([], [], label=f"reversed, {model}", **style) for model, style in _CURVES.items()),
    ]
    shares = {
        model: reversals(kicks_of(rows, model, MEMBRANE, 0)).values() for model in MODEL_NAMES
    }
    lines = [
        f"{model}: at {100 * share:.0f} % of phases"
        for model, of_model in shares.items()
        for share in of_model
    ]
    title = "\n".join(["Inverted potentials reverse a wheel", *lines, ""])
    axes.set_axis_off()
    legend = axes.legend(
        handles=handles,
        loc="upper left",
        title=title,
        fontsize=10.5,
        title_fontsize=10.5,
        alignment="left",
        borderaxespad=0.0,
    )
    legend.set_in_layout(False)
