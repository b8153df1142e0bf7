"""The chaotic mode: the robot's torque beside the model's, and what explains it.

The model's panel shows a wheel of the paper's model at the same a, tau and k, with the paper's I
and f, after it has settled. The table has the robot's wheels alone; `kickctl theory lyapunov` has
a series of the model.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.errors import WrongUse
from host.experiments.robot.chaos_numbers import tally
from host.experiments.robot.chaos_pieces import SEEN
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
from host.theory.analysis.trajectories import SAMPLE_S, trajectory
from host.theory.model.laws import array_rates, law_of
from host.theory.model.turning import turning
from host.theory.model.wheel import OMEGA, Wheel
from host.util.intervals import wilson
from sim_motor.settling import COUNT_RAD

STRETCH_S = 15.0
_BEGINS_S = {OLDER: 60.0}
# How long the model's wheel settles, s.
_SETTLES_S = 60.0
_SMALL = 11


def panels(options: Mapping[str, Any]) -> list[str]:
    """The names of the panels that there may be; the rows decide which."""
    lower = ("return-map", "intervals", "lives", "twins", "map")
    return ["torque-1", "torque-2", "model", *lower]


def draw(rows: list[ChaosRow], findings: Findings) -> Figure:
    """Draw the rows of a simulated brick, or of a robot, which has its two wheels alone."""
    wheels = series_of_wheels(rows)
    params = findings.numbers["parameters"]
    explanations = _explanations(rows, params)
    with styled():
        figure = Figure(**SIZE)
        halves = figure.add_gridspec(2, 1, height_ratios=(1, 1.35))
        courses = halves[0].subgridspec(1, len(wheels) + 1)
        for place, ((condition, side), series) in enumerate(wheels.items()):
            axes = figure.add_subplot(courses[place], label=f"torque-{place + 1}")
            title = f"robot, {side} wheel" if _is_pair(wheels) else f"robot, {condition}"
            _draw_torque(axes, series, title, _BEGINS_S.get(condition, 0.0))
        figure.axes[0].set_ylabel("torque $M$")
        _draw_model(figure.add_subplot(courses[-1], label="model"), params)
        places = halves[1].subgridspec(1, len(explanations))
        for place, (name, drawn) in enumerate(explanations.items()):
            drawn(figure.add_subplot(places[place], label=name))
        figure.suptitle("Do the wheels switch irregularly? (grey: the motor stalls)", fontsize=16)
    return figure


def _is_pair(wheels: dict[tuple[str, str], list[SeriesRow]]) -> bool:
    """Whether the series are both wheels of one robot."""
    return len({side for _, side in wheels}) > 1


def _explanations(
    rows: list[ChaosRow], params: dict[str, float]
) -> dict[str, Callable[[Axes], None]]:
    """What draws the lower panels, by their names: those that there are rows for."""
    wheels, twins, places = series_of_wheels(rows), twins_rows(rows), map_rows(rows)
    shown = {
        condition if not _is_pair(wheels) else f"{side} wheel": series
        for (condition, side), series in wheels.items()
    }
    if places:
        shown = {OLDER: shown[OLDER]}
    end_s = max(series[-1]["t_s"] for series in wheels.values())
    panels: dict[str, Callable[[Axes], None]] = {"return-map": partial(_draw_return_map, shown)}
    if not places:
        panels["intervals"] = partial(_draw_intervals, shown)
    if any(lives_rows(rows, name) for name in CONDITIONS):
        panels["lives"] = partial(_draw_lives, rows, end_s)
    if twins:
        panels["twins"] = partial(_draw_twins, twins, params)
    if places:
        panels["map"] = partial(_draw_map, places)
    return panels


def _draw_torque(axes: Axes, series: list[SeriesRow], title: str, begin_s: float) -> None:
    """Draw STRETCH_S seconds from begin_s on, or the last ones if the series ends before that."""
    t_s = np.array([row["t_s"] for row in series])
    torque = np.array([row["torque"] for row in series])
    begin_s = max(0.0, min(begin_s, t_s[-1] - STRETCH_S))
    inside = (t_s >= begin_s) & (t_s <= begin_s + STRETCH_S)
    axes.axhspan(-STALL_TORQUE, STALL_TORQUE, color="lightgrey", linewidth=0)
    axes.plot(t_s[inside], torque[inside], color="black", linewidth=1.4, drawstyle="steps-post")
    axes.set(xlim=(begin_s, begin_s + STRETCH_S), ylim=(-1.15, 1.15), xlabel="time (s)")
    axes.set_title(title, fontsize=13)


def _draw_model(axes: Axes, params: dict[str, float]) -> None:
    wheel = Wheel(k=params["k"], tau=params["tau_s"], a=params["a"])
    start = turning(np.array([0.01]), np.zeros(1), wheel)[:, 0]
    axes.set(xlim=(_SETTLES_S, _SETTLES_S + STRETCH_S), xlabel="time (s)")
    axes.set_ylabel(r"torque $F^\mathrm{tan}$")
    axes.set_title(f"model, $I$ = {wheel.I:g} s², $f$ = {wheel.f:g} s", fontsize=13)
    try:
        path = trajectory(start, wheel, _SETTLES_S + STRETCH_S)[-round(STRETCH_S / SAMPLE_S) :].T
    except WrongUse:
        words = "not computed:\nit changes too fast here"
        axes.text(0.5, 0.5, words, ha="center", va="center", transform=axes.transAxes)
        return
    force = wheel.I * array_rates(law_of(wheel))(*path, *wheel)[OMEGA] + wheel.f * path[OMEGA]
    t_s = _SETTLES_S + SAMPLE_S * np.arange(len(force))
    axes.axhline(0.0, color="lightgrey", linewidth=1)
    axes.plot(t_s, force, color="black", linewidth=1.4)


def _draw_return_map(shown: dict[str, list[SeriesRow]], axes: Axes) -> None:
    """Draw the angle of each turning point against the one before."""
    for (name, series), colour, marker in zip(shown.items(), COLOURS, ".x", strict=False):
        angles = np.degrees(turning_points_rad(series))
        style: Any = {"color": colour, "marker": marker, "markersize": 4, "linestyle": ""}
        axes.plot(angles[:-1], angles[1:], **style, label=name)
    axes.set(xlabel="turned at (°, mod 90)", ylabel="turned next at (°)")
    axes.set_xticks((0, 30, 60, 90))
    axes.set_yticks((0, 30, 60, 90))
    if len(shown) > 1:
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, fontsize=_SMALL)
    else:
        axes.set_title(next(iter(shown)), fontsize=_SMALL)


def _draw_intervals(shown: dict[str, list[SeriesRow]], axes: Axes) -> None:
    """Draw histograms of the times between switches."""
    for (name, series), colour, line in zip(shown.items(), COLOURS, ("-", "--"), strict=False):
        bins = np.arange(0.0, 4.0, 0.1).tolist()
        style: Any = {"histtype": "step", "color": colour, "linewidth": 2, "linestyle": line}
        axes.hist(intervals_s(series), bins=bins, label=name, **style)
    axes.set(xlabel="time between switches (s)", ylabel="count")
    if len(shown) > 1:
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, fontsize=_SMALL)


def _draw_lives(rows: list[ChaosRow], end_s: float, axes: Axes) -> None:
    """Draw which share of the wheels still switches in the end, under each condition."""
    names = [name for name in CONDITIONS if lives_rows(rows, name)]
    for place, name in enumerate(names):
        own = tally(lives_rows(rows, name))
        older = CONDITIONS[name].rod_lag_s > 0
        low, high = wilson(own["to_the_end"], own["wheels"])
        share = 100 * own["to_the_end"] / own["wheels"]
        axes.barh(place, share, 0.8, color=COLOURS[0 if older else 1], alpha=0.5)
        axes.plot((100 * low, 100 * high), (place + 0.3,) * 2, color="black", linewidth=1.5)
        axes.text(2, place, name, fontsize=9.5, va="center")
    axes.set_yticks([])
    axes.set(xlim=(0, 100), ylim=(max(len(names), 5) - 0.5, -0.5))
    axes.set_xlabel("wheels (%), 95 % intervals")
    axes.set_title(f"wheels that switch for {end_s / 60:.0f} min", fontsize=_SMALL)


def _draw_twins(
    twins: dict[tuple[str, float], list[TwinsRow]], params: dict[str, float], axes: Axes
) -> None:
    """Draw the median, and 10 to 90 %, of the distance of twins."""
    for (condition, jump), pairs in twins.items():
        colour = COLOURS[1 if condition == ORDINARY else 0]
        since_s = np.unique([row["since_s"] for row in pairs])
        distances = np.array([row["distance"] for row in pairs]).reshape(-1, len(since_s))
        low, median, high = np.quantile(distances, (0.1, 0.5, 0.9), axis=0)
        if not median.any():  # a jump that no reading shows
            continue
        line = "-" if jump == SEEN else "--"
        label = "\n".join(wrap(f"{jump:g}: {condition}", 22))
        axes.plot(since_s, median, color=colour, linestyle=line, label=label)
        axes.fill_between(since_s, low, high, color=colour, alpha=0.2, linewidth=0)
    seen = params["tick_s"] / params["tau_s"] * COUNT_RAD
    axes.axhline(seen, color="black", linestyle=":", linewidth=1.2, label="one degree, one tick")
    axes.set(yscale="log", ylim=(1e-9, 1e6), xlim=(0, since_s[-1]))
    axes.set_yticks((1e-8, 1e-6, 1e-4, 1e-2, 1))
    axes.set(xlabel="time since $x_1$ jumps (s)", ylabel="distance of $(x_1, x_2)$")
    axes.set_title("how twins part", fontsize=_SMALL)
    axes.legend(fontsize=9, loc="upper right", handlelength=1.5, labelspacing=0.2)


def _draw_map(places: dict[tuple[float, float], list[MapRow]], axes: Axes) -> None:
    """Draw the share of chaotic wheels over the rods' lag and the battery's voltage."""
    lags_s = sorted({lag_s for lag_s, _ in places})
    voltages_v = sorted({battery_v for _, battery_v in places})

    def share(lag_s: float, battery_v: float) -> float:
        return float(np.mean([is_chaotic(row) for row in places[lag_s, battery_v]]))

    shares = np.array([[share(x, y) for x in lags_s] for y in voltages_v])
    image = axes.imshow(
        100 * shares, origin="lower", aspect="auto", cmap="cividis", vmin=0, vmax=100
    )
    axes.set_xticks(
        range(len(lags_s)), [f"{1000 * lag:g}" for lag in lags_s], fontsize=10, rotation=50
    )
    axes.set_yticks(range(len(voltages_v)), [f"{volts:g}" for volts in voltages_v])
    axes.set_xlabel("rods older by (ms)")
    axes.set_ylabel("battery (V)")
    axes.figure.colorbar(image, ax=axes, label="chaotic wheels (%)", fraction=0.08, pad=0.02)
    axes.set_title("where it is chaotic", fontsize=_SMALL)
