"""The torque in the chaotic mode, the return map of its turning points, how long switching lasts, how twins part, where it is chaotic."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.chaos import (
    SEEN,
    TAU_S,
    TWIN_S,
    UNSEEN,
    by_part,
    chosen,
    column,
    intervals_s,
    is_chaotic,
)
from host.experiments.robot.switching import CONDITIONS, DELAYED, ORDINARY, SWITCHES, switches
from host.figures.robot.kick import STALL_TORQUE
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row
from sim_motor.settling import COUNT_RAD

STRETCH_S = 20.0
_BEGINS_S = {ORDINARY: 0.0, DELAYED: 60.0}
_TWINS = (
    (DELAYED, SEEN, DELAYED, (2.0, 0.8)),
    (ORDINARY, SEEN, ORDINARY, (8.5, 2e-3)),
    (DELAYED, UNSEEN, "below the steps", (2.4, 1e-7)),
)
_SMALL = 11
_ABOVE: Any = {
    "loc": "lower left",
    "bbox_to_anchor": (0.0, 1.0),
    "fontsize": _SMALL,
    "borderaxespad": 0.2,
    "columnspacing": 1.2,
}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows.

    Of a robot its two wheels, of a simulated one also the conditions, the twins and the map.
    """
    parts = by_part(rows)
    explained = bool(parts["map"])
    wheels = list(dict.fromkeys((row["condition"], row["side"]) for row in parts["series"]))
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 16.0 if explained else 9.0)})
        grid = figure.add_gridspec(
            5 if explained else 3, 2, height_ratios=(2, 2, 4, 4, 3) if explained else (2, 2, 4)
        )
        for place, (condition, side) in enumerate(wheels):
            series = chosen(parts["series"], condition=condition, side=side)
            _draw_torque(
                figure.add_subplot(grid[place, :]),
                series,
                condition if explained else f"{side} wheel",
                _BEGINS_S[condition],
            )
        shown = [
            chosen(parts["series"], condition=condition, side=side)
            for condition, side in (wheels[1:] if explained else wheels)
        ]
        _draw_return_map(figure.add_subplot(grid[2, 0]), shown)
        if explained:
            _draw_twins(figure.add_subplot(grid[2, 1]), parts["twins"])
            _draw_lives(
                figure.add_subplot(grid[3, :]),
                parts["lives"],
                max(row["t_s"] for row in parts["series"]),
            )
            _draw_map(figure.add_subplot(grid[4, :]), parts["map"])
        else:
            _draw_intervals(figure.add_subplot(grid[2, 1]), shown)
        figure.suptitle("$k$ = 15, $\\tau$ = 1 s: do the wheels switch irregularly?", fontsize=16)
    return figure


def _draw_torque(axes: Axes, series: list[Row], title: str, begin_s: float) -> None:
    """A readable stretch, from begin_s or as late as there is one."""
    t_s, torque = column(series, "t_s"), column(series, "torque")
    begin_s = max(0.0, min(begin_s, t_s[-1] - STRETCH_S))
    inside = (t_s >= begin_s) & (t_s <= begin_s + STRETCH_S)
    axes.axhspan(-STALL_TORQUE, STALL_TORQUE, color="lightgrey", linewidth=0)
    axes.plot(t_s[inside], torque[inside], color="black", linewidth=1.4, drawstyle="steps-post")
    axes.set_xlim(begin_s, begin_s + STRETCH_S)
    axes.set_ylim(-1.15, 1.15)
    axes.set_ylabel("torque $M$")
    axes.set_xlabel("time (s)")
    axes.set_title(f"{title} (grey: the motor stalls)", fontsize=13, loc="left")


def _draw_return_map(axes: Axes, shown: list[list[Row]]) -> None:
    """Angles of successive turning points, but for quarter turns, after which the two rods are as before."""
    for series, colour in zip(shown, COLOURS, strict=False):
        phi = column(series, "phi_rad")
        angles = np.degrees(phi[switches(phi)] % (pi / 2))
        axes.plot(angles[:-1], angles[1:], ".", color=colour, markersize=4)
    axes.set_xlabel("angle of a turning point, modulo 90 (deg)")
    axes.set_ylabel("angle of the next (deg)")
    axes.set_xticks((0, 30, 60, 90))
    axes.set_yticks((0, 30, 60, 90))
    axes.set_title(
        "return map" + (", " + DELAYED if len(shown) == 1 else ""), fontsize=13, loc="left"
    )


def _draw_intervals(axes: Axes, shown: list[list[Row]]) -> None:
    """How long the wheels went one way."""
    for series, colour in zip(shown, COLOURS, strict=False):
        axes.hist(
            intervals_s(series),
            bins=np.arange(0.0, 4.0, 0.1).tolist(),
            histtype="step",
            color=colour,
            linewidth=2,
            label=series[0]["side"],
        )
    axes.set_xlabel("time between switches (s)")
    axes.set_ylabel("count")
    axes.legend()


def _draw_lives(axes: Axes, rows: list[Row], end_s: float) -> None:
    """What part of the wheels still switches, against time."""
    styles: Any = ("-", "--", ":")
    for number, name in enumerate(CONDITIONS):
        own = chosen(rows, condition=name)
        lasts = [row["end"] == SWITCHES for row in own]
        until_s = np.sort(np.where(lasts, np.inf, np.maximum(column(own, "until_s"), 0.1)))
        steps = np.append(until_s[until_s < end_s], end_s)
        left = 100 * (1 - np.searchsorted(until_s, steps, side="right") / len(own))
        axes.step(
            np.append(0.1, steps),
            np.append(100, left),
            where="post",
            color=COLOURS[number % len(COLOURS)],
            linestyle=styles[number % 3],
            label=name,
        )
    axes.set_xscale("log")
    axes.set_xlim(0.5, end_s)
    axes.set_ylim(0, 104)
    axes.set_xlabel("time since the start (s)")
    axes.set_ylabel("wheels that still switch (%)")
    axes.legend(ncols=3, **_ABOVE)


def _draw_twins(axes: Axes, rows: list[Row]) -> None:
    """Median and 10 to 90 % of the distance of twins."""
    for (condition, jump, label, place), colour in zip(_TWINS, COLOURS, strict=False):
        own = chosen(rows, condition=condition, jump=jump)
        since_s = np.unique(column(own, "since_s"))
        distances = column(own, "distance").reshape(-1, len(since_s))
        low, median, high = np.quantile(distances, (0.1, 0.5, 0.9), axis=0)
        axes.plot(since_s, median, color=colour)
        axes.text(*place, label, color=colour, fontsize=_SMALL, va="bottom")
        axes.fill_between(since_s, low, high, color=colour, alpha=0.2, linewidth=0)
    seen = CONDITIONS[ORDINARY].tick_s / TAU_S * COUNT_RAD
    axes.axhline(seen, color="black", linestyle=":", linewidth=1.2)
    axes.text(TWIN_S, seen, "one degree, one tick", fontsize=_SMALL, ha="right", va="top")
    axes.set_yscale("log")
    axes.set_ylim(1e-8, 10)
    axes.set_xlabel("time since a jump of $x_1$ (s)")
    axes.set_ylabel("distance of the potentials")
    axes.set_title("how twins part", fontsize=13, loc="left")


def _draw_map(axes: Axes, rows: list[Row]) -> None:
    """The share of wheels that are chaotic."""
    latencies, inertias = (sorted({row[name] for row in rows}) for name in ("latency_s", "inertia"))
    shares = np.array(
        [
            [
                np.mean([is_chaotic(row) for row in chosen(rows, latency_s=x, inertia=y)])
                for x in latencies
            ]
            for y in inertias
        ]
    )
    image = axes.imshow(
        100 * shares, origin="lower", aspect="auto", cmap="cividis", vmin=0, vmax=100
    )
    axes.set_xticks(range(len(latencies)), [f"{1000 * latency:g}" for latency in latencies])
    axes.set_yticks(range(len(inertias)), [f"{inertia:g}" for inertia in inertias])
    axes.set_xlabel("latency of the motors (ms)")
    axes.set_ylabel("moment of inertia\n(of the motor's)")
    own = latencies.index(min(latencies)), inertias.index(1.0)
    axes.plot(*own, marker="*", color="white", markersize=14)
    axes.figure.colorbar(image, ax=axes, label="chaotic wheels (%)", fraction=0.06, pad=0.02)
    axes.set_title(
        "where it is chaotic ($\\bigstar$: published constants)", fontsize=13, loc="left"
    )
