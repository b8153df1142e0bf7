"""Pictures of a film: the rods of a wheel as in the paper's fig. sketch_robot.

Potentials and torque are beside them.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from host.figures.style import COLOURS, styled
from host.films.rod_course import Course

SIZE = (960, 480)
_DPI = 100
# How far from the wheel's axle the rods end, and how far beside them the springs lie.
_LONG, _ASIDE = 2.9, 0.42
_ROD, _WHEEL = "dimgrey", "#e8e8e8"
_ACTUAL, _TARGET, _KICK = COLOURS[4], COLOURS[2], COLOURS[1]
_POTENTIALS = (COLOURS[0], COLOURS[3])
_RING: Any = {"markerfacecolor": "none", "markeredgecolor": _KICK, "markeredgewidth": 2.5}
_COILS = 7


def pictures(course: Course, slower: float) -> Iterator[NDArray[np.uint8]]:
    """Draw a picture for each time of the course.

    Args:
        course: what the wheel does.
        slower: how many times slower than life the film is; the picture says so.

    Yields:
        Pictures, (height, width, 3).
    """
    with styled():
        figure = Figure(figsize=(SIZE[0] / _DPI, SIZE[1] / _DPI), dpi=_DPI)
        canvas: Any = FigureCanvasAgg(figure)
        wheel = figure.add_axes((0.0, 0.0, 0.5, 1.0))
        neurons = figure.add_axes((0.585, 0.52, 0.395, 0.36))
        torque = figure.add_axes((0.585, 0.13, 0.395, 0.29))
        machine = _Machine(wheel)
        turning = np.gradient(course.phi)
        curves = _curves(neurons, torque, course)
        figure.text(0.585, 0.955, f"{slower:g} times slower than life", fontsize=12, va="center")
        way = figure.text(0.98, 0.955, "", fontsize=13, va="center", ha="right", weight="bold")
        moving = [way, *machine.moving, *(part for line, dot, _ in curves for part in (line, dot))]
        for artist in moving:
            artist.set_animated(True)
        canvas.draw()
        still = canvas.copy_from_bbox(figure.bbox)
        for number, now_s in enumerate(course.t_s):
            machine.show(course, number)
            for line, dot, values in curves:
                line.set_data(course.t_s[: number + 1], values[: number + 1])
                dot.set_data([now_s], [values[number]])
            acts = 0.0 <= now_s < course.kick_s
            heading = "forward" if turning[number] > 0.0 else "backward"
            way.set_text(f"{course.kick} kick" if acts else heading)
            way.set_color(_KICK if acts else "black")
            canvas.restore_region(still)
            for artist in moving:
                figure.draw_artist(artist)
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _curves(
    neurons: Axes, torque: Axes, course: Course
) -> list[tuple[Line2D, Line2D, NDArray[np.float64]]]:
    """Empty curves (line, its newest point, values), in axes that hold all of the course."""
    found = []
    rows = [
        (neurons, course.potentials[number], _POTENTIALS[number], f"$x_{number + 1}$")
        for number in range(2)
    ]
    for axes, values, colour, name in (*rows, (torque, course.torque, "black", "$M$")):
        (line,) = axes.plot([], [], color=colour, label=name, drawstyle="steps-post")
        (dot,) = axes.plot([], [], "o", color=colour, markersize=6)
        found.append((line, dot, values))
    for axes in (neurons, torque):
        axes.set_xlim(course.t_s[0], course.t_s[-1])
        axes.set_ylim(-1.1, 1.1)
        axes.set_yticks((-1, 0, 1))
        axes.axhline(0, color="lightgrey", linewidth=1, zorder=0)
        axes.axvspan(0.0, course.kick_s, color=_KICK, alpha=0.25, linewidth=0)
    neurons.set_ylabel("potentials")
    neurons.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 0.94),
        ncols=2,
        handlelength=1.2,
        fontsize=12,
        borderpad=0.1,
    )
    neurons.tick_params(labelbottom=False)
    torque.set_ylabel("torque $M$")
    torque.set_xlabel("time since the kick (s)", labelpad=2)
    return found


class _Machine:
    """A wheel with two rods, the first along x, the second along y.

    A spring pulls each rod's head to its target.
    """

    def __init__(self, axes: Axes) -> None:
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set_xlim(-1.35, 4.25)
        axes.set_ylim(-4.25, 1.35)
        turn = np.linspace(0.0, 2 * np.pi, 121)
        axes.fill(np.cos(turn), np.sin(turn), facecolor=_WHEEL, edgecolor="black", linewidth=2.5)
        axes.plot(0, 0, "o", color="black", markersize=6)
        (self._spoke,) = axes.plot([], [], color="darkgrey", linewidth=2)
        bar: Any = {"linewidth": 5, "solid_capstyle": "round"}
        self._rods = [axes.plot([], [], color=_ROD, **bar)[0] for _ in range(2)]
        self._springs = [axes.plot([], [], color="black", linewidth=1.2)[0] for _ in range(2)]
        self._targets = [axes.plot([], [], color=_TARGET, **bar)[0] for _ in range(2)]
        self._heads = [axes.plot([], [], color=_ACTUAL, **bar)[0] for _ in range(2)]
        (self._pin,) = axes.plot([], [], "o", color=_ACTUAL, markersize=11, markeredgecolor="black")
        (self._seen,) = axes.plot([], [], "o", markersize=15, **_RING)
        # From the backmost to the foremost.
        self.moving = (
            self._spoke,
            *self._rods,
            *self._springs,
            *self._targets,
            *self._heads,
            self._pin,
            self._seen,
        )
        for number, at in enumerate((-1.0, 0.0, 1.0)):
            for rod in range(2):
                axes.plot(
                    *_place(rod, [at, at], [2 * _ASIDE + 0.05, 2 * _ASIDE + 0.17]),
                    color="grey",
                    linewidth=1.2,
                )
                text: Any = {"ha": "center", "va": "center", "fontsize": 11, "color": "dimgrey"}
                (x,), (y,) = _place(rod, [at], [2 * _ASIDE + 0.36])
                axes.text(float(x), float(y), f"{number - 1}", **text)
        for rod in range(2):
            axes.plot(
                *_place(rod, [-1.0, 1.0], [2 * _ASIDE + 0.05] * 2), color="grey", linewidth=1.2
            )
        _explain(axes)

    def show(self, course: Course, number: int) -> None:
        """Draw it as it is at one time of the course."""
        phi = float(course.phi[number])
        pin = cos(phi), sin(phi)
        self._pin.set_data([pin[0]], [pin[1]])
        self._spoke.set_data([0.0, pin[0]], [0.0, pin[1]])
        self._seen.set_data([course.seen[0, number]], [course.seen[1, number]])
        for rod in range(2):
            actual, target = float(course.actual[rod, number]), float(course.targets[rod, number])
            head = _place(rod, [actual], [0.0])
            self._rods[rod].set_data([pin[0], head[0][0]], [pin[1], head[1][0]])
            self._heads[rod].set_data(*_place(rod, [actual, actual], [0.0, 1.45 * _ASIDE]))
            self._targets[rod].set_data(
                *_place(rod, [target, target], [0.55 * _ASIDE, 1.9 * _ASIDE])
            )
            self._springs[rod].set_data(*_place(rod, *_spring(actual, target)))


def _place(rod: int, along: Any, aside: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points beside the rail of a rod's head: right of the wheel for rod 0, below it for rod 1."""
    on, off = np.asarray(along, dtype=float), np.asarray(aside, dtype=float)
    return (_LONG + on, -off) if rod == 0 else (off, on - _LONG)


def _spring(begin: float, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A coil from begin to end."""
    along = np.linspace(begin, end, 2 * _COILS + 1)
    aside = np.full(len(along), _ASIDE)
    aside[1:-1] += 0.11 * np.resize([1, -1], len(along) - 2)
    return along, aside


def _explain(axes: Axes) -> None:
    """What is what, where the picture is empty."""
    lines = (
        (Line2D([], [], color=_ROD, linewidth=5), "transmission rod"),
        (Line2D([], [], color=_ACTUAL, linewidth=5), r"actual position $x_i^{(\mathrm{a})}$"),
        (Line2D([], [], color=_TARGET, linewidth=5), r"target position $x_i^{(\mathrm{t})}$"),
        (
            Line2D([], [], color="black", linewidth=1.2),
            r"spring, $F_i = k\,(x_i^{(\mathrm{t})} - x_i^{(\mathrm{a})})$",
        ),
        (
            Line2D([], [], marker="o", linestyle="", markersize=12, **_RING),
            "what the kick shows\nthe neurons",
        ),
    )
    style: Any = {
        "loc": "center",
        "bbox_to_anchor": (0.74, 0.24),
        "fontsize": 12,
        "handlelength": 1.4,
        "labelspacing": 0.7,
    }
    axes.legend(*zip(*lines, strict=True), **style)
