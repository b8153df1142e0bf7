"""Trains that start from random phases: how their wheels' order rises, and which way they go."""

from __future__ import annotations

from itertools import groupby

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.simulation import ORDERED, PRESETS
from host.experiments.bodies.train_start import Numbers, Row
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings

PANELS = tuple(f"{what}-{preset}" for preset in PRESETS for what in ("order", "speed"))
_FORWARD = ("forward", COLOURS[0], "-")
_BACKWARD = ("backward", COLOURS[1], "--")


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: dict[str, Numbers] = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        grid = figure.subplots(len(numbers), 2, sharex="col", squeeze=False)
        for (order, speed), (name, count) in zip(grid, numbers.items(), strict=True):
            _draw_trains(order, speed, [row for row in rows if row["preset"] == name])
            order.set_title(
                f"{name}: {count['ordered']} of {count['trains']} above {ORDERED:g}",
                loc="left",
                fontsize=13,
            )
            speed.set_title(
                f"{count['forward']} forward, {count['backward']} backward", loc="left", fontsize=13
            )
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
            axes.margins(x=0)
        share_legend(figure, figure.axes, loc="outside lower center", ncols=4, fontsize=12)
        figure.suptitle("A train of five cars starts from random wheel phases", fontsize=16)
    return figure


def _draw_trains(order: Axes, speed: Axes, rows: list[Row]) -> None:
    """Draw the order parameter and the speed of all trains of a preset."""
    for _, train in groupby(rows, key=lambda row: row["number"]):
        samples = list(train)
        label, colour, dashes = _FORWARD if samples[-1]["omega_rad_s"] >= 0 else _BACKWARD
        t_s = [row["t_s"] for row in samples]
        orders = [row["order"] for row in samples]
        omegas = [row["omega_rad_s"] for row in samples]
        order.plot(t_s, orders, color=colour, linestyle=dashes, linewidth=1, alpha=0.7)
        speed.plot(t_s, omegas, color=colour, linestyle=dashes, linewidth=1.2, label=label)
    means = _mean_orders(rows)
    order.plot(*zip(*means, strict=True), color="black", linewidth=2.5, label="mean of all trains")
    order.axhline(ORDERED, color="black", linewidth=1, linestyle=":")
    order.set(ylim=(-0.03, 1.04), ylabel="order parameter")
    speed.axhline(0, color="lightgrey", linewidth=1, zorder=0)
    speed.set_ylabel(r"mean $\omega$ (rad/s)")


def _mean_orders(rows: list[Row]) -> list[tuple[float, float]]:
    """The order parameter's mean over all trains, as (time in s, mean)."""
    by_time: dict[float, list[float]] = {}
    for row in rows:
        by_time.setdefault(row["t_s"], []).append(row["order"])
    return [(t_s, sum(orders) / len(orders)) for t_s, orders in by_time.items()]
