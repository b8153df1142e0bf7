"""The chaotic mode: torque, return map, how long switching lasts, how twins part, the map."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.chaos_numbers import tally
from host.experiments.robot.chaos_pieces import SEEN, TWIN_S, UNSEEN
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
from host.experiments.robot.switching import CONDITIONS, OLDER, ORDINARY
from host.figures.style import COLOURS, SIZE, styled
from host.kicking.robot_claims import STALL_TORQUE
from host.runs.contract import Findings
from host.util.intervals import wilson
from sim_motor.settling import COUNT_RAD

STRETCH_S = 20.0
_SLIDE = (16.0, 9.0)
_BEGINS_S = {ORDINARY: 0.0, OLDER: 60.0}
# Condition and jump of the twins that are drawn, with a label and its place.
_TWINS = (
    (OLDER, SEEN, OLDER, (2.2, 0.8)),
    (ORDINARY, SEEN, ORDINARY, (8.0, 6e-5)),
    (OLDER, UNSEEN, "a jump that no reading shows", (2.4, 1e-7)),
)
_SMALL = 12


def draw(rows: list[ChaosRow], findings: Findings) -> Figure:
    """Draw the rows of a simulated brick, or of a robot, which has neither twins nor map."""
    wheels = series_of_wheels(rows)
    places = map_rows(rows)
    params = findings.numbers["parameters"]
    with styled():
        figure = Figure(**{**SIZE, "figsize": _SLIDE})
        grid = figure.add_gridspec(2, 3)
        courses = grid[0, :2].subgridspec(2, 1)
        for place, ((condition, side), series) in enumerate(wheels.items()):
            axes = figure.add_subplot(courses[place])
            title = condition if places else f"{side} wheel"
            _draw_torque(axes, series, title, _BEGINS_S.get(condition, 0.0), last=place == 1)
        axes = figure.add_subplot(grid[0, 2])
        if places:
            older = [own for (condition, _), own in wheels.items() if condition == OLDER]
            _draw_return_map(axes, older, OLDER)
            end_s = max(series[-1]["t_s"] for series in wheels.values())
            _draw_lives(figure.add_subplot(grid[1, 0]), rows, end_s)
            _draw_twins(figure.add_subplot(grid[1, 1]), twins_rows(rows), params)
            _draw_map(figure.add_subplot(grid[1, 2]), places)
        else:
            _draw_return_map(axes, list(wheels.values()), "both wheels")
            _draw_intervals(figure.add_subplot(grid[1, :]), list(wheels.values()))
        figure.suptitle(
            "Chaos at $a$ = {a:g}, $k$ = {k:g}, $\\tau$ = {tau_s:g} s: do the wheels switch"
            " irregularly?".format(**params),
            fontsize=18,
        )
    return figure


def _draw_torque(
    axes: Axes, series: list[SeriesRow], title: str, begin_s: float, *, last: bool
) -> None:
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
    if last:
        axes.set_xlabel("time (s)")
    axes.set_title(f"{title} (grey: the motor stalls)", fontsize=14, loc="left")


def _draw_return_map(axes: Axes, shown: list[list[SeriesRow]], of: str) -> None:
    """Draw the angle of each turning point against the one before."""
    for series, colour in zip(shown, COLOURS, strict=False):
        angles = np.degrees(turning_points_rad(series))
        axes.plot(angles[:-1], angles[1:], ".", color=colour, markersize=4)
    axes.set_xlabel("turning point, modulo 90 (deg)")
    axes.set_ylabel("the next turning point (deg)")
    axes.set_xticks((0, 30, 60, 90))
    axes.set_yticks((0, 30, 60, 90))
    axes.set_title(f"return map: {of}", fontsize=14, loc="left")


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
    """Draw which share of the wheels still switches in the end, under each condition."""
    names = list(CONDITIONS)[::-1]
    for place, name in enumerate(names):
        own = tally(lives_rows(rows, name))
        share, colour = own["to_the_end"] / own["wheels"], COLOURS[CONDITIONS[name].rod_lag_s > 0]
        low, high = wilson(own["to_the_end"], own["wheels"])
        axes.barh(place, 100 * share, color=colour, alpha=0.5)
        axes.plot((100 * low, 100 * high), (place, place), color="black", linewidth=1.5)
    axes.set_yticks(range(len(names)), names, fontsize=_SMALL)
    axes.set_xlim(0, 100)
    axes.set_xlabel(f"wheels that switch for {end_s / 60:.0f} min (%)")
    axes.set_title("how many last (line: 95 % interval)", fontsize=14, loc="left")


def _draw_twins(
    axes: Axes, twins: dict[tuple[str, float], list[TwinsRow]], params: dict[str, float]
) -> None:
    """Draw the median, and 10 to 90 %, of the distance of twins."""
    for (condition, jump, label, place), colour in zip(_TWINS, COLOURS, strict=False):
        pairs = twins[condition, jump]
        since_s = np.unique([row["since_s"] for row in pairs])
        distances = np.array([row["distance"] for row in pairs]).reshape(-1, len(since_s))
        low, median, high = np.quantile(distances, (0.1, 0.5, 0.9), axis=0)
        axes.plot(since_s, median, color=colour)
        axes.text(*place, label, color=colour, fontsize=_SMALL, va="bottom")
        axes.fill_between(since_s, low, high, color=colour, alpha=0.2, linewidth=0)
    seen = params["tick_s"] / params["tau_s"] * COUNT_RAD
    axes.axhline(seen, color="black", linestyle=":", linewidth=1.2)
    axes.text(TWIN_S, seen, "one degree, one tick", fontsize=_SMALL, ha="right", va="top")
    axes.set_yscale("log")
    axes.set_ylim(1e-8, 10)
    axes.set_xlabel("time since a jump of $x_1$ (s)")
    axes.set_ylabel("distance of the potentials")
    axes.set_title("how twins part", fontsize=14, loc="left")


def _draw_map(axes: Axes, places: dict[tuple[float, float], list[MapRow]]) -> None:
    """Draw the share of chaotic wheels over the rods' lag and the battery's voltage."""
    lags_s = sorted({lag_s for lag_s, _ in places})
    voltages_v = sorted({battery_v for _, battery_v in places})

    def share(lag_s: float, battery_v: float) -> float:
        return float(np.mean([is_chaotic(row) for row in places[lag_s, battery_v]]))

    shares = np.array([[share(x, y) for x in lags_s] for y in voltages_v])
    image = axes.imshow(
        100 * shares, origin="lower", aspect="auto", cmap="cividis", vmin=0, vmax=100
    )
    axes.set_xticks(range(len(lags_s)), [f"{1000 * lag:g}" for lag in lags_s])
    axes.set_yticks(range(len(voltages_v)), [f"{volts:g}" for volts in voltages_v])
    axes.set_xlabel("rods older by (ms)")
    axes.set_ylabel("battery (V)")
    axes.figure.colorbar(image, ax=axes, label="chaotic wheels (%)", fraction=0.06, pad=0.02)
    axes.set_title("where it is chaotic", fontsize=14, loc="left")
