"""The car's route to locomotion: what its starts come to over k, and how fast it rolls."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.car_route import (
    KINDS,
    KS,
    NEURONS,
    Numbers,
    Route,
    Row,
    car_preset,
    rolling_rad_s,
)
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings

_SHADES = dict(zip(KINDS, ("#bbbbbb", COLOURS[4], COLOURS[5], COLOURS[0], COLOURS[1]), strict=True))
PANELS = tuple(f"{row}-{column}" for row in ("starts", "speeds") for column in (1, 2, 3))
_TICKS = (0.01, 0.03, 0.1, 0.3, 1.0)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        grid = figure.subplots(2, len(NEURONS), sharey="row", sharex="col")
        for (shares, speeds), (a, tau) in zip(grid.T, NEURONS, strict=True):
            route = [one for one in numbers["route"] if (one["a"], one["tau"]) == (a, tau)]
            _draw_shares(shares, route)
            shares.set_title(rf"$a$ = {a:g}, $\tau$ = {tau:g} s", fontsize=13)
            _draw_speeds(speeds, route, a, tau)
        grid[0, 0].set_ylabel("starts (%)")
        grid[1, 0].set_ylabel(r"$|\omega|$ of the wheels (rad/s)")
        share_legend(figure, grid.flat, loc="outside lower center", ncols=7, fontsize=11)
        figure.suptitle(
            "A car with one rod for each wheel: rest, forth and back, rolling", fontsize=16
        )
    return figure


def _draw_shares(axes: Axes, route: list[Route]) -> None:
    ks, below = np.array([one["k"] for one in route]), np.zeros(len(route))
    starts = np.array([sum(one["kinds"].values()) for one in route])
    for kind in (one for one in KINDS if any(own["kinds"].get(one) for own in route)):
        shares = 100 * np.array([one["kinds"].get(kind, 0) for one in route]) / starts
        axes.bar(ks, shares, bottom=below, color=_SHADES[kind], label=kind, width=0.26 * ks)
        below += shares


def _draw_speeds(axes: Axes, route: list[Route], a: float, tau: float) -> None:
    ks = np.geomspace(KS[0], KS[-1], 400)
    speeds = [rolling_rad_s(car_preset({"a": a, "tau": tau, "k": float(k)})) for k in ks]
    axes.plot(
        ks,
        [np.nan if speed is None else speed for speed in speeds],
        color="black",
        label=r"formula for $\omega^*$",
    )
    measured = [(one["k"], speed) for one in route for speed in one["rolling_rad_s"]]
    axes.plot(
        [k for k, _ in measured],
        [speed for _, speed in measured],
        "o",
        color=COLOURS[0],
        label=r"$|\omega|$ of cars that roll",
    )
    axes.set_xscale("log")
    axes.set_xticks(_TICKS, [f"{k:g}" for k in _TICKS])
    axes.set_ylim(bottom=0)
    axes.set_xlabel("$k$ (N)")
