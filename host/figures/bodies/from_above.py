"""What figures of bodies seen from above have in common."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

# The floor of the scene 'slopes' ends this far (m) from its middle, where the slopes begin.
FOOT_M = 4.0


def draw_slope_feet(axes: Axes) -> None:
    """Draw the dashed square where the floor ends and the four slopes begin."""
    x, y = FOOT_M * np.array([[-1, 1, 1, -1, -1], [-1, -1, 1, 1, -1]])
    axes.fill(x, y, color="whitesmoke", zorder=0)
    axes.plot(x, y, color="grey", linestyle="--", linewidth=1, zorder=1)


def label_metres(axes: Axes) -> None:
    """Label both axes in metres."""
    axes.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
