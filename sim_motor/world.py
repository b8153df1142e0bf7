"""The robot's body on a plane between two walls: what floor and walls do to it and to its wheels.

The plane's x axis runs from wall to wall. Everything is on the motors' grid of substeps: forces
from where things are, then speeds, then places (symplectic Euler).

- The body's moment of inertia is that of half its mass over each wheel, as in sim_motor.constants,
  and each wheel bears half its weight.
- A tyre's tread is a damped spring between rim and floor, forward and sideways. It holds with no
  more than grip times its load (Coulomb's law, regularised by the tread). Beyond that it slips.
- A wall is a stiff, damped spring that pushes, and never pulls, at the four corners of the body:
  the ends of both bumpers. As it swings faster than anything else, the body takes PARTS steps in
  each substep.
"""

from collections.abc import Sequence
from math import cos, hypot, sin
from typing import NamedTuple, Protocol

import numpy as np

from sim_motor.compiled import jit
from sim_motor.compiled_motor import advance_in_place
from sim_motor.constants import GRAVITY, SUBSTEP_S, Array, Constants, data
from sim_motor.motor import WHEEL_SPEED
from sim_motor.scene import Scene

BodyNumbers = tuple[float, float, float, float, float, float]
TyreNumbers = tuple[float, float]
WallNumbers = tuple[float, float, float]
Drive = tuple[int, float, float]

PARTS = 8


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

    state: Array
    mount: int
    constants: Constants

    def drive(self) -> Drive: ...
    def next_turn(self) -> float: ...
    def reach(self, substep: int) -> None: ...


class World:
    """A body at rest halfway between the walls, on a left and a right wheel.

    Args:
        scene: The walls.
        motors: The left and the right one, with the constants of a wheel alone, see `alone`.
        heading: Where the body points, rad; 0 faces the wall at positive x.
    """

    def __init__(self, scene: Scene, motors: Sequence[Driven], heading: float = 0.0) -> None:
        robot = {name: float(entry[0]) for name, entry in data()["robot"].items()}
        grip = robot["grip"] if scene.grip is None else scene.grip
        width = robot["body_width"] if scene.bumper is None else scene.bumper
        stiffness = robot["wall_stiffness"] if scene.stiffness is None else scene.stiffness
        self._place = np.array([0.0, 0.0, heading, 0.0, 0.0, 0.0])
        self._left, self._right = motors
        self._tables = self._left.constants.tables(), self._right.constants.tables()
        self._scalars = self._left.constants.scalars(), self._right.constants.scalars()
        self._body: BodyNumbers = (
            robot["mass"],
            robot["track"],
            robot["wheel_radius"],
            grip,
            robot["body_length"] / 2,
            width / 2,
        )
        self._walls: WallNumbers = (scene.walls / 2, stiffness, robot["wall_damping"])
        self._stretches = np.zeros((2, 2))
        self._tyre: TyreNumbers = robot["tyre_stiffness"], robot["tyre_damping"]
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
        wheels = (left.state, right.state), (left.drive(), right.drive()), (left.mount, right.mount)
        _advance(
            substeps,
            self._place,
            self._stretches,
            *wheels,
            self._tables,
            self._scalars,
            self._body,
            self._tyre,
            self._walls,
        )


def alone(constants: Constants) -> Constants:
    """The motor with its wheel and no share of the body."""
    return constants.with_wheel(data()["robot"]["wheel_inertia"][0])


@jit
def tyre_force(
    stretch: Array, slip: float, side_slip: float, most: float, tyre: TyreNumbers
) -> tuple[float, float]:
    """The force of the floor on the body at a tyre.

    Args:
        stretch: How far the tread is stretched forward and sideways, m. A substep is added to it.
        slip: Speed of the rim over the floor backward, m/s.
        side_slip: The same to the right.
        most: With no more than this does the tyre hold, N.
        tyre: Stiffness and damping.

    Returns:
        (forward, sideways), N.
    """
    stiffness, damping = tyre
    forward = stiffness * (stretch[0] + SUBSTEP_S * slip) + damping * slip
    sideways = stiffness * (stretch[1] + SUBSTEP_S * side_slip) + damping * side_slip
    force = hypot(forward, sideways)
    if force > most:
        forward, sideways = forward * most / force, sideways * most / force
        stretch[0], stretch[1] = forward / stiffness, sideways / stiffness
    else:
        stretch[0] += SUBSTEP_S * slip
        stretch[1] += SUBSTEP_S * side_slip
    return forward, sideways


@jit
def wall_push(place: Array, ahead: float, aside: float, walls: WallNumbers) -> tuple[float, float]:
    """What both walls do to one corner of the body.

    Args:
        place: As Place.
        ahead: How far the corner is ahead of the centre, m.
        aside: How far it is to the left, m.
        walls: Half their distance, stiffness and damping.

    Returns:
        (force along x in N, torque on the body in N m).
    """
    half_distance, stiffness, damping = walls
    x, _, heading, speed_x, _, turn = place
    arm_x = ahead * cos(heading) - aside * sin(heading)
    arm_y = ahead * sin(heading) + aside * cos(heading)
    speed = speed_x - turn * arm_y
    force = 0.0
    if x + arm_x > half_distance:
        force = -max(0.0, stiffness * (x + arm_x - half_distance) + damping * speed)
    elif x + arm_x < -half_distance:
        force = max(0.0, stiffness * (-half_distance - x - arm_x) - damping * speed)
    return force, -arm_y * force


@jit
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
        body: Mass, track, wheel radius, grip, half length and half width.
        walls: As in `wall_push`.
    """
    mass, track, _, _, half_length, half_width = body
    step_s = substep_s / parts
    for _ in range(parts):
        direction_x, direction_y = cos(place[2]), sin(place[2])
        along = forward[0] + forward[1]
        force_x = along * direction_x - sideways * direction_y
        force_y = along * direction_y + sideways * direction_x
        torque = (forward[1] - forward[0]) * track / 2
        for ahead in (half_length, -half_length):
            for aside in (half_width, -half_width):
                push, twist = wall_push(place, ahead, aside, walls)
                force_x += push
                torque += twist
        place[3] += step_s * force_x / mass
        place[4] += step_s * force_y / mass
        place[5] += step_s * torque / (mass * track * track / 4)
        for index in range(3):
            place[index] += step_s * place[index + 3]


@jit
def _advance(
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
    mass, track, radius, grip, _, _ = body
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
        move_body(place, (forward[0], forward[1]), sideways, SUBSTEP_S, PARTS, body, walls)
