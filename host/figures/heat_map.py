"""A table of numbers as a heat map, with each number in its field."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike


def draw_heat_map(
    axes: Axes,
    values: ArrayLike,
    largest: float,
    label: Callable[[int, int, float], str] = lambda row, column, value: f"{value:.0f}",
    *,
    fontsize: float = 11,
) -> None:
    """Draw a heat map whose field (row, column) is centred on (column + 0.5, row + 0.5).

    Args:
        axes: where to draw it.
        values: (rows, columns), from 0 to `largest`; NaN where there is no number.
        largest: value of the brightest colour.
        label: the text in a field with a number, by row, column and value.
        fontsize: of that text.
    """
    table = np.asarray(values, dtype=float)
    axes.pcolormesh(table, cmap="cividis", vmin=0, vmax=largest, edgecolors="white", linewidth=1)
    for (row, column), value in np.ndenumerate(table):
        if not np.isnan(value):
            axes.text(
                column + 0.5,
                row + 0.5,
                label(row, column, value),
                ha="center",
                va="center",
                color="black" if value > 0.6 * largest else "white",
                fontsize=fontsize,
            )
