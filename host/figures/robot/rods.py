"""Pictures of a film: the rods of a wheel as in the paper's fig. sketch_robot.

Potentials and torque are beside them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from host.figures.robot.moving_pictures import moving_pictures
from host.figures.robot.rod_machine import KICK, RodMachine, explain
from host.figures.style import COLOURS, styled
from host.films.rod_course import Course

SIZE = (960, 480)
_DPI = 100
_POTENTIALS = (COLOURS[0], COLOURS[3])


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
        wheel = figure.add_axes((0.0, 0.0, 0.5, 1.0))
        neurons = figure.add_axes((0.585, 0.52, 0.395, 0.36))
        torque = figure.add_axes((0.585, 0.13, 0.395, 0.29))
        machine = RodMachine(wheel)
        explain(wheel)
        turning = np.gradient(course.phi)
        curves = _curves(neurons, torque, course)
        figure.text(0.585, 0.955, f"{slower:g} times slower than life", fontsize=12, va="center")
        way = figure.text(0.98, 0.955, "", fontsize=13, va="center", ha="right", weight="bold")
        moving = [way, *machine.moving, *(part for line, dot, _ in curves for part in (line, dot))]

        def show(number: int) -> None:
            machine.show(
                float(course.phi[number]),
                course.actual[:, number],
                course.targets[:, number],
                course.seen[:, number],
            )
            for line, dot, values in curves:
                line.set_data(course.t_s[: number + 1], values[: number + 1])
                dot.set_data([course.t_s[number]], [values[number]])
            acts = 0.0 <= course.t_s[number] < course.kick_s
            heading = "forward" if turning[number] > 0.0 else "backward"
            way.set_text(f"{course.kick} kick" if acts else heading)
            way.set_color(KICK if acts else "black")

        yield from moving_pictures(figure, moving, range(len(course.t_s)), show)


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
        axes.axvspan(0.0, course.kick_s, color=KICK, alpha=0.25, linewidth=0)
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
