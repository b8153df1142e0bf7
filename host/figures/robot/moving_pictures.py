"""Pictures of a film whose figure mostly stays as it is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, TypeVar

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

State = TypeVar("State")


def moving_pictures(
    figure: Figure,
    moving: Sequence[Artist],
    states: Iterable[State],
    show: Callable[[State], None],
) -> Iterator[NDArray[np.uint8]]:
    """Draw a picture for each state. What does not move is drawn once, which is much faster.

    Args:
        figure: The figure.
        moving: The parts of it that change.
        states: What the pictures show.
        show: Sets the moving parts to a state.

    Yields:
        Pictures, (height, width, 3).
    """
    canvas: Any = FigureCanvasAgg(figure)
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    for state in states:
        show(state)
        canvas.restore_region(still)
        for artist in moving:
            figure.draw_artist(artist)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()
