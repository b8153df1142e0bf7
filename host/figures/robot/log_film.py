"""Pictures of a film of a log: both wheels with their rods, the time, and what happens."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from host.figures.robot.kick import kick_words
from host.figures.robot.moving_pictures import moving_pictures
from host.figures.robot.rod_machine import KICK, RodMachine, explain
from host.figures.style import styled
from host.films.log_course import Frame
from robot.kicks import WHEELS

SIZE = (960, 540)
_DPI = 100


def pictures(frames: Iterable[Frame], slower: float) -> Iterator[NDArray[np.uint8]]:
    """Draw a picture of each frame.

    Args:
        frames: What both wheels do.
        slower: How many times slower than life the film is; the picture says so.

    Yields:
        Pictures, (height, width, 3).
    """
    with styled():
        figure = Figure(figsize=(SIZE[0] / _DPI, SIZE[1] / _DPI), dpi=_DPI)
        machines = {}
        for number, side in enumerate(WHEELS):
            axes = figure.add_axes((0.5 * number, 0.0, 0.5, 0.89))
            machines[side] = RodMachine(axes)
            figure.text(0.3 + 0.5 * number, 0.84, f"{side} wheel", fontsize=15, weight="bold")
        explain(figure.axes[0])
        if slower != 1.0:
            words = f"{slower:g} times slower than life"
            figure.text(0.98, 0.95, words, fontsize=13, va="center", ha="right")
        clock = figure.text(0.02, 0.95, "", fontsize=16, va="center", family="monospace")
        event = figure.text(0.22, 0.95, "", fontsize=16, va="center", weight="bold")
        moving = [clock, event, *(part for one in machines.values() for part in one.moving)]

        def show(frame: Frame) -> None:
            for side, machine in machines.items():
                machine.show(*frame.wheels[side])
            clock.set_text(f"{frame.t_s:7.2f} s")
            event.set_text(frame.word if frame.kick is None else kick_words(frame.kick))
            event.set_color("black" if frame.kick is None else KICK)

        yield from moving_pictures(figure, moving, frames, show)
