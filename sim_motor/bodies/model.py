"""Puts cars into a scene: a train has car.xml once for each car, with a preset's numbers."""

from __future__ import annotations

from functools import cache
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim_motor.bodies.presets import HERE, Preset

SCENES = ("flat", "walls", "octagon", "slopes", "funnel", "halfpipe", "hills", "box")
# Scenes whose slopes can be given another angle.
SLOPED = ("slopes", "funnel")
# Scenes with walls. Own scenes may have geoms whose names begin with 'wall', too.
WALLED = ("walls", "octagon")
SIDES = ("left", "right")
# A wall against which a robot of the program of 2019 bounces about as in LPZRobots: time constant
# (s) and damping ratio.
BOUNCY = (0.02, 0.3)
# As in world.xml: more than that of cars, so that walls bounce.
_WALL_PRIORITY = 2
_BOXES, _OCTAGON_M = 16, 5.0
# The radius (m) and colour of the bars that show the joints of a train.
_BAR_M, _BAR_RGBA = 0.006, (0.35, 0.35, 0.4, 1.0)
# Steps after which a body stands.
_STANDING = 300
# Hills: how many waves, and the longest and the shortest (m).
_WAVES, _LONGEST_M, _SHORTEST_M = 40, 6.0, 2.0


def car_name(car: int) -> str:
    """The prefix of all that belongs to a car; the first is the head."""
    return f"car{car}_"


def compose(
    preset: Preset,
    scene: str = "flat",
    cars: int = 1,
    *,
    seed: int = 1,
    angle: float | None = None,
    bouncy: bool = False,
    timestep: float = 0.001,
) -> mujoco.MjSpec:
    """A scene with a car, or with a train whose head is the first.

    Args:
        preset: The numbers of every car.
        scene: The scene's name, or a file.
        cars: How many.
        seed: Random seed of boxes and hills.
        angle: That of the scene's slopes, rad.
        bouncy: Whether its walls are springy rather than dead.
        timestep: MuJoCo's, s.

    Raises:
        ValueError: A file is no MJCF, or there is no scene or number of cars as given, or it has no
            slopes or walls for `angle` and `bouncy`.
    """
    if scene not in SCENES and not scene.endswith(".xml"):
        raise ValueError(
            f"there is no scene '{scene}'; there are {', '.join(SCENES)}, and files NAME.xml"
        )
    if cars < 1:
        raise ValueError(f"a train of {cars} cars cannot be: give 1 or more")
    spec = _assemble(preset, scene, cars, seed, angle, bouncy, timestep)
    spec.option.impratio = _impratio(preset, cars)
    return spec


def _assemble(
    preset: Preset,
    scene: str,
    cars: int,
    seed: int,
    angle: float | None,
    bouncy: bool,
    timestep: float,
) -> mujoco.MjSpec:
    path = Path(scene) if scene.endswith(".xml") else HERE / "scenes" / f"{scene}.xml"
    if not path.is_file():
        raise ValueError(f"there is no file {path}")
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        why = " ".join(str(error).split())
        raise ValueError(f"{path} cannot be read as a scene of MuJoCo: {why}") from None
    if any(body.name.endswith("car") for body in spec.bodies):
        raise ValueError(
            f"{path} has cars in it already: open it in a viewer, or give a scene without"
        )
    spec.option.timestep = timestep
    ground_m = _shape(spec, scene, np.random.default_rng(seed), angle, bouncy)
    frame = spec.worldbody.add_frame(pos=((cars - 1) * preset.pitch / 2, 0.0, ground_m))
    for car in range(cars):
        own, prefix = _car(preset, alone=cars == 1), car_name(car)
        own.option.timestep = timestep
        # Own scenes keep their gravity; tyres slide as the preset says only as the car is computed.
        own.option.gravity = spec.option.gravity
        spec.option.integrator, spec.option.cone = own.option.integrator, own.option.cone
        spec.attach(own, prefix=prefix, frame=frame)
        body = spec.body(prefix + "car")
        if car:
            body.pos = (0.0, 0.0, 0.0)
            spec.delete(spec.joint(prefix + "root"))
            _couple(body, prefix, preset)
            _draw_joint(body, prefix, preset)
        frame = body.add_frame(pos=(-preset.pitch, 0.0, 0.0))
    return spec


def slip_per_newton(model: mujoco.MjModel) -> float:
    """How fast a contact slides for each newton of friction, m/(s N).

    It is the mean of all contacts of a standing body. In MuJoCo friction is a force f with
    a + R f = -b v, and in steady sliding a = 0, so v = R f / b.
    """
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, _STANDING)
    rows = np.array([contact.efc_address + 1 for contact in data.contact if contact.dim > 1])
    return float(np.mean(data.efc_R[rows] / data.efc_KBIP[rows, 1]))


@cache
def _impratio(preset: Preset, cars: int) -> float:
    """MuJoCo's option that makes contacts slide as the preset says.

    Without it they hold far better than those of the authors' engine.
    """
    return (
        slip_per_newton(_assemble(preset, "flat", cars, 1, None, False, 0.001).compile())
        / preset.slip
    )


def _car(preset: Preset, *, alone: bool) -> mujoco.MjSpec:
    """A car with the preset's numbers.

    Only a car that is alone has casters; those of a train hold each other up.
    """
    spec = mujoco.MjSpec.from_file(str(HERE / "car.xml"))
    spec.body("car").pos = (0.0, 0.0, preset.wheel_radius)
    body = spec.geom("body")
    body.size[:2], body.mass, body.friction[0] = (
        (preset.body_radius, preset.body_height / 2),
        preset.body_mass,
        preset.friction,
    )
    for end, sign in (("front", 1.0), ("rear", -1.0)):
        caster, radius = spec.geom(f"{end}_caster"), preset.wheel_radius / 4
        if alone:
            caster.size[0] = radius
            caster.pos = (
                sign * (preset.body_radius - 2 * radius),
                0.0,
                radius - preset.wheel_radius,
            )
        else:
            spec.delete(caster)
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        spec.body(f"{side}_wheel").pos = (
            0.0,
            sign * (preset.body_radius + preset.wheel_width / 2),
            0.0,
        )
        wheel, mark, joint = spec.geom(f"{side}_wheel"), spec.geom(f"{side}_mark"), spec.joint(side)
        wheel.size[:2], wheel.mass, wheel.friction[0] = (
            (preset.wheel_radius, preset.wheel_width / 2),
            preset.wheel_mass,
            preset.friction,
        )
        mark.pos, mark.size = (
            (0.0, 0.0, preset.wheel_radius / 2),
            (preset.wheel_radius / 8, 0.6 * preset.wheel_width, preset.wheel_radius / 2),
        )
        joint.damping[0] = preset.wheel_drag * preset.wheel_radius
    return spec


def _couple(body: Any, prefix: str, preset: Preset) -> None:
    """The torsion springs to the car before: yaw and pitch, halfway between the two."""
    for name, axis in (("yaw", (0.0, 0.0, 1.0)), ("pitch", (0.0, 1.0, 0.0))):
        joint = body.add_joint(
            name=prefix + name,
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=axis,
            pos=(preset.pitch / 2, 0.0, 0.0),
        )
        joint.stiffness[0], joint.damping[0] = preset.spring, preset.spring_damping
        joint.limited, joint.range = (
            mujoco.mjtLimited.mjLIMITED_TRUE,
            (-preset.joint_range, preset.joint_range),
        )


def _draw_joint(body: Any, prefix: str, preset: Preset) -> None:
    """A bar from each of two cars to the joint between them, to look at alone."""
    top, half = preset.body_height / 2 + 2 * _BAR_M, preset.pitch / 2
    for owner, name, reach in ((body, "front_bar", half), (body.parent, "rear_bar", -half)):
        owner.add_geom(
            name=prefix + name,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=(0.0, 0.0, top, reach, 0.0, top),
            size=(_BAR_M, 0.0, 0.0),
            mass=0.0,
            contype=0,
            conaffinity=0,
            group=2,
            rgba=_BAR_RGBA,
        )


def _shape(
    spec: mujoco.MjSpec, scene: str, rng: np.random.Generator, angle: float | None, bouncy: bool
) -> float:
    """What is not in the scene's file. Returns how high (m) the ground is in the middle."""
    if angle is not None:
        if scene not in SLOPED:
            raise ValueError(
                f"the scene '{scene}' has no slopes of one angle; {' and '.join(SLOPED)} have"
            )
        if not 0.0 <= angle < pi / 2:
            raise ValueError(
                f"slopes of {angle!r} rad cannot be: give 0 or more and less than pi/2"
            )
        for geom in spec.geoms:
            if geom.name.startswith("slope_"):
                _tilt(geom, angle)
    if bouncy:
        walls = [geom for geom in spec.geoms if geom.name.startswith("wall")]
        if not walls:
            raise ValueError(f"the scene '{scene}' has no walls; {' and '.join(WALLED)} have")
        for wall in walls:
            wall.solref[:2] = BOUNCY
            wall.priority = max(wall.priority, _WALL_PRIORITY)
    if scene == "octagon":
        _strew(spec, rng)
    elif scene == "hills":
        hills = spec.hfield("hills")
        heights = _hills(int(hills.nrow), float(hills.size[0]), rng)
        hills.userdata = heights.ravel()
        return float(heights[heights.shape[0] // 2, heights.shape[1] // 2] * hills.size[2])
    return 0.0


def _tilt(geom: Any, angle: float) -> None:
    """Give a slope this angle about its foot."""
    normal = np.cross(geom.alt.xyaxes[:3], geom.alt.xyaxes[3:])
    slope = float(np.arctan2(np.hypot(*normal[:2]), normal[2]))
    out, half = -normal[:2] / np.hypot(*normal[:2]), float(geom.size[0])
    foot = geom.pos[:2] @ out - half * cos(slope)
    geom.pos = (*(out * (foot + half * cos(angle))), half * sin(angle))
    geom.alt.xyaxes = (*(out * cos(angle)), sin(angle), -out[1], out[0], 0.0)


def _strew(spec: mujoco.MjSpec, rng: np.random.Generator) -> None:
    """Boxes of foam, as in LPZRobots' octagon.

    Edges of 0.1 to 1 m there, to 0.5 m in this smaller one, 0.3 m high, 2 to 5 kg/m^3.
    """
    for number in range(_BOXES):
        edges = rng.uniform(0.1, 0.5, 2)
        away, around = _OCTAGON_M * sqrt(rng.uniform(0.12, 0.7)), rng.uniform(0.0, 2 * pi)
        turned = rng.uniform(0.0, pi)
        body = spec.worldbody.add_body(
            name=f"box{number}",
            pos=(away * cos(around), away * sin(around), 0.15),
            quat=(cos(turned / 2), 0.0, 0.0, sin(turned / 2)),
        )
        body.add_freejoint(name=f"box{number}")
        size = (edges[0] / 2, edges[1] / 2, 0.15)
        mass = float(rng.uniform(2.0, 5.0)) * 8 * size[0] * size[1] * size[2]
        body.add_geom(
            spec.find_default("obstacle"), name=f"box{number}", size=size, mass=mass, contype=1
        )


def _hills(points: int, half_m: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Heights from 0 to 1, (points, points), of random waves, flat where cars begin."""
    x, y = np.meshgrid(np.linspace(-half_m, half_m, points), np.linspace(-half_m, half_m, points))
    height = np.zeros_like(x)
    for length, direction, phase in zip(
        rng.uniform(_SHORTEST_M, _LONGEST_M, _WAVES),
        rng.uniform(0.0, 2 * pi, _WAVES),
        rng.uniform(0.0, 2 * pi, _WAVES),
        strict=True,
    ):
        height += length * np.cos(
            2 * pi * (x * cos(direction) + y * sin(direction)) / length + phase
        )
    height = (height - height.min()) / (height.max() - height.min())
    level = height[points // 2, points // 2]
    near = np.exp(-((np.hypot(x, y) / 1.5) ** 4))
    return np.asarray(height + near * (level - height))
