"""The robot's body between walls.

What physics demands of it, and that a brick without walls is what it was.
"""

from math import hypot, inf, pi

import numpy as np
import pytest

from host.errors import WrongUse
from host.link.addresses import make_link
from robot.loop import Loop
from sim_motor.brick import SimBrick
from sim_motor.constants import GRAVITY, SUBSTEP_S, data
from sim_motor.motor import ANGLE, LAST_ANGLE
from sim_motor.scene import Scene
from sim_motor.world import PARTS, World, move_body, numbers, plate_inertia, tyre_force

ROBOT = {name: entry[0] for name, entry in data()["robot"].items()}
MASS, TRACK, RADIUS = ROBOT["mass"], ROBOT["track"], ROBOT["wheel_radius"]
INERTIA = plate_inertia(MASS, ROBOT["body_length"], ROBOT["body_width"])
BODY = (MASS, INERTIA, TRACK, RADIUS, 0.7, ROBOT["body_length"] / 2, ROBOT["body_width"] / 2)
TYRE = numbers(Scene())[1]
WALLS = (1.0, inf, ROBOT["wall_stiffness"], ROBOT["wall_damping"])


class HandClock:
    def __init__(self):
        self.time = 0.0

    def now(self):
        return self.time

    def wait(self, deadline, serve):
        self.time = deadline


def driven(scene, duties, seconds, seed=1, **options):
    """A brick after some seconds of constant duties, and its body's places on the way."""
    brick = SimBrick(seed, clock=HandClock(), scene=scene, **options)
    for motor, duty in zip(brick.motors, duties, strict=True):
        motor.write_duty(duty)
    places = []
    for tick in range(round(seconds * 100)):
        brick.clock.time = (tick + 1) / 100
        brick.truth()
        places.append(brick.world.place() if brick.world else None)
    return brick, places


def slide(place, seconds, walls=WALLS, parts=PARTS):
    """The body alone on ice, after each substep."""
    place, track = np.array(place, dtype=float), []
    for _ in range(round(seconds / SUBSTEP_S)):
        move_body(place, (0.0, 0.0), 0.0, SUBSTEP_S, parts, BODY, walls)
        track.append(place.copy())
    return np.array(track)


def kinetic(place):
    return 0.5 * MASS * hypot(place[3], place[4]) ** 2 + 0.5 * INERTIA * place[5] ** 2


# Without a wall in reach the body moves as the wheels' own model says.


@pytest.mark.parametrize("duties", [(85, 85), (-60, -60), (70, 40), (60, -60)])
def test_without_slip_the_wheels_turn_as_with_half_the_body_each(duties):
    free, _ = driven(None, duties, 1.0)
    placed, _ = driven(Scene(100.0, grip=5.0), duties, 1.0)
    for alone, carried in zip(free.truth(), placed.truth(), strict=True):
        assert carried.wheel_speed == pytest.approx(alone.wheel_speed, rel=0.01)


def test_the_controller_runs_the_same_in_an_empty_hall():
    """Same seed and phases: speed and torque M within a per cent."""

    def run(scene):
        brick = SimBrick(4, scene=scene)
        for motor in brick.motors:
            motor.state[ANGLE] = motor.state[LAST_ANGLE] = 0.4
        loop = Loop(brick.motors, brick.battery, brick.clock, 4)
        loop.start()
        angles = []
        for _ in range(240):
            loop.clock.wait(loop.deadline, lambda timeout_s: None)
            loop.tick()
            angles.append([motor.angle_rad() for motor in brick.motors])
        return np.abs(np.array(angles)[-1] - np.array(angles)[-100]).tolist()

    assert run(Scene(100.0, grip=5.0)) == pytest.approx(run(None), rel=0.01)


def test_the_body_goes_where_its_wheels_roll():
    brick, places = driven(Scene(100.0, grip=2.0), (50, 50), 2.0)
    rolled = np.mean([truth.wheel_angle for truth in brick.truth()]) * RADIUS
    assert hypot(places[-1].x, places[-1].y) == pytest.approx(rolled, rel=0.02)
    assert (
        abs(
            places[-1].speed_y * np.cos(places[-1].heading)
            - places[-1].speed_x * np.sin(places[-1].heading)
        )
        < 1e-4
    )


def test_a_robot_that_turns_on_the_spot_stays_there():
    brick, places = driven(Scene(100.0), (-60, 60), 4.0)
    assert places[-1].heading > 4 * pi
    assert max(hypot(place.x, place.y) for place in places) < 0.02
    left, right = brick.truth()
    assert places[-1].turn == pytest.approx(
        (right.wheel_speed - left.wheel_speed) * RADIUS / TRACK, rel=0.02
    )


# The floor.


def test_a_wheel_at_the_traction_limit_slips_and_pushes_no_harder():
    _, places = driven(Scene(100.0, grip=0.05), (85, 85), 0.5)
    speeds = [hypot(place.speed_x, place.speed_y) for place in places]
    assert np.diff(speeds[5:15]) == pytest.approx(0.05 * GRAVITY * 0.01, rel=0.02)
    brick, places = driven(Scene(100.0, grip=0.05), (85, 85), 0.2)
    assert all(truth.wheel_speed * RADIUS > places[-1].speed_x + 0.05 for truth in brick.truth())


@pytest.mark.parametrize("slip", [(0.3, 0.0), (-0.3, 0.0), (0.2, -0.2), (1e-7, 1e-7), (0.0, 0.0)])
def test_a_tyre_holds_with_no_more_than_its_grip_and_against_its_slip(slip):
    stretch = np.zeros(3)
    for _ in range(300):
        force = tyre_force(stretch, *slip, 2.4, TYRE)
        assert hypot(*force) <= 2.4 * (1 + 1e-12)
        assert all(part * way >= 0 for part, way in zip(force, slip, strict=True))
    assert hypot(*force) == pytest.approx(
        min(2.4, 0.3 * ROBOT["tyre_stiffness"] * hypot(*slip)), rel=0.01
    )


def test_on_ice_a_moving_body_keeps_its_momentum():
    track = slide((0.0, 0.0, 0.3, 0.2, -0.1, 1.5), 1.0)
    assert track[-1][3:].tolist() == [0.2, -0.1, 1.5]


# The wall.


@pytest.mark.parametrize("heading", [0.0, 0.2, 0.7, -1.2, pi])
@pytest.mark.parametrize("turn", [0.0, 3.0])
def test_no_energy_comes_from_a_wall(heading, turn):
    before = (0.8, 0.0, heading, 0.4, 0.1, turn)
    track = slide(before, 1.0)
    assert track[-1][3] < 0
    assert kinetic(track[-1]) <= kinetic(np.array(before))
    assert track[-1][4] == pytest.approx(0.1)  # a wall only pushes along x


def test_a_wall_gives_back_what_its_damping_leaves():
    """Square on two corners, as a damped spring between a mass and the wall."""
    walls = [(1.0, inf, 20000.0, damping) for damping in (0.0, 20.0, 40.0, 80.0)]
    speeds = [abs(slide((0.85, 0.0, 0.0, 0.4, 0.0, 0.0), 1.0, wall)[-1][3]) for wall in walls]
    assert speeds[0] == pytest.approx(0.4, rel=0.03)
    assert speeds == sorted(speeds, reverse=True)
    # A damped spring that lets go where its force is zero; both corners push the whole mass.
    ratio = 2 * 40.0 / (2 * np.sqrt(2 * 20000.0 * MASS))
    root = np.sqrt(1 - ratio**2)
    assert speeds[2] / 0.4 == pytest.approx(
        np.exp(-ratio / root * (pi - np.arctan2(2 * ratio * root, 1 - 2 * ratio**2))), rel=0.02
    )


@pytest.mark.parametrize("heading", [0.0, 0.3, -0.8])
def test_halving_the_steps_changes_a_rebound_by_less_than_a_per_cent_of_the_impact(heading):
    before = (0.85, 0.0, heading, 0.4, 0.0, 0.0)
    coarse, fine = (slide(before, 0.5, parts=parts)[-1] for parts in (PARTS, 2 * PARTS))
    assert coarse[3:5] == pytest.approx(fine[3:5], abs=0.01 * 0.4)
    assert coarse[5] == pytest.approx(fine[5], abs=0.01 * 0.4 / (ROBOT["body_width"] / 2))


@pytest.mark.parametrize("bumper", [0.05, 0.16, 0.4])
def test_the_stiffest_wall_and_the_widest_bumper_throw_no_robot(bumper):
    _, places = driven(Scene(0.6, grip=1.0, stiffness=100000.0, bumper=bumper), (85, 85), 3.0)
    length = ROBOT["body_length"] / 2
    reach = [
        abs(place.x) + length * abs(np.cos(place.heading)) + bumper / 2 * abs(np.sin(place.heading))
        for place in places
    ]
    assert max(reach) < 0.302
    assert max(hypot(place.speed_x, place.speed_y) for place in places) < 0.4


def test_at_a_smooth_wall_the_tyres_spin_and_on_a_rough_floor_the_motors_stall():
    smooth, rough = (driven(Scene(0.6, grip=grip), (70, 70), 3.0)[0].truth() for grip in (0.7, 3.0))
    assert min(truth.wheel_speed for truth in smooth) > 4
    assert max(abs(truth.wheel_speed) for truth in rough) < 1e-6


# The same each time, however it is looked at.


def test_looking_more_often_changes_no_bit():
    def run(glances):
        brick = SimBrick(7, clock=HandClock(), scene=Scene(0.6))
        for tick, (left, right) in enumerate(
            np.random.default_rng(0).integers(-100, 101, (60, 2)).tolist()
        ):
            for glance in np.linspace(0, 0.03, glances):
                brick.clock.time = tick * 0.03 + glance
                brick.motors[tick % 2].angle_rad()
            brick.motors[1].write_duty(right)
            brick.motors[0].write_duty(left)
        return [motor.state.tolist() for motor in brick.motors], brick.world.place()

    assert run(1) == run(17)


def test_a_duty_acts_on_its_own_wheel_whichever_is_looked_at():
    one, other = (SimBrick(9, clock=HandClock(), scene=Scene(2.0)) for _ in range(2))
    for brick, order in ((one, (0, 1)), (other, (1, 0))):
        for side in order:
            brick.motors[side].write_duty(50 * (1 - 2 * side))
        brick.clock.time = 0.3
        for side in order:
            brick.motors[side].angle_rad()
    assert one.truth() == other.truth()
    assert one.truth()[0].wheel_speed > 1
    assert one.truth()[1].wheel_speed < -1


def test_a_mirrored_motor_drives_the_same_body():
    plain, _ = driven(Scene(2.0), (60, 60), 1.0)
    mirrored, _ = driven(Scene(2.0), (60, -60), 1.0, mount=(1, -1))
    assert mirrored.world.place().x == pytest.approx(plain.world.place().x, rel=0.02)


def test_without_walls_nothing_of_it_is_there():
    brick = SimBrick(3)
    assert brick.world is None
    assert brick.motors[0].constants.wheel_inertia > 10 * ROBOT["wheel_inertia"]


def test_in_a_world_both_wheels_begin_where_the_robots_program_resets_them():
    for apart in (0.0, 1.2):
        left, right = SimBrick(5, scene=Scene(2.0, apart=apart)).truth()
        assert (left.motor_angle, right.motor_angle) == (0.0, apart)


# Words for nonsense.


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("walls=0.1", r"walls cannot be 0\.1"),
        ("walls=nan", "walls cannot be nan"),
        ("walls=far", "far"),
        ("walls=2&grip=-1", r"grip cannot be -1"),
        ("walls=2&stiffness=1e9", "stiffness cannot be"),
        ("walls=2&bumper=3", "bumper cannot be 3"),
        ("walls=2&apart=4", "apart cannot be 4"),
        ("stiffness=5e3", "'stiffness' belongs to a robot between walls"),
        ("walls=2&wind=3", "no option 'wind'"),
    ],
)
def test_nonsense_is_refused_in_words(options, said):
    with pytest.raises(WrongUse, match=said):
        make_link("sim://?" + options)


def test_a_link_stands_in_the_world_that_it_asks_for():
    link = make_link("sim://?walls=2.0&grip=1.5&idle=1", seed=1)
    assert isinstance(link.brick.world, World)
    assert isinstance(make_link("sim://?grip=1.5&idle=1", seed=1).brick.world, World)
    assert make_link("sim://?idle=1", seed=1).brick.world is None
