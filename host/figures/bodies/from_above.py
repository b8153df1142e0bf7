"""Scenes of bodies from above, as MuJoCo has them: walls, boxes, and how high the ground is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

if TYPE_CHECKING:
    import mujoco

Array = NDArray[np.float64]

# The ground's height is found on a grid of this number of lines each way; rays begin so high (m).
_LINES, _TOP_M = 80, 50.0
# Ground that rises by less than this over the picture is flat (m).
_FLAT_M = 1e-3
# A plane is a wall if its normal is this flat.
_UPRIGHT = 1e-3
# MuJoCo's rays meet geoms by their group.
_HIDDEN = 5
_WALL: Any = {"color": "dimgrey", "linewidth": 5, "solid_capstyle": "butt", "alpha": 0.7}
_BOX: Any = {"facecolor": "silver", "edgecolor": "dimgrey"}


class Wall(NamedTuple):
    """A wall: its middle and the unit vector along it, (2,), and half of its length, m."""

    middle: Array
    along: Array
    half_m: float


def scene_data(scene: str, angle: float | None = None) -> mujoco.MjData:
    """A scene with a car at its start, to draw the scene.

    Args:
        scene: Its name.
        angle: That of its slopes, rad; None for the scene's own.
    """
    import mujoco

    from sim_motor.bodies.model import compose
    from sim_motor.bodies.presets import preset

    data = mujoco.MjData(compose(preset("paper"), scene, angle=angle).compile())
    mujoco.mj_kinematics(data.model, data)
    return data


def walls(data: mujoco.MjData) -> list[Wall]:
    """The walls of a scene, as far as MuJoCo draws them."""
    model, found = data.model, []
    for number in _planes(model):
        sides = data.geom_xmat[number].reshape(3, 3)
        normal = sides[:, 2]
        if abs(normal[2]) < _UPRIGHT:
            along = np.array([-normal[1], normal[0]])
            half_m = float(np.abs(along @ sides[:2, :2]) @ model.geom_size[number, :2])
            found.append(Wall(data.geom_xpos[number, :2].copy(), along, half_m or np.inf))
    return found


def draw_scene(axes: Axes, data: mujoco.MjData, path: Array) -> None:
    """Draw the scene around a path: its walls, boxes, and the ground's height as contours.

    Args:
        axes: Where to draw it; it becomes square, with x and y in metres.
        data: The scene's. Boxes stand where they stand in it.
        path: What the picture must have room for, (points, 2), m.
    """
    low, high = path.min(axis=0), path.max(axis=0)
    middle = (low + high) / 2
    half_m = 0.62 * max(1.0, float((high - low).max()))
    x, y = (np.linspace(one - half_m, one + half_m, _LINES) for one in middle)
    heights = ground_heights(data, x, y)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), aspect="equal")
    if np.isfinite(heights).all() and np.ptp(heights) > _FLAT_M:
        _draw_heights(axes, x, y, heights)
    for wall in walls(data):
        reach = min(wall.half_m, float(np.abs(wall.middle - middle).max()) + 2 * half_m)
        ends = wall.middle + np.outer((-reach, reach), wall.along)
        axes.plot(*ends.T, **_WALL, zorder=1)
    for corners in _boxes(data):
        axes.add_patch(Polygon(corners.tolist(), **_BOX, zorder=1))
    axes.locator_params(nbins=5)
    axes.set(xlabel="$x$ (m)", ylabel="$y$ (m)")


def _draw_heights(axes: Axes, x: Array, y: Array, heights: Array) -> None:
    """Draw contours with their heights, dashed where slopes rise from the lowest ground."""
    foot_m = float(heights.min()) + _FLAT_M
    levels = [
        level for level in MaxNLocator(4).tick_values(foot_m, heights.max()) if level > foot_m
    ]
    axes.contourf(
        x, y, heights, levels=[foot_m, *levels], extend="max", cmap="Greys", alpha=0.35, zorder=0
    )
    lines = axes.contour(x, y, heights, levels=levels, colors="grey", linewidths=0.6, zorder=0)
    # Labels stand around the middle, each to another side: at an edge they would be cut.
    contours = [np.concatenate(parts) for parts in lines.allsegs if any(map(len, parts))]
    middle, aside = np.array([x.mean(), y.mean()]), np.array([np.ptp(x) / 4, 0.0])
    places = []
    for own in contours:
        nearest = np.linalg.norm(own - (middle + aside), axis=1).argmin()
        places.append(tuple(own[nearest].tolist()))
        aside = np.array([-aside[1], aside[0]])
    axes.clabel(lines, fmt="%g m", fontsize=9, colors="dimgrey", manual=places)
    style: Any = {"colors": "dimgrey", "linestyles": "--", "linewidths": 1.2, "zorder": 1}
    axes.contour(x, y, heights, levels=[foot_m], **style)


def _boxes(data: mujoco.MjData) -> list[Array]:
    """The corners, (4, 2), of boxes that are no part of a car."""
    import mujoco

    model, found = data.model, []
    for number in range(model.ngeom):
        root = model.body(model.body_rootid[model.geom_bodyid[number]]).name
        if model.geom_type[number] == mujoco.mjtGeom.mjGEOM_BOX and not root.endswith("car"):
            half = model.geom_size[number, :2] * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
            sides = data.geom_xmat[number].reshape(3, 3)[:2, :2]
            found.append(data.geom_xpos[number, :2] + half @ sides.T)
    return found


def ground_heights(data: mujoco.MjData, x: Array, y: Array) -> Array:
    """How high the ground is, m, (len(y), len(x)): that of planes, which have no end, or above."""
    across, along = np.meshgrid(x, y)
    heights = np.full_like(across, -np.inf)
    for number in _planes(data.model):
        (px, py, pz), normal = data.geom_xpos[number], data.geom_xmat[number].reshape(3, 3)[:, 2]
        if normal[2] >= _UPRIGHT:
            slope = normal[:2] / normal[2]
            heights = np.maximum(heights, pz - slope[0] * (across - px) - slope[1] * (along - py))
    return np.maximum(heights, _other_heights(data, x, y))


def _planes(model: mujoco.MjModel) -> list[int]:
    import mujoco

    planes: list[int] = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).tolist()
    return planes


def _other_heights(data: mujoco.MjData, x: Array, y: Array) -> Array:
    """How high what is neither plane nor can move is, by rays from above; -inf where none is."""
    import mujoco

    model, geom = data.model, np.zeros(1, np.int32)
    hidden = model.body_weldid[model.geom_bodyid] > 0
    hidden[_planes(model)] = True
    if hidden.all():
        return np.full((len(y), len(x)), -np.inf)
    shown, groups = np.ones(mujoco.mjNGROUP, np.uint8), model.geom_group.copy()
    shown[_HIDDEN] = 0
    model.geom_group[hidden] = _HIDDEN

    def height(one: float, other: float) -> float:
        start, down = np.array([one, other, _TOP_M]), np.array([0.0, 0.0, -1.0])
        far = mujoco.mj_ray(model, data, start, down, shown, 1, -1, geom)
        return _TOP_M - far if far >= 0.0 else -np.inf

    try:
        return np.array([[height(one, other) for one in x] for other in y])
    finally:
        model.geom_group[:] = groups
