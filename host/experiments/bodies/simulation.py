"""Build a simulated body for an experiment, and let it run."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

from host.bodies.build import CARS_OF_A_TRAIN
from sim_motor.bodies.measures import Course, course, order
from sim_motor.bodies.presets import PUSHED, Preset

if TYPE_CHECKING:
    import mujoco

    from sim_motor.bodies.body import Body

Array = NDArray[np.float64]
# Changes a scene before MuJoCo compiles it.
EditScene = Callable[["mujoco.MjSpec"], None]

PRESETS = ("paper", "snake2019")
# The program of 2019 starts with straight joints, which no real train has. Here the seed bends them
# a little (rad, standard deviation).
BENT = 0.01
# Above this order parameter, the wheels of a train go one way.
ORDERED = 0.9
# Slopes have no end here. Those of the authors' programs are 2 m long and end this far from the
# middle (m); a body that gets farther counts as outside.
EDGE_M = 6.0


class Position(TypedDict):
    """Where a body, or a part of it, is at one time.

    Attributes:
        t_s: time since the start (s).
        x_m: x (m).
        y_m: y (m).
    """

    t_s: float
    x_m: float
    y_m: float


class BodyRun(NamedTuple):
    """What a body did.

    Attributes:
        course: its motion.
        joints: angles in rad, (times, joints), first all that yaw.
        head: the first car's x (m), y (m) and yaw (rad), (times, 3).
        unstable_s: when the simulation became unstable, or None; everything here is from before
            that time.
    """

    course: Course
    joints: Array
    head: Array
    unstable_s: float | None

    @property
    def order(self) -> Array:
        """The order parameter, (times,)."""
        return order(self.course.omega)

    def every(self, seconds: float) -> range:
        """The numbers of the rows that are this far apart, from the first on."""
        return range(0, len(self.course.t_s), round(seconds / float(self.course.t_s[1])))

    def positions(self, path: Array, seconds: float) -> list[Position]:
        """Where a path goes, at times this far apart.

        Args:
            path: (times, 2 or more), with x and y (m) first; such as `head`.
            seconds: time between positions (s).

        Returns:
            The positions, from the first row on.
        """
        return [
            {
                "t_s": float(self.course.t_s[at]),
                "x_m": float(path[at, 0]),
                "y_m": float(path[at, 1]),
            }
            for at in self.every(seconds)
        ]

    def last(self, seconds: float) -> NDArray[np.bool_]:
        """Which rows belong to the last seconds, (times,)."""
        return np.asarray(self.course.t_s > self.course.t_s[-1] - seconds)


def build_body(
    preset: Preset,
    scene: str = "flat",
    cars: int = CARS_OF_A_TRAIN,
    *,
    seed: int,
    phases: Array | None = None,
    torque: float | None = None,
    angle: float | None = None,
    bouncy: bool = False,
    edit: EditScene = lambda spec: None,
) -> Body:
    """Build a car or a train, as `compose` and `Body` of sim_motor.bodies do.

    edit: changes the scene before it is compiled.
    """
    from sim_motor.bodies.body import Body
    from sim_motor.bodies.model import compose

    spec = compose(preset, scene, cars, seed=seed, angle=angle, bouncy=bouncy)
    edit(spec)
    return Body(spec.compile(), preset, seed=seed, phases=phases, torque=torque)


def build_pushed_train(preset: Preset, *, seed: int, bent: float = BENT, **options: Any) -> Body:
    """Build a train whose rods push all wheels forward at the start.

    The seed bends its joints in yaw. options: of `build_body`.
    """
    from sim_motor.bodies.model import SIDES

    phases = np.full(CARS_OF_A_TRAIN * len(SIDES), PUSHED)
    body = build_body(preset, seed=seed, phases=phases, **options)
    yaws = [body.model.joint(name).qposadr[0] for name in body.joints if name.endswith("yaw")]
    body.data.qpos[yaws] = np.random.default_rng(seed).normal(0.0, bent, len(yaws))
    return body


def run_body(body: Body, seconds: float) -> BodyRun:
    """Let a body run, and return what it has done since it was built."""
    from sim_motor.bodies.body import Unstable

    unstable_s = None
    try:
        body.run(seconds)
    except Unstable:
        unstable_s = body.time_s
    columns, rows = body.columns, body.rows
    head = rows[:, [columns.index(f"car0_{name}") for name in ("x_m", "y_m", "yaw_rad")]]
    joints = rows[:, [column.endswith("_joint_rad") for column in columns]]
    return BodyRun(course(columns, rows), joints, head, unstable_s)


def set_heading(yaw_rad: float) -> EditScene:
    """For `edit`: the body starts with this heading."""

    def edit(spec: mujoco.MjSpec) -> None:
        spec.body("car0_car").quat = (cos(yaw_rad / 2), 0.0, 0.0, sin(yaw_rad / 2))

    return edit
