"""Robots at once: each as the robot's own loop on a brick with a body, and what their bodies do."""

from math import pi

import numpy as np
import pytest

from robot.kick_requests import parse
from robot.kicks import DIRECTION_TICKS, WHEELS, Kick
from robot.loop import Loop
from robot.params import Params
from robot.record import unpack
from sim_motor import batch, robots
from sim_motor.brick import SimBrick
from sim_motor.constants import GRAVITY, SUBSTEP_S, data, load
from sim_motor.robots import Start
from sim_motor.scene import Scene
from sim_motor.world import alone, move_body, numbers, plate_inertia

TICKS, BEGIN = 400, 150
ROBOT = {name: entry[0] for name, entry in data()["robot"].items()}


def with_changes(**changes):
    params = Params()
    params.apply(params.check(changes))
    return params


def run_loop(seed, scene, changes, request=None, later=None):
    """(brick, start, records, places, kick) of the robot's own loop."""
    brick = SimBrick(seed, scene=scene, dither_deg=0.2 if seed == 3 else None)
    states = np.array([motor.state for motor in brick.motors])
    heading = brick.world.place().heading
    loop = Loop(brick.motors, brick.battery, brick.clock, seed)
    loop.set_params(changes)
    loop.start()
    places, kick = [], None
    for tick in range(TICKS):
        brick.clock.wait(loop.deadline, lambda timeout_s: None)
        if request and tick == BEGIN:
            loop.kick({"id": "k", **request})
        if later and tick == BEGIN:
            loop.set_params(later)
        loop.tick()
        places.append(brick.world.place()[:3])
    events = [loop.blackbox.event(number) for number in range(loop.blackbox.next_event)]
    potentials = next(event["x"] for event in events if event["event"] == "start")
    for event in events:
        if event["event"] == "kick":
            kick = Kick(**event["kick"])
    start = Start(states[None], np.array([potentials]), np.array([heading]))
    return brick, start, unpack(loop.blackbox.read(0, TICKS)), np.array(places), kick


@pytest.mark.parametrize(
    ("seed", "scene", "changes", "request_", "later"),
    [
        (1, Scene(walls=0.8, grip=1.7), {"k": 2.0}, None, None),
        (2, Scene(), {"k": 15.0, "tau_s": 1.0, "rod_lag_s": 0.0075}, None, {"k": 8.0}),
        (
            3,
            Scene(walls=3.0, across=0.6, bumper=0.3, axle=400.0),
            {"k": 8.0},
            {"mode": "waveform", "param": "k", "waveform": [0, 40, 2], "wheel": "left"},
            None,
        ),
    ],
)
def test_a_robot_in_a_batch_equals_the_robots_loop(seed, scene, changes, request_, later):
    brick, start, records, places, kick = run_loop(seed, scene, changes, request_, later)
    course = robots.run(
        1,
        TICKS,
        0,
        scene,
        params=with_changes(**changes),
        then=[(BEGIN, with_changes(**{**changes, **later}))] if later else (),
        kick=kick,
        motors=tuple(motor.constants for motor in brick.motors),
        start=start,
        times=np.array([record.t_s for record in records]),
    )
    for side, name in enumerate(WHEELS):
        for channel, column in enumerate(batch.CHANNELS):
            expected = [getattr(record, f"{name}_{column}") for record in records]
            assert np.array_equal(course.records[0, side, :, channel], expected), column
    assert np.array_equal(course.places[0], places)


def test_a_kick_takes_its_sign_from_each_wheel():
    """Half of the wheels run backward, and all of them turn round."""
    kick = parse({"id": "k", "mode": "phase", "ticks": 4}, (1, 1), Params(), BEGIN)
    kick.values = (batch.PHASE_SHIFT,) * 2
    phi = robots.run(20, TICKS, 4, Scene(grip=1.7), kick=kick).records[..., 0]
    before = np.sign(phi[..., BEGIN] - phi[..., BEGIN - DIRECTION_TICKS])
    after = np.sign(phi[..., -1] - phi[..., -DIRECTION_TICKS])
    assert {-1.0, 1.0} == set(before.ravel())
    assert np.array_equal(after, -before)
    kick.begin = DIRECTION_TICKS
    with pytest.raises(ValueError, match="no direction yet"):
        robots.run(1, TICKS, 4, Scene(), kick=kick)


def test_a_robot_does_not_depend_on_its_neighbours():
    one = robots.run(1, 100, 5, Scene(), times=np.arange(100) * 0.03)
    start = robots.random_robots(1, np.random.default_rng(5), alone(load()))
    many = Start(*(np.repeat(part, 3, axis=0) for part in vars(start).values()))
    three = robots.run(3, 100, 6, Scene(), start=many, times=np.arange(100) * 0.03)
    assert np.array_equal(three.records, np.repeat(one.records, 3, axis=0))


@pytest.mark.parametrize("wrong", ["start", "times", "motors", "latency"])
def test_what_does_not_fit_is_refused(wrong):
    constants = alone(load())
    options = {
        "start": {"start": robots.random_robots(2, np.random.default_rng(1), constants)},
        "times": {"times": np.zeros((2, 50))},
        "motors": {"motors": (constants,) * 3},
        "latency": {"times": np.arange(50) * 0.004},
    }[wrong]
    with pytest.raises(ValueError, match=r"fit|longer ticks"):
        robots.run(1, 50, 1, Scene(), **options)


# What the body does.


def test_the_plate_has_the_moment_of_inertia_of_its_parts():
    """Of many small masses in a grid over the plate, m r^2 summed up."""
    length, width, count = 0.2, 0.16, 400
    x = (np.arange(count) + 0.5) / count * length - length / 2
    y = (np.arange(count) + 0.5) / count * width - width / 2
    parts = (x[:, None] ** 2 + y**2).mean() * 0.7
    assert plate_inertia(0.7, length, width) == pytest.approx(parts, rel=1e-5)


def test_a_push_at_one_wheel_takes_the_other_one_along():
    """A body with half its mass over each wheel would not: F/m = F (track/2)^2 / I there."""
    body, _, walls = numbers(Scene())
    mass, inertia, track, *_ = body
    place = np.zeros(6)
    move_body(place, (2.0, 0.0), 0.0, SUBSTEP_S, 1, body, walls)
    left, right = (place[3] + side * track / 2 * place[5] for side in (-1, 1))
    assert left == pytest.approx(SUBSTEP_S * 2.0 * (1 / mass + track**2 / 4 / inertia))
    assert right == pytest.approx(SUBSTEP_S * 2.0 * (1 / mass - track**2 / 4 / inertia))
    assert 0.2 * left < right < left


def test_walls_on_all_sides_keep_robots_in():
    scene = Scene(walls=1.0, across=1.2, grip=1.7)
    places = robots.run(8, 1500, 7, scene).places
    reach = 0.5 * np.hypot(ROBOT["body_length"], ROBOT["body_width"])
    assert np.abs(places[..., 0]).max() < 0.5
    assert np.abs(places[..., 1]).max() < 0.6
    assert np.abs(places[..., 0]).max() > 0.5 - reach
    assert np.abs(places[..., 1]).max() > 0.6 - reach


def test_a_wall_along_y_pushes_as_one_along_x():
    """The same robot a quarter turn round, between the other two walls."""
    start = robots.random_robots(1, np.random.default_rng(3), alone(load()))
    times = np.arange(400) * 0.03
    ahead = Start(start.states, start.potentials, np.array([0.05]))
    aside = Start(start.states, start.potentials, np.array([0.05 + pi / 2]))
    first = robots.run(1, 400, 1, Scene(walls=0.8), start=ahead, times=times)
    second = robots.run(1, 400, 1, Scene(across=0.8), start=aside, times=times)
    assert np.allclose(first.records[..., :200, 0], second.records[..., :200, 0], atol=0.05)
    assert np.allclose(first.places[0, :60, 0], second.places[0, :60, 1], atol=1e-3)


def test_without_walls_a_robot_rolls_on():
    start = robots.random_robots(1, np.random.default_rng(3), alone(load()))
    level = Start(start.states, np.full((1, 2, 2), [0.0, -1.0]), np.array([0.0]))
    level.states[..., :2] = 0.0
    place = robots.run(1, 3000, 1, Scene(), start=level).places[0, -1]
    rolled = np.hypot(place[0], place[1])
    assert rolled > 20.0


def test_a_scene_on_ice_cannot_push():
    (mass, *_), _, _ = numbers(Scene(grip=0.0))
    places = robots.run(2, 100, 1, Scene(grip=0.0)).places
    assert np.abs(places[..., :2]).max() < 1e-9 * mass * GRAVITY
