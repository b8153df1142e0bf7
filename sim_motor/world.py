"""The robot's body on a plane between walls: what floor and walls do to it and to its wheels.

The plane's x axis runs from wall to wall. Everything is on the motors' grid of substeps: forces
from where things are, then speeds, then places (symplectic Euler).

- The body is a uniform plate, and each wheel bears half its weight. It couples the wheels: as it
  resists being turned, a wheel that speeds up takes the other one along. Wheels alone, as in
  sim_motor.constants, stand for a body with half its mass over each wheel, whose moment of inertia
  is 0.66 times that of the plate. There driving and turning decouple.
- A tyre's tread is a damped spring between rim and floor, forward and sideways. It holds with no
  more than grip times its load (Coulomb's law, regularised by the tread). Beyond that it slips.
  Between motor and rim is an axle, rigid or another damped spring (sim_motor.axle).
- A wall is a stiff, damped spring that pushes, and never pulls, at the four corners of the body:
  the ends of both bumpers. As it swings faster than anything else, the body takes PARTS steps in
  each substep where there are walls.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from math import cos, hypot, inf, sin
from typing import NamedTuple, Protocol

import numpy as np

from sim_motor.arrays import Array, scalars, tables
from sim_motor.axle import next_stretch, twist_speed
from sim_motor.compiled import compiled, inner_jit, jit
from sim_motor.compiled_motor import advance_in_place
from sim_motor.constants import GRAVITY, SUBSTEP_S, Constants, data
from sim_motor.motor import WHEEL_SPEED
from sim_motor.scene import Scene

BodyNumbers = tuple[float, float, float, float, float, float, float]
TyreNumbers = tuple[float, float, float, float]
WallNumbers = tuple[float, float, float, float]
Drive = tuple[int, float, float]

PARTS = 8
_twist_speed, _next_stretch = compiled(twist_speed), compiled(next_stretch)


class Place(NamedTuple):
    """Where the body is and how it moves: m, rad, m/s and rad/s.

    (0, 0) is halfway between the walls, heading 0 along x.
    """

    x: float
    y: float
    heading: float
    speed_x: float
    speed_y: float
    turn: float


class Driven(Protocol):
    """A motor whose wheel stands on the floor, as sim_motor.wheel_motor.SimMotor."""

    state: array[float]
    mount: int
    constants: Constants

    def drive(self) -> Drive: ...
    def next_turn(self) -> float: ...
    def reach(self, substep: int) -> None: ...


class World:
    """A body at rest halfway between the walls, on a left and a right wheel.

    Args:
        scene: Floor and walls.
        motors: The left and the right one, with the constants of a wheel alone, see `alone`.
        heading: Where the body points, rad; 0 faces the wall at positive x.
    """

    def __init__(self, scene: Scene, motors: Sequence[Driven], heading: float = 0.0) -> None:
        self._place = np.array([0.0, 0.0, heading, 0.0, 0.0, 0.0])
        self._left, self._right = motors
        constants = [motor.constants for motor in motors]
        self._tables, self._scalars = tuple(tables(constants)), tuple(scalars(constants))
        self._states = np.frombuffer(self._left.state), np.frombuffer(self._right.state)
        self._numbers = numbers(scene)
        self._stretches = no_stretches()
        self._substep = 0
        self._advance(0)  # compiled here, where nobody waits for it

    def catch_up(self, present: int) -> None:
        """Bring body and wheels up to a substep, with every duty that begins to act on the way."""
        present = max(present, self._substep)
        turn = -1
        while turn < present:
            turn = int(min(present, self._left.next_turn(), self._right.next_turn()))
            self._advance(turn - self._substep)
            self._substep = turn
            self._left.reach(turn)
            self._right.reach(turn)

    def place(self) -> Place:
        """Where the body was when it was last brought up to date."""
        return Place(*self._place.tolist())

    def _advance(self, substeps: int) -> None:
        left, right = self._left, self._right
        wheels = self._states, (left.drive(), right.drive()), (left.mount, right.mount)
        advance(
            substeps,
            self._place,
            self._stretches,
            *wheels,
            self._tables,
            self._scalars,
            *self._numbers,
        )


def plate_inertia(mass: float, length: float, width: float) -> float:
    """The moment of inertia of a uniform plate about the axis through its centre.

    Args:
        mass: Its mass, kg.
        length: Of one side, m.
        width: Of the other, m.

    Returns:
        The moment of inertia, kg m2.
    """
    return mass * (length**2 + width**2) / 12


def numbers(scene: Scene) -> tuple[BodyNumbers, TyreNumbers, WallNumbers]:
    """Body, tyres and walls as `advance` takes them.

    Args:
        scene: Floor and walls.

    Returns:
        The body's mass, moment of inertia, track, wheel radius, grip, half length and half width of
        its bumpers; stiffness and damping of a tread and of an axle; half the distances between
        walls along x and along y, and a wall's stiffness and damping. SI units.
    """
    robot = {name: float(entry[0]) for name, entry in data()["robot"].items()}
    grip = robot["grip"] if scene.grip is None else scene.grip
    bumper = robot["body_width"] if scene.bumper is None else scene.bumper
    body = (
        robot["mass"],
        plate_inertia(robot["mass"], robot["body_length"], robot["body_width"]),
        robot["track"],
        robot["wheel_radius"],
        grip,
        robot["body_length"] / 2,
        bumper / 2,
    )
    walls = (
        inf if scene.walls is None else scene.walls / 2,
        inf if scene.across is None else scene.across / 2,
        float(robot["wall_stiffness"] if scene.stiffness is None else scene.stiffness),
        robot["wall_damping"],
    )
    tread = robot["tyre_stiffness"], robot["tyre_damping"]
    axle_stiffness = float(robot["axle_stiffness"] if scene.axle is None else scene.axle)
    return body, (*tread, axle_stiffness, robot["axle_damping"]), walls


@jit
def no_stretches() -> Array:
    """Of treads and axles that nothing loads, as `tyre_force` takes them for each side, (2, 3)."""
    return np.zeros((2, 3))


def alone(constants: Constants) -> Constants:
    """The motor with its wheel and no share of the body."""
    return constants.with_wheel(data()["robot"]["wheel_inertia"][0])


@inner_jit
def tyre_force(
    stretch: Array, slip: float, side_slip: float, most: float, tyre: TyreNumbers
) -> tuple[float, float]:
    """The force of the floor on the body at a tyre.

    Args:
        stretch: How far the tread is stretched forward and sideways, and how far the axle is
            twisted at the rim, m. A substep is added to them.
        slip: Speed over the floor backward that the rim has on a rigid axle, m/s.
        side_slip: The rim's to the right.
        most: With no more than this does the tyre hold, N.
        tyre: As in `numbers`.

    Returns:
        (forward, sideways), N.
    """
    stiffness, damping, axle_stiffness, axle_damping = tyre
    tread, axle = (stiffness, damping), (axle_stiffness, axle_damping)
    slip -= _twist_speed(stretch[2], stretch[0], slip, tread, axle)
    forward = stiffness * (stretch[0] + SUBSTEP_S * slip) + damping * slip
    sideways = stiffness * (stretch[1] + SUBSTEP_S * side_slip) + damping * side_slip
    force = hypot(forward, sideways)
    if force > most:
        forward, sideways = forward * most / force, sideways * most / force
        stretch[0] = _next_stretch(stretch[0], forward, tread)
        stretch[1] = _next_stretch(stretch[1], sideways, tread)
    else:
        stretch[0] += SUBSTEP_S * slip
        stretch[1] += SUBSTEP_S * side_slip
    stretch[2] = _next_stretch(stretch[2], forward, axle)
    return forward, sideways


@inner_jit
def wall_force(beyond: float, speed: float, stiffness: float, damping: float) -> float:
    """How hard a wall pushes back, N.

    Args:
        beyond: How far something is in the wall, m; 0 or less is in front of it.
        speed: How fast it goes on into the wall, m/s.
        stiffness: The wall's, N/m.
        damping: The wall's, N s/m.
    """
    return max(0.0, stiffness * beyond + damping * speed) if beyond > 0.0 else 0.0


@inner_jit
def wall_push(
    place: Array, ahead: float, aside: float, walls: WallNumbers
) -> tuple[float, float, float]:
    """What the walls do to one corner of the body.

    Args:
        place: As Place.
        ahead: How far the corner is ahead of the centre, m.
        aside: How far it is to the left, m.
        walls: Half their distances along x and y, stiffness and damping.

    Returns:
        (force along x in N, force along y in N, torque on the body in N m).
    """
    half_x, half_y, stiffness, damping = walls
    x, y, heading, speed_x, speed_y, turn = place
    arm_x = ahead * cos(heading) - aside * sin(heading)
    arm_y = ahead * sin(heading) + aside * cos(heading)
    speed_x, speed_y = speed_x - turn * arm_y, speed_y + turn * arm_x
    force_x = wall_force(-half_x - x - arm_x, -speed_x, stiffness, damping) - wall_force(
        x + arm_x - half_x, speed_x, stiffness, damping
    )
    force_y = wall_force(-half_y - y - arm_y, -speed_y, stiffness, damping) - wall_force(
        y + arm_y - half_y, speed_y, stiffness, damping
    )
    return force_x, force_y, arm_x * force_y - arm_y * force_x


@inner_jit
def move_body(
    place: Array,
    forward: tuple[float, float],
    sideways: float,
    substep_s: float,
    parts: int,
    body: BodyNumbers,
    walls: WallNumbers,
) -> None:
    """One substep of the body, in parts, under the floor's forces.

    Args:
        place: As Place; changed in place.
        forward: Force at the left and at the right wheel, N.
        sideways: Force to the left, N.
        substep_s: How long the substep lasts, s.
        parts: How many steps it is taken in.
        body: As in `numbers`.
        walls: As in `wall_push`.
    """
    mass, inertia, track, _, _, half_length, half_width = body
    step_s = substep_s / parts
    for _ in range(parts):
        direction_x, direction_y = cos(place[2]), sin(place[2])
        along = forward[0] + forward[1]
        force_x = along * direction_x - sideways * direction_y
        force_y = along * direction_y + sideways * direction_x
        torque = (forward[1] - forward[0]) * track / 2
        for ahead in (half_length, -half_length):
            for aside in (half_width, -half_width):
                push_x, push_y, twist = wall_push(place, ahead, aside, walls)
                force_x += push_x
                force_y += push_y
                torque += twist
        place[3] += step_s * force_x / mass
        place[4] += step_s * force_y / mass
        place[5] += step_s * torque / inertia
        for index in range(3):
            place[index] += step_s * place[index + 3]


@inner_jit
def advance(
    substeps: int,
    place: Array,
    stretches: Array,
    states: tuple[Array, Array],
    drives: tuple[Drive, Drive],
    mounts: tuple[int, int],
    tables: tuple[Array, Array],
    scalars: tuple[Array, Array],
    body: BodyNumbers,
    tyre: TyreNumbers,
    walls: WallNumbers,
) -> None:
    """Body and wheels after some substeps, in place.

    Args:
        substeps: How many.
        place: As Place.
        stretches: Of treads and axles, as in `tyre_force`, m, (2, 3).
        states: The motors', as in sim_motor.motor.
        drives: What drives them, as SimMotor.drive returns it.
        mounts: -1 for a motor that is mounted mirrored, else 1.
        tables: Constants.tables of the motors.
        scalars: Constants.scalars of the motors.
        body: As in `numbers`.
        tyre: As in `numbers`.
        walls: As in `numbers`.
    """
    mass, _, track, radius, grip, _, _ = body
    parts = PARTS if min(walls[0], walls[1]) < inf else 1
    most = grip * mass / 2 * GRAVITY
    forward = np.zeros(2)
    for _ in range(substeps):
        speed = place[3] * cos(place[2]) + place[4] * sin(place[2])
        drift = place[4] * cos(place[2]) - place[3] * sin(place[2])
        sideways = 0.0
        for side in range(2):
            state = states[side]
            duty, battery_v, load = drives[side]
            rim = radius * mounts[side] * state[WHEEL_SPEED]
            over_floor = speed + (track / 2 if side else -track / 2) * place[5]
            forward[side], aside = tyre_force(stretches[side], rim - over_floor, -drift, most, tyre)
            sideways += aside
            load -= mounts[side] * radius * forward[side]
            advance_in_place(state, 1, duty, battery_v, load, tables[side], scalars[side])
        move_body(place, (forward[0], forward[1]), sideways, SUBSTEP_S, parts, body, walls)
