"""The run of a simulated body: its path from above, its wheels' speeds, and their order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from host.figures.bodies.from_above import draw_scene
from host.figures.style import COLOURS, SIZE, styled
from sim_motor.bodies.measures import Array, Summary, course, order

if TYPE_CHECKING:
    import mujoco

    from host.bodies.build import BodyRequest

_START: Any = {"marker": "o", "markersize": 9, "markerfacecolor": "white", "linestyle": "none"}
_BODY = COLOURS[4]


def draw(
    columns: tuple[str, ...],
    rows: Array,
    request: BodyRequest,
    summary: Summary,
    kicks_s: list[float],
    data: mujoco.MjData,
) -> Figure:
    """The figure of a body's run.

    Args:
        columns: names of the columns.
        rows: (times, columns), as a Body has them.
        request: what the body should be.
        summary: of the run.
        kicks_s: when the body was kicked (s).
        data: the scene with the body, as it is at the end.

    Returns:
        The figure.
    """
    motion = course(columns, rows)
    with styled():
        figure = Figure(**SIZE)
        axes: Any = figure.subplot_mosaic(
            [["path", "speed"], ["path", "order"]], width_ratios=(1.0, 1.25)
        )
        _draw_path(axes["path"], motion.centre_m, columns, rows[-1], data)
        axes["speed"].plot(motion.t_s, motion.omega, color=COLOURS[0], linewidth=0.6, alpha=0.5)
        axes["speed"].plot(motion.t_s, motion.omega.mean(axis=1), color="black", linewidth=1.5)
        axes["speed"].set_ylabel(r"$\omega$ (rad/s)")
        axes["order"].plot(motion.t_s, order(motion.omega), color=COLOURS[2])
        axes["order"].set(xlabel="time (s)", ylabel="order parameter", ylim=(-0.03, 1.06))
        axes["order"].sharex(axes["speed"])
        for time_s in summary["reversals"]:
            axes["speed"].axvline(time_s, color=COLOURS[1], linewidth=1.0, linestyle=":")
        for time_s in kicks_s:
            axes["speed"].axvline(time_s, color=COLOURS[3], linewidth=1.5)
        handles = _legend(bool(summary["reversals"]), bool(kicks_s))
        figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=11)
        figure.suptitle(_title(request, summary), fontsize=15)
    return figure


def _draw_path(
    axes: Axes, centre: Array, columns: tuple[str, ...], end: Array, data: mujoco.MjData
) -> None:
    """Draw the centre's path, (times, 3), over the scene, and the cars as in the last row."""
    names = [name.removesuffix("_x_m") for name in columns if name.endswith("_x_m")]
    cars = np.array([end[[columns.index(f"{car}_{axis}_m") for axis in "xy"]] for car in names])
    draw_scene(axes, data, np.vstack([centre[:, :2], cars]))
    axes.plot(*centre[:, :2].T, color=COLOURS[0])
    axes.plot(*centre[0, :2], **_START, markeredgecolor="black")
    axes.plot(*cars.T, color=_BODY, linewidth=5, solid_capstyle="round")
    axes.plot(*cars[0], marker="o", markersize=9, color=_BODY, markeredgecolor="black")


def _legend(has_reversals: bool, has_kicks: bool) -> list[Line2D]:
    handles = [
        Line2D([], [], color=COLOURS[0], label="path of the centre; each wheel"),
        Line2D([], [], color="black", label="mean of all wheels"),
        Line2D([], [], **_START, markeredgecolor="black", label="start"),
        Line2D(
            [],
            [],
            marker="o",
            color=_BODY,
            markeredgecolor="black",
            linewidth=5,
            label="end, with its head",
        ),
    ]
    if has_reversals:
        handles.append(Line2D([], [], color=COLOURS[1], linestyle=":", label="reversal"))
    if has_kicks:
        handles.append(Line2D([], [], color=COLOURS[3], label="kick"))
    return handles


def _title(request: BodyRequest, summary: Summary) -> str:
    body = "A car" if request.cars == 1 else f"A train of {request.cars} cars"
    count = len(summary["reversals"])
    reversals = f"{count} reversal" if count == 1 else f"{count} reversals"
    stuck = ["stuck"] if summary["stuck"] else []
    flipped = ["flipped"] if summary["flipped"] else []
    return ", ".join(
        [
            f"{body} ({request.preset}, {request.scene}): {summary['mean_speed']:.2f} m/s",
            f"{reversals} in {summary['time_s']:.0f} s",
            f"order {summary['order_parameter']:.2f}",
            *stuck,
            *flipped,
        ]
    )
