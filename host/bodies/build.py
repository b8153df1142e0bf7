"""Build the simulated car or train that a person asks for, or say what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from host.errors import WrongUse
from host.util.extras import need

if TYPE_CHECKING:
    import mujoco

    from sim_motor.bodies.body import Body
    from sim_motor.bodies.presets import Preset

CARS_OF_A_TRAIN = 5
# How wheels stand at the start: the rods push all of them forward, or at random angles.
PUSHED_FORWARD, RANDOM = "pushed", "random"
# What is said of what acts on the controller alone.
WITHOUT_CONTROLLER = "with a constant torque the wheels have no controller"
ONE_OF_THEM = "leave one of the two out"


class BodyRequest(NamedTuple):
    """The body that a person asks for, in SI units; None stands for the preset's own value.

    Attributes:
        cars: 1 for a car, more for a train.
        scene: name of a scene, or the path of an own NAME.xml.
        preset: name of a preset.
        seed: of everything random.
        a: gain of the neurons (1).
        k: spring constant of the rods (N).
        tau: time constant of the neurons (s).
        drag: in the preset's unit, N s/m of bodies or N s/rad of wheels.
        angle: of the scene's slopes (rad).
        bouncy: whether walls throw back.
        torque: constant torque of every wheel instead of its controller (N m).
        start: of the wheels, PUSHED_FORWARD or RANDOM. By default a car is pushed, because from a
            random start it mostly comes to rest, and a train is not.
        timestep: of the physics (s).
    """

    cars: int = 1
    scene: str = "flat"
    preset: str = "paper"
    seed: int = 1
    a: float | None = None
    k: float | None = None
    tau: float | None = None
    drag: float | None = None
    angle: float | None = None
    bouncy: bool = False
    torque: float | None = None
    start: str | None = None
    timestep: float = 0.001


def choose_preset(request: BodyRequest) -> Preset:
    """The preset, with the request's numbers instead of its own.

    Raises:
        WrongUse: if there is no preset of this name, or a number is impossible.
    """
    from sim_motor.bodies.presets import NAMES, preset

    if request.preset not in NAMES:
        raise WrongUse(f"there is no preset '{request.preset}'", f"choose {' or '.join(NAMES)}")
    own = preset(request.preset)
    if request.drag is not None:
        own = own.with_drag(request.drag)
    numbers = {"a": request.a, "tau": request.tau, "k": request.k}
    chosen = {name: value for name, value in numbers.items() if value is not None}
    with value_errors_as_wrong_use():
        return own._replace(**chosen).checked()


def build_scene(request: BodyRequest) -> mujoco.MjSpec:
    """The scene with the cars in it, not yet compiled.

    Raises:
        WrongUse: if MuJoCo is not installed, the scene is impossible, or parts of the request
            exclude each other.
    """
    need("mujoco", "bodies")
    from sim_motor.bodies.model import compose

    numbers = {"angle": request.angle, "torque": request.torque, "timestep": request.timestep}
    for name, value in numbers.items():
        if value is not None and not isfinite(value):
            raise WrongUse(f"{name} cannot be {value!r}", "give a finite number")
    for name in ("a", "k", "tau"):
        if request.torque is not None and getattr(request, name) is not None:
            raise WrongUse(f"{WITHOUT_CONTROLLER}, so {name} does nothing", ONE_OF_THEM)
    own = choose_preset(request)
    with value_errors_as_wrong_use():
        return compose(
            own,
            request.scene,
            request.cars,
            seed=request.seed,
            angle=request.angle,
            bouncy=request.bouncy,
            timestep=request.timestep,
        )


def build_body(
    request: BodyRequest, scene: mujoco.MjSpec | None = None, keep: int | None = None
) -> Body:
    """The body, at rest.

    Args:
        request: what it should be.
        scene: what `build_scene` made of the same request, if it is already there.
        keep: how many of its last states it keeps; None for all.

    Returns:
        A body that can run and be kicked.

    Raises:
        WrongUse: if the body is impossible.
    """
    scene = build_scene(request) if scene is None else scene
    with value_errors_as_wrong_use():
        model = scene.compile()
    from sim_motor.bodies.body import Body
    from sim_motor.bodies.presets import PUSHED

    start = request.start or (PUSHED_FORWARD if request.cars == 1 else RANDOM)
    phases = np.full(2 * request.cars, PUSHED) if start == PUSHED_FORWARD else None
    own = choose_preset(request)
    with value_errors_as_wrong_use():
        return Body(model, own, seed=request.seed, torque=request.torque, phases=phases, keep=keep)


@contextmanager
def value_errors_as_wrong_use() -> Iterator[None]:
    """Turn what sim_motor and MuJoCo find wrong into a WrongUse."""
    try:
        yield
    except ValueError as error:
        raise WrongUse(str(error), "kickctl body --help lists what is possible") from error
