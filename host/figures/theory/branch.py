"""Branches of forth-and-back cycles and rotations.

Stable parts solid, unstable dashed, with their bifurcations.
"""

from __future__ import annotations

from itertools import groupby, pairwise
from math import degrees, pi
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from host.figures.style import COLOURS, styled
from host.runs.contract import Findings, Row

_COLOUR = {
    "fixpoints": COLOURS[6],
    "merging": COLOURS[6],
    "FB": COLOURS[2],
    "LLM": COLOURS[0],
    "dry": COLOURS[1],
}
_NAME = {"FB": "forth and back (FB)", "LLM": "rotation (LLM)", "dry": "rotation with dry friction"}
_MARK = {"hopf": "o", "merging": "*", "fold": "D", "neimark-sacker": "s", "pitchfork": "^"}
_TYPE = {
    "hopf": "Hopf",
    "merging": "merging",
    "fold": "fold",
    "neimark-sacker": "Neimark-Sacker",
    "pitchfork": "pitchfork",
}
_LETTER = {
    "k": "spring constant $k$",
    "tau": r"time constant $\tau$ (s)",
    "a": "gain $a$",
    "I": "inertia $I$",
    "f": "friction $f$",
}
_DASHED: Any = (0, (2.5, 1.2))
_SIZE: Any = {"figsize": (10.0, 7.4), "dpi": 160, "layout": "constrained"}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    along, mergings = findings.numbers["along"], findings.numbers["mergings"]
    with styled():
        figure = Figure(**_SIZE)
        panels = figure.subplots(2, 3).flat
        wide, near, swing, period, line, turning = panels
        for axes, name, label in (
            (wide, "rotations", r"mean $\omega$ (rad/s)"),
            (near, "rotations, at their onset", r"mean $\omega$ (rad/s)"),
            (swing, "forth-and-back cycles", r"amplitude of $\varphi$ (rad)"),
            (period, "periods", "period (s)"),
        ):
            axes.set_title(name, fontsize=12)
            axes.set_xlabel(_LETTER[along], fontsize=12)
            axes.set_ylabel(label, fontsize=12)
        _draw_formula(wide, rows)
        for axes in (wide, near):
            _draw_branches(axes, rows, "omega_mean", ("LLM", "dry"))
        _draw_rest(swing, rows)
        _draw_branches(swing, rows, "amplitude", ("FB",))
        _draw_branches(period, rows, "period", ("FB", "LLM", "dry"))
        period.set_yscale("log")
        period.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        period.yaxis.set_major_formatter("{x:g}")
        period.yaxis.set_minor_formatter("")
        for axes, height in ((near, 0.0), (swing, pi / 4)):
            for row in rows:
                if (
                    row["kind"] == "special"
                    and row["type"] == "merging"
                    and (axes is near or row["part"] == "merging")
                ):
                    _mark(axes, row, height)
        _zoom(rows, near, swing, period)
        _draw_line(line, rows)
        _draw_turning(turning, rows)
        for axes in (wide, near, swing, period, line, turning):
            axes.tick_params(labelsize=11)
        known = {
            label: handle
            for axes in (wide, near, swing)
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(
            known.values(),
            known.keys(),
            loc="outside lower center",
            ncols=4,
            fontsize=11,
            columnspacing=1.4,
        )
        where = (
            f"merge at {along} = {mergings[0]:.8g}"
            if mergings
            else f"do not merge in this range of {along}"
        )
        figure.suptitle(f"Forth-and-back cycles and rotations {where}", fontsize=15)
    return figure


def _draw_branches(axes: Axes, rows: list[Row], quantity: str, parts: tuple[str, ...]) -> None:
    for part in parts:
        for way in ("down", "up", None):
            cycles = [
                row
                for row in rows
                if row["part"] == part and row["kind"] == "cycle" and row["way"] == way
            ]
            last: list[Row] = []
            for stable, group in groupby(cycles, key=lambda row: bool(row["stable"])):
                points = list(group)
                stretch = last + points  # joined to the one before it
                label = _NAME[part] + ("" if stable else ", unstable")
                style: Any = {
                    "color": _COLOUR[part],
                    "linestyle": "-" if stable else _DASHED,
                    "label": label,
                }
                axes.plot(
                    [row["value"] for row in stretch], [row[quantity] for row in stretch], **style
                )
                last = points[-1:]
                if (
                    quantity == "omega_mean" and points[-1] is cycles[-1]
                ):  # at a merging they end at rest, and logarithmically so
                    ends = [row["value"] for row in rows if _ends_in_merging(row, part, way)]
                    axes.plot(
                        [points[-1]["value"], *ends][-2:],
                        [points[-1][quantity], 0.0][: 1 + len(ends)],
                        **style,
                    )
        for row in rows:
            if row["part"] == part and row["kind"] == "special" and row["type"] != "merging":
                _mark(axes, row, row[quantity])


def _ends_in_merging(row: Row, part: str, way: str | None) -> bool:
    return bool(
        row["kind"] == "end"
        and row["type"] == "merging"
        and row["part"] == part
        and row["way"] == way
    )


def _mark(axes: Axes, row: Row, height: float) -> None:
    style: Any = {
        "linestyle": "",
        "marker": _MARK[row["type"]],
        "color": _COLOUR[row["part"]],
        "markerfacecolor": "white",
    }
    size = 13 if row["type"] == "merging" else 8
    label = _TYPE[row["type"]] + (", dry friction" if row["part"] == "dry" else "")
    axes.plot([row["value"]], [height], label=label, zorder=4, markersize=size, **style)


def _draw_formula(axes: Axes, rows: list[Row]) -> None:
    known = sorted(
        (row["value"], row["formula"])
        for row in rows
        if row.get("formula") is not None and row["part"] in ("fixpoints", "LLM")
    )
    axes.plot(
        *zip(*known, strict=True) if known else ([], []),
        color="grey",
        linestyle=":",
        label="constant velocity, formula",
    )


def _draw_rest(axes: Axes, rows: list[Row]) -> None:
    """The fixpoint at 0, and the saddle at pi/4."""
    hopfs = [
        (row["value"], None) for row in rows if row["kind"] == "special" and row["type"] == "hopf"
    ]
    rest = [
        (row["value"], bool(row["stable"]))
        for row in rows
        if row["kind"] == "fixpoint" and row["phi"] == 0.0
    ]
    points = sorted([*rest, *hopfs], key=lambda point: float(point[0]))
    for (begin, before), (end, after) in pairwise(points):
        stable = before if after is None else after
        label = "rest" if stable else "rest, unstable"
        axes.plot(
            [begin, end],
            [0.0, 0.0],
            color=_COLOUR["fixpoints"],
            linestyle="-" if stable else _DASHED,
            label=label,
        )
    axes.axhline(pi / 4, color=_COLOUR["fixpoints"], linestyle=_DASHED)
    axes.text(
        0.02, pi / 4 - 0.02, "saddle", transform=axes.get_yaxis_transform(), va="top", fontsize=11
    )
    for row in rows:
        if row["kind"] == "special" and row["type"] == "hopf":
            _mark(axes, row, 0.0)


def _zoom(rows: list[Row], near: Axes, swing: Axes, period: Axes) -> None:
    """The three panels of the onset show where bifurcations crowd.

    If there are none, all of the branches.
    """
    places = [
        row["value"]
        for row in rows
        if row["kind"] == "special" and row["type"] in ("hopf", "merging", "fold")
    ]
    swinging = [row["value"] for row in rows if row["kind"] == "cycle" and row["part"] == "FB"]
    if not places:
        return
    begin, end = min(places + swinging), max(places)
    margin = 0.25 * max(end - begin, 0.02 * end)
    for axes in (near, period):
        axes.set_xlim(begin - margin, end + margin)
    inside = [
        row
        for row in rows
        if row["kind"] == "cycle"
        and row["part"] in ("LLM", "dry")
        and begin - margin < row["value"] < end + margin
    ]
    if inside:
        most = max(row["omega_mean"] for row in inside)
        near.set_ylim(-0.06 * most, 1.08 * most)
    longest = [
        row["period"]
        for row in rows
        if row["kind"] == "cycle" and begin - margin < row["value"] < end + margin
    ]
    if longest:
        period.set_ylim(0.9 * min(longest), 1.2 * max(longest))
    own = swinging + [
        row["value"]
        for row in rows
        if row["kind"] == "special" and row["part"] in ("fixpoints", "merging")
    ]
    if own:
        wide = max(max(own) - min(own), 0.01 * max(own))
        swing.set_xlim(min(own) - 0.2 * wide, max(own) + 0.2 * wide)


def _draw_line(axes: Axes, rows: list[Row]) -> None:
    """The merging in units of the Hopf bifurcation's k, by the sign of the saddle quantity."""
    line = [row for row in rows if row["kind"] == "line"]
    last: list[Row] = []
    for folds, group in groupby(line, key=lambda row: bool(row["saddle_quantity"] > 0.0)):
        points = list(group)
        stretch = last + points
        label, colour = (
            ("unstable cycles, folds", COLOURS[3]) if folds else ("stable cycles", COLOURS[5])
        )
        axes.plot(
            [row["tau"] for row in stretch],
            [row["k"] / row["k_hopf"] for row in stretch],
            color=colour,
            linewidth=2.5,
            label=label,
        )
        last = points[-1:]
    axes.axhline(1.0, color="black", linewidth=1.0)
    axes.set_title(r"the merging over $\tau$", fontsize=12)
    axes.set(xscale="log")
    axes.set_xlabel(r"time constant $\tau$ (s)", fontsize=12)
    axes.set_ylabel("$k_\\mathrm{merging} / k_\\mathrm{Hopf}$", fontsize=12)
    if line:
        axes.legend(
            fontsize=10.5,
            title="near the merging:",
            title_fontsize=10.5,
            loc="upper right",
            handlelength=1.0,
        )


def _draw_turning(axes: Axes, rows: list[Row]) -> None:
    """x1 of a turned wheel: formula, numbers, and the wheel that rolls by itself."""
    turning = [row for row in rows if row["kind"] == "turning"]
    dotted: Any = {"linestyle": "", "marker": "."}
    for colour, k in zip(COLOURS, sorted({row["k"] for row in turning}), strict=False):
        own = sorted((row for row in turning if row["k"] == k), key=lambda row: float(row["phi"]))
        angles = [degrees(row["phi"]) for row in own]
        axes.plot(angles, [row["x1"] for row in own], color=colour, label=f"$k$ = {k:g}")
        dots = own[:: max(1, len(own) // 24)]
        axes.plot(
            [degrees(row["phi"]) for row in dots],
            [row["x1_numeric"] for row in dots],
            color=colour,
            **dotted,
        )
        if own[0]["x1_rolling"] is not None:
            axes.plot(angles, [row["x1_rolling"] for row in own], color=colour, linestyle=_DASHED)
    axes.set_title(
        "potentials: formula, numbers ($\\bullet$),\nand of a rolling wheel (dashed)", fontsize=12
    )
    axes.set_xlabel(r"angle $\varphi$ (°)", fontsize=12)
    axes.set_ylabel("$x_1$", fontsize=12)
    axes.set_xticks((0, 90, 180, 270, 360))
    axes.legend(fontsize=10.5, loc="upper center", handlelength=1.0)
