"""The chaotic mode: torque, return map, how long switching lasts, how twins part, the map."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.chaos_pieces import SEEN, TAU_S, TWIN_S, UNSEEN
from host.experiments.robot.chaos_rows import (
    ChaosRow,
    MapRow,
    SeriesRow,
    TwinsRow,
    intervals_s,
    is_chaotic,
    lives_rows,
    map_rows,
    series_of_wheels,
    turning_points_rad,
    twins_rows,
)
from host.experiments.robot.switching import CONDITIONS, DELAYED, ORDINARY, SWITCHES
from host.figures.style import COLOURS, SIZE, styled
from host.kicking.robot_claims import STALL_TORQUE
from host.runs.contract import Findings
from sim_motor.settling import COUNT_RAD

STRETCH_S = 20.0
_BEGINS_S = {ORDINARY: 0.0, DELAYED: 60.0}
# Condition and jump of the twins that are drawn, with a label and its place.
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


def draw(rows: list[ChaosRow], findings: Findings) -> Figure:
    """Draw the rows of a simulated brick, or of a robot, which has neither twins nor map."""
    wheels = series_of_wheels(rows)
    places = map_rows(rows)
    simulated = bool(places)
    with styled():
        if simulated:
            figure = Figure(**{**SIZE, "figsize": (10.0, 16.0)})
            grid = figure.add_gridspec(5, 2, height_ratios=(2, 2, 4, 4, 3))
        else:
            figure = Figure(**{**SIZE, "figsize": (10.0, 9.0)})
            grid = figure.add_gridspec(3, 2, height_ratios=(2, 2, 4))
        for place, ((condition, side), series) in enumerate(wheels.items()):
            axes = figure.add_subplot(grid[place, :])
            title = condition if simulated else f"{side} wheel"
            _draw_torque(axes, series, title, _BEGINS_S[condition])
        if simulated:
            delayed = [own for (condition, _), own in wheels.items() if condition == DELAYED]
            _draw_return_map(figure.add_subplot(grid[2, 0]), delayed)
            _draw_twins(figure.add_subplot(grid[2, 1]), twins_rows(rows))
            end_s = max(series[-1]["t_s"] for series in wheels.values())
            _draw_lives(figure.add_subplot(grid[3, :]), rows, end_s)
            _draw_map(figure.add_subplot(grid[4, :]), places)
        else:
            _draw_return_map(figure.add_subplot(grid[2, 0]), list(wheels.values()))
            _draw_intervals(figure.add_subplot(grid[2, 1]), list(wheels.values()))
        figure.suptitle("$k$ = 15, $\\tau$ = 1 s: do the wheels switch irregularly?", fontsize=16)
    return figure


def _draw_torque(axes: Axes, series: list[SeriesRow], title: str, begin_s: float) -> None:
    """Draw STRETCH_S seconds from begin_s on, or the last ones if the series ends before that."""
    t_s = np.array([row["t_s"] for row in series])
    torque = np.array([row["torque"] for row in series])
    begin_s = max(0.0, min(begin_s, t_s[-1] - STRETCH_S))
    inside = (t_s >= begin_s) & (t_s <= begin_s + STRETCH_S)
    axes.axhspan(-STALL_TORQUE, STALL_TORQUE, color="lightgrey", linewidth=0)
    axes.plot(t_s[inside], torque[inside], color="black", linewidth=1.4, drawstyle="steps-post")
    axes.set_xlim(begin_s, begin_s + STRETCH_S)
    axes.set_ylim(-1.15, 1.15)
    axes.set_ylabel("torque $M$")
    axes.set_xlabel("time (s)")
    axes.set_title(f"{title} (grey: the motor stalls)", fontsize=13, loc="left")


def _draw_return_map(axes: Axes, shown: list[list[SeriesRow]]) -> None:
    """Draw the angle of each turning point against the one before."""
    for series, colour in zip(shown, COLOURS, strict=False):
        angles = np.degrees(turning_points_rad(series))
        axes.plot(angles[:-1], angles[1:], ".", color=colour, markersize=4)
    axes.set_xlabel("angle of a turning point, modulo 90 (deg)")
    axes.set_ylabel("angle of the next (deg)")
    axes.set_xticks((0, 30, 60, 90))
    axes.set_yticks((0, 30, 60, 90))
    title = "return map, " + DELAYED if len(shown) == 1 else "return map"
    axes.set_title(title, fontsize=13, loc="left")


def _draw_intervals(axes: Axes, shown: list[list[SeriesRow]]) -> None:
    """Draw histograms of the times between switches."""
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


def _draw_lives(axes: Axes, rows: list[ChaosRow], end_s: float) -> None:
    """Draw the share of the wheels that still switch, against time."""
    styles: Any = ("-", "--", ":")
    for number, name in enumerate(CONDITIONS):
        wheels = lives_rows(rows, name)
        lasts = [row["end"] == SWITCHES for row in wheels]
        stops_s = np.maximum([row["until_s"] for row in wheels], 0.1)
        until_s = np.sort(np.where(lasts, np.inf, stops_s))
        steps = np.append(until_s[until_s < end_s], end_s)
        left = 100 * (1 - np.searchsorted(until_s, steps, side="right") / len(wheels))
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


def _draw_twins(axes: Axes, twins: dict[tuple[str, float], list[TwinsRow]]) -> None:
    """Draw the median, and 10 to 90 %, of the distance of twins."""
    for (condition, jump, label, place), colour in zip(_TWINS, COLOURS, strict=False):
        pairs = twins[condition, jump]
        since_s = np.unique([row["since_s"] for row in pairs])
        distances = np.array([row["distance"] for row in pairs]).reshape(-1, len(since_s))
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


def _draw_map(axes: Axes, places: dict[tuple[float, float], list[MapRow]]) -> None:
    """Draw the share of chaotic wheels over latency and moment of inertia."""
    latencies = sorted({latency_s for latency_s, _ in places})
    inertias = sorted({inertia for _, inertia in places})

    def share(latency_s: float, inertia: float) -> float:
        return float(np.mean([is_chaotic(row) for row in places[latency_s, inertia]]))

    shares = np.array([[share(x, y) for x in latencies] for y in inertias])
    image = axes.imshow(
        100 * shares, origin="lower", aspect="auto", cmap="cividis", vmin=0, vmax=100
    )
    axes.set_xticks(range(len(latencies)), [f"{1000 * latency:g}" for latency in latencies])
    axes.set_yticks(range(len(inertias)), [f"{inertia:g}" for inertia in inertias])
    axes.set_xlabel("latency of the motors (ms)")
    axes.set_ylabel("moment of inertia\n(multiple of the motor's)")
    own = latencies.index(min(latencies)), inertias.index(1.0)
    axes.plot(*own, marker="*", color="white", markersize=14)
    axes.figure.colorbar(image, ax=axes, label="chaotic wheels (%)", fraction=0.06, pad=0.02)
    axes.set_title(
        "where it is chaotic ($\\bigstar$: published constants)", fontsize=13, loc="left"
    )
