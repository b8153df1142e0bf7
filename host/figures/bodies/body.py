"""The course of a simulated body.

Its path from above, its wheels' speeds, and their order parameter.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from host.figures.style import COLOURS, SIZE, styled
from sim_motor.bodies.measures import Array, course, order


def draw(
    columns: tuple[str, ...], rows: Array, summary: dict[str, Any], kicked_s: list[float]
) -> Figure:
    """The figure of a body's rows. kicked_s: when it was kicked."""
    moved = course(columns, rows)
    with styled():
        figure = Figure(**SIZE)
        axes: Any = figure.subplot_mosaic(
            [["path", "speed"], ["path", "order"]], width_ratios=(1.0, 1.25)
        )
        _draw_path(axes["path"], moved.centre_m, columns, rows)
        axes["speed"].plot(moved.t_s, moved.omega, color=COLOURS[0], linewidth=0.6, alpha=0.5)
        axes["speed"].plot(moved.t_s, moved.omega.mean(axis=1), color="black", linewidth=1.5)
        axes["speed"].set_ylabel(r"$\omega$ (rad/s)")
        axes["order"].plot(moved.t_s, order(moved.omega), color=COLOURS[2])
        axes["order"].set(xlabel="time (s)", ylabel="order parameter", ylim=(-0.03, 1.06))
        axes["order"].sharex(axes["speed"])
        for time_s in summary["reversals"]:
            axes["speed"].axvline(time_s, color=COLOURS[1], linewidth=1.0, linestyle=":")
        for time_s in kicked_s:
            axes["speed"].axvline(time_s, color=COLOURS[3], linewidth=1.5)
        figure.legend(
            handles=_legend(bool(summary["reversals"]), bool(kicked_s)),
            loc="outside lower center",
            ncols=4,
            fontsize=11,
        )
        figure.suptitle(_title(summary), fontsize=15)
    return figure


def _draw_path(axes: Any, centre: Array, columns: tuple[str, ...], rows: Array) -> None:
    head, tail = (
        rows[:, [columns.index(f"{car}_{axis}_m") for axis in "xy"]]
        for car in ("car0", _last(columns))
    )
    axes.plot(*centre[:, :2].T, color=COLOURS[0])
    axes.plot(
        *centre[0, :2],
        marker="o",
        markersize=9,
        markerfacecolor="white",
        markeredgecolor="black",
        linestyle="none",
    )
    axes.plot(
        *np.array([head[-1], tail[-1]]).T, color=COLOURS[4], linewidth=5, solid_capstyle="round"
    )
    axes.plot(*head[-1], marker="o", markersize=9, color=COLOURS[4])
    axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", adjustable="datalim")


def _last(columns: tuple[str, ...]) -> str:
    return [column for column in columns if column.endswith("_x_m")][-1].removesuffix("_x_m")


def _legend(reversed_: bool, kicked: bool) -> list[Line2D]:
    handles = [
        Line2D([], [], color=COLOURS[0], label="path of the centre, wheels"),
        Line2D([], [], color="black", label="mean of all wheels"),
        Line2D(
            [],
            [],
            marker="o",
            color="black",
            markerfacecolor="white",
            linestyle="none",
            label="start",
        ),
        Line2D([], [], marker="o", color=COLOURS[4], linewidth=5, label="end, with its head"),
    ]
    if reversed_:
        handles.append(Line2D([], [], color=COLOURS[1], linestyle=":", label="reversal"))
    if kicked:
        handles.append(Line2D([], [], color=COLOURS[3], label="kick"))
    return handles


def _title(summary: dict[str, Any]) -> str:
    cars = "a car" if summary["cars"] == 1 else f"a train of {summary['cars']} cars"
    count = len(summary["reversals"])
    words = f"{cars} ({summary['preset']}, {summary['scene']}): {summary['mean_speed']:.2f} m/s, "
    words += (
        f"{count} reversal{'' if count == 1 else 's'} in {summary['time_s']:.0f} s, order"
        f" {summary['order_parameter']:.2f}"
    )
    return (
        words[0].upper()
        + words[1:]
        + "".join(f", {what}" for what in ("stuck", "flipped") if summary[what])
    )
