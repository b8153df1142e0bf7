"""How an experiment makes a simulated body and lets it run."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.bodies.build import CARS_OF_A_TRAIN
from sim_motor.bodies.measures import Course, course, order
from sim_motor.bodies.presets import PUSHED, Preset

if TYPE_CHECKING:
    import mujoco

    from sim_motor.bodies.body import Body

Array = NDArray[np.float64]

PRESETS = ("paper", "snake2019")
# The program of 2019 starts with straight joints, which no train has: here they are bent a little
# (rad, standard deviation), by chance.
BENT = 0.01
# A train whose wheels' order parameter is above this goes one way.
ORDERED = 0.9
# Here slopes have no end; those of the authors' programs, 2 m long, end so far (m) from the middle,
# and what gets farther is not inside.
EDGE_M = 6.0


class Ran(NamedTuple):
    """What a body did. joints (rad): (times, joints), first all that yaw; head.

    (times, x m, y m, yaw rad) of its first car.

    broke_s: when it could not be followed any more, if so; what is here was before that.
    """

    moved: Course
    joints: Array
    head: Array
    broke_s: float | None

    @property
    def order(self) -> Array:
        """The order parameter, (times,)."""
        return order(self.moved.omega)

    def every(self, seconds: float) -> range:
        """The numbers of rows that far apart, from the first on."""
        return range(0, len(self.moved.t_s), round(seconds / float(self.moved.t_s[1])))

    def last(self, seconds: float) -> NDArray[np.bool_]:
        """Which rows are of the end, (times,)."""
        return np.asarray(self.moved.t_s > self.moved.t_s[-1] - seconds)


def made(
    preset: Preset,
    scene: str = "flat",
    cars: int = CARS_OF_A_TRAIN,
    *,
    seed: int,
    phases: Array | None = None,
    torque: float | None = None,
    angle: float | None = None,
    bouncy: bool = False,
    prepare: Callable[[mujoco.MjSpec], None] = lambda spec: None,
) -> Body:
    """A body as `compose` and `Body` have it. prepare.

    What else is done to it before it is compiled.
    """
    from sim_motor.bodies.body import Body
    from sim_motor.bodies.model import compose

    spec = compose(preset, scene, cars, seed=seed, angle=angle, bouncy=bouncy)
    prepare(spec)
    return Body(spec.compile(), preset, seed=seed, phases=phases, torque=torque)


def pushed_off(
    preset: Preset, scene: str = "flat", *, seed: int, bent: float = BENT, **others: Any
) -> Body:
    """A train whose wheels begin at PUSHED, its joints bent in yaw by `seed`. others.

    As for `made`.
    """
    from sim_motor.bodies.model import SIDES

    body = made(
        preset, scene, seed=seed, phases=np.full(CARS_OF_A_TRAIN * len(SIDES), PUSHED), **others
    )
    yaws = [body.model.joint(name).qposadr[0] for name in body.joints if name.endswith("yaw")]
    body.data.qpos[yaws] = np.random.default_rng(seed).normal(0.0, bent, len(yaws))
    return body


def ran(body: Body, seconds: float) -> Ran:
    """Let a body go on for so long, and tell of all that it did since it was made."""
    from sim_motor.bodies.body import Unstable

    broke = None
    try:
        body.run(seconds)
    except Unstable:
        broke = body.time_s
    columns, rows = body.columns, body.rows
    head = rows[:, [columns.index(f"car0_{name}") for name in ("x_m", "y_m", "yaw_rad")]]
    joints = rows[:, [column.endswith("_joint_rad") for column in columns]]
    return Ran(course(columns, rows), joints, head, broke)


def headed(yaw_rad: float) -> Callable[[mujoco.MjSpec], None]:
    """For `prepare`: the body begins with this heading."""

    def prepare(spec: mujoco.MjSpec) -> None:
        spec.body("car0_car").quat = (cos(yaw_rad / 2), 0.0, 0.0, sin(yaw_rad / 2))

    return prepare
