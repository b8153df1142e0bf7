"""Branches of forth-and-back cycles and rotations, with their bifurcations.

Stable parts are solid, unstable ones dashed.
"""

from __future__ import annotations

from itertools import groupby, pairwise
from math import pi
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from host.figures.style import COLOURS, SIZE, say_if_empty, share_legend, styled
from host.figures.theory.branch_panels import DASHED, draw_line, draw_turning
from host.runs.contract import Findings
from host.theory.studies import branch_tables as tables
from host.theory.studies.branch_report import Numbers
from host.theory.studies.branch_rows import WAYS, CyclePart, Part
from host.theory.studies.branch_tables import BranchRow, CycleRow, SpecialRow

PANELS = ("rotations", "onset", "swinging", "periods", "merging", "potentials")

Quantity = Literal["omega_mean", "amplitude", "period"]

_COLOUR: dict[Part, str] = {
    "fixpoints": COLOURS[6],
    "merging": COLOURS[6],
    "FB": COLOURS[2],
    "LLM": COLOURS[0],
    "dry": COLOURS[1],
}
_NAME: dict[CyclePart, str] = {
    "FB": "forth and back (FB)",
    "LLM": "rotation (LLM)",
    "dry": "rotation with dry friction",
}
# Marker and name of each type of bifurcation.
_MARK = {
    "hopf": ("o", "Hopf"),
    "merging": ("*", "merging"),
    "fold": ("D", "fold"),
    "neimark-sacker": ("s", "Neimark-Sacker"),
    "pitchfork": ("^", "pitchfork"),
}
_LETTER = {
    "k": "spring constant $k$",
    "tau": r"time constant $\tau$ (s)",
    "a": "gain $a$",
    "I": "inertia $I$",
    "f": "friction $f$",
}
# Rotations with dry friction are thinner, so that they stand out without colours, too.
_WIDTH: dict[CyclePart, float] = {"FB": 1.8, "LLM": 2.4, "dry": 1.1}
_MARKED: Any = {"linestyle": "", "markerfacecolor": "white", "zorder": 4}


def draw(rows: list[BranchRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    along = numbers["along"]
    with styled():
        figure = Figure(**SIZE)
        wide, near, swing, period, line, turning = figure.subplots(2, 3).flat
        for axes, name, label in (
            (wide, "rotations", r"mean $\omega$ (rad/s)"),
            (near, "rest, and rotations both ways", r"mean $\omega$ (rad/s)"),
            (swing, "forth-and-back cycles", r"amplitude of $\varphi$ (rad)"),
            (period, "periods", "period (s)"),
        ):
            axes.set_title(name, fontsize=12)
            axes.set_xlabel(_LETTER[along], fontsize=12)
            axes.set_ylabel(label, fontsize=12)
        _draw_formula(wide, rows)
        _draw_branches(wide, rows, "omega_mean", ("LLM", "dry"))
        for sign in (1.0, -1.0):
            _draw_branches(near, rows, "omega_mean", ("LLM", "dry"), sign)
        _draw_rest(near, rows)
        _draw_rest(swing, rows)
        _draw_saddle(swing)
        _draw_branches(swing, rows, "amplitude", ("FB",))
        _draw_branches(period, rows, "period", ("FB", "LLM", "dry"))
        period.set_yscale("log")
        period.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        period.yaxis.set_major_formatter("{x:g}")
        period.yaxis.set_minor_formatter("")
        for row in tables.special_points(rows):
            if row["type"] == "merging":
                _mark(near, row, 0.0)
        for row in tables.mergings(rows, "merging"):
            _mark(swing, row, pi / 4)
        _zoom(rows, near, swing, period)
        if along == "k":  # as the paper's figure of the robot
            near.set_xlim(left=0.0)
        families: tuple[tuple[Axes, CyclePart], ...] = ((wide, "LLM"), (swing, "FB"))
        for axes, family in families:
            if not tables.cycles_of(rows, family):
                axes.set_title(f"{axes.get_title()}: none was found", fontsize=12)
        say_if_empty(period, "no cycle was found")
        draw_line(line, tables.merging_line(rows))
        draw_turning(turning, tables.turned_at(rows))
        for axes in (wide, near, swing, period, line, turning):
            axes.tick_params(labelsize=11)
        _explain(figure, (wide, near, swing))
        figure.suptitle(_headline(along, numbers["mergings"]), fontsize=15)
    return figure


def _explain(figure: Figure, panels: tuple[Axes, ...]) -> None:
    """One legend: a line for each branch, a black marker for each bifurcation."""
    for axes in panels:
        if any(line.get_linestyle() == "--" for line in axes.get_lines()):
            axes.plot([], [], color="black", linestyle=DASHED, label="unstable")
        for marker, name in _MARK.values():
            if name in axes.get_legend_handles_labels()[1]:
                axes.plot([], [], marker, color="black", label=name, **_MARKED)
    share_legend(
        figure, panels, loc="outside lower center", ncols=6, fontsize=11, columnspacing=1.4
    )


def _headline(along: str, mergings: list[float]) -> str:
    where = f"do not merge in this range of {along}"
    if mergings:
        where = f"merge at {along} = {mergings[0]:.8g}"
    return f"Forth-and-back cycles and rotations {where}"


def _draw_branches(
    axes: Axes,
    rows: list[BranchRow],
    quantity: Quantity,
    parts: tuple[CyclePart, ...],
    sign: float = 1.0,
) -> None:
    """Branches and their bifurcations. sign: of the height, -1 for rotations backward."""
    for part in parts:
        for way in WAYS:
            cycles = tables.cycles_along(rows, part, way)
            ends = [
                row["value"]
                for row in tables.ends(rows)
                if row["type"] == "merging" and (row["part"], row["way"]) == (part, way)
            ]
            _draw_cycles(axes, cycles, quantity, part, ends, sign)
        for point in tables.cycle_points(rows):
            if point["part"] == part:
                height = point[quantity]
                _mark(axes, point, None if height is None else sign * height)


def _draw_cycles(
    axes: Axes,
    cycles: list[CycleRow],
    quantity: Quantity,
    part: CyclePart,
    ends: list[float],
    sign: float,
) -> None:
    """Cycles along one way, stretch by stretch. ends: where the way ends in a merging."""
    last: list[CycleRow] = []
    for stable, group in groupby(cycles, key=lambda row: row["stable"]):
        points = list(group)
        stretch = last + points  # joined to the one before it
        style: Any = {
            "color": _COLOUR[part],
            "linestyle": "-" if stable else DASHED,
            "linewidth": _WIDTH[part],
            "label": _NAME[part] if stable else None,
        }
        heights = sign * np.array([row[quantity] for row in stretch], dtype=float)
        axes.plot([row["value"] for row in stretch], heights, **style)
        last = points[-1:]
        if quantity == "omega_mean" and points[-1] is cycles[-1]:
            # At a merging rotations end at rest, and logarithmically so.
            axes.plot(
                [points[-1]["value"], *ends][-2:],
                [sign * points[-1]["omega_mean"], 0.0][: 1 + len(ends)],
                **{**style, "label": None},
            )


def _mark(axes: Axes, row: SpecialRow, height: float | None) -> None:
    marker, name = _MARK[row["type"]]
    axes.plot(
        row["value"],
        np.nan if height is None else height,
        marker=marker,
        color=_COLOUR[row["part"]],
        markersize=13 if row["type"] == "merging" else 8,
        label=name,
        **_MARKED,
    )


def _draw_formula(axes: Axes, rows: list[BranchRow]) -> None:
    known = [(row["value"], row["formula"]) for row in tables.rests(rows)]
    known += [(row["value"], row["formula"]) for row in tables.cycles_of(rows, "LLM")]
    known += [
        (row["value"], row["formula"]) for row in tables.cycle_points(rows) if row["part"] == "LLM"
    ]
    points = sorted((value, formula) for value, formula in known if formula is not None)
    axes.plot(
        [value for value, _ in points],
        [formula for _, formula in points],
        color="grey",
        linestyle=":",
        label="constant velocity, formula",
    )


def _draw_rest(axes: Axes, rows: list[BranchRow]) -> None:
    """The fixpoint at 0."""
    hopfs = tables.hopfs(rows)
    points: list[tuple[float, bool | None]] = [
        (row["value"], row["stable"]) for row in tables.rests(rows) if row["phi"] == 0.0
    ]
    points += [(row["value"], None) for row in hopfs]
    points.sort(key=lambda point: point[0])
    for (low, stable_below), (high, stable_above) in pairwise(points):
        stable = stable_below if stable_above is None else stable_above
        axes.plot(
            [low, high],
            [0.0, 0.0],
            color=_COLOUR["fixpoints"],
            linestyle="-" if stable else DASHED,
            label="rest" if stable else None,
        )
    for row in hopfs:
        _mark(axes, row, 0.0)


def _draw_saddle(axes: Axes) -> None:
    axes.axhline(pi / 4, color=_COLOUR["fixpoints"], linestyle=DASHED)
    axes.set_ylim(top=1.2 * pi / 4)
    place: Any = {"transform": axes.get_yaxis_transform(), "ha": "center", "va": "bottom"}
    axes.text(0.5, pi / 4 + 0.02, "saddle", fontsize=11, **place)


def _zoom(rows: list[BranchRow], near: Axes, swing: Axes, period: Axes) -> None:
    """Three panels show where bifurcations crowd; if there are none, all of the branches."""
    special = tables.special_points(rows)
    places = [row["value"] for row in special if row["type"] in ("hopf", "merging", "fold")]
    swinging = [row["value"] for row in tables.cycles_of(rows, "FB")]
    if not places:
        return
    low, high = min(places + swinging), max(places)
    margin = 0.25 * max(high - low, 0.02 * high)
    for axes in (near, period):
        axes.set_xlim(low - margin, high + margin)
    inside = [row for row in tables.cycles(rows) if low - margin < row["value"] < high + margin]
    speeds = [row["omega_mean"] for row in inside if row["part"] != "FB"]
    if speeds:
        near.set_ylim(-1.08 * max(speeds), 1.08 * max(speeds))
    periods = [row["period"] for row in inside]
    if periods:
        period.set_ylim(0.9 * min(periods), 1.2 * max(periods))
    own = swinging + [row["value"] for row in special if row["part"] in ("fixpoints", "merging")]
    if own:
        wide = max(max(own) - min(own), 0.01 * max(own))
        swing.set_xlim(min(own) - 0.2 * wide, max(own) + 0.2 * wide)
