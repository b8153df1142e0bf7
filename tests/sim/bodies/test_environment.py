"""The Gymnasium environment, and driving a train to a goal by kicks."""

import json
import os
import subprocess
import sys
from math import cos, pi, sin

import gymnasium
import numpy as np
import pytest

from host.bodies import steering
from host.bodies.steering import ALL_PAIRS, CHOICES, LEFT, NO_KICK, RIGHT, plan, relative_to
from host.errors import WrongUse
from host.experiments.bodies import train_goal
from host.figures.bodies.train_goal import draw
from host.runs.contract import Setting
from host.util.installation import install_command
from robot.kicks import (
    MEMBRANE,
    NO_PULSE,
    PHASE,
    POSITION,
    PULSE_BETA,
    PULSE_SHIFT,
    reversing_shift,
)
from sim_motor.bodies.environment import ID, JOINT_RAD_S, KICKS, WHEEL_RAD_S, Train
from sim_motor.bodies.presets import preset

CHECK = f"""
import gymnasium
from gymnasium.utils.env_checker import check_env
check_env(gymnasium.make("sim_motor.bodies.environment:{ID}", cars=2, decision_s=0.05, kick_s=0.05).unwrapped)
"""


def test_gymnasiums_own_check_has_nothing_to_say_not_even_of_pictures():
    command = [sys.executable, "-W", "error", "-c", CHECK]
    done = subprocess.run(
        command, env={**os.environ, "MUJOCO_GL": "egl"}, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def kicks(train, **modes):
    action = np.zeros(train.action_space.shape, dtype=np.int64)
    for wheel, mode in modes.items():
        action[train._body.wheels.index(wheel)] = KICKS.index(mode)
    return action


def test_a_kick_acts_on_its_wheel_only_and_as_long_as_was_said():
    train = Train(cars=3, kick_s=0.25, decision_s=0.001)
    train.reset(seed=4)
    for _ in range(300):
        train.step(kicks(train))
    own = train._body.neurons
    x, omega = own.x1.copy(), train._body.omega.copy()
    _, _, _, _, info = train.step(
        kicks(train, car0_left=MEMBRANE, car1_right=POSITION, car2_left=PHASE, car2_right=PHASE)
    )
    assert info["kicks"] == 4
    # A step of 1 ms moves a potential towards what it sees, a 50th of the way.
    assert own.x1 == pytest.approx(x * (-1, 1, 1, 1, 1, 1), abs=2 / 50)
    assert abs(x[0]) > 0.1
    assert own.pulse.tolist() == [
        NO_PULSE,
        NO_PULSE,
        NO_PULSE,
        PULSE_BETA,
        PULSE_SHIFT,
        PULSE_SHIFT,
    ]
    assert own.value[4:].tolist() == [reversing_shift(np.sign(speed)) for speed in omega[4:]]
    assert own.ticks[3:].tolist() == [250] * 3
    assert own.begin[3:].tolist() == [300] * 3


def test_it_sees_what_the_wheels_and_joints_do_and_nothing_of_the_world():
    train = Train(cars=3, scene="hills", preset="snake2019")
    train.reset(seed=2)
    for _ in range(20):
        seen, *_, info = train.step(kicks(train))
    body = train._body
    state = dict(zip(body.columns, body.rows[-1], strict=True))
    own, hinge = preset("snake2019"), body.data.joint
    assert seen.tolist() == pytest.approx(
        [sin(state[wheel + "_phi_rad"]) for wheel in body.wheels]
        + [cos(state[wheel + "_phi_rad"]) for wheel in body.wheels]
        + [state[wheel + "_omega_rad_s"] / WHEEL_RAD_S for wheel in body.wheels]
        + [state[wheel + "_x"] for wheel in body.wheels]
        + [state[joint + "_joint_rad"] / own.joint_range for joint in body.joints]
        + [float(hinge(joint).qvel[0]) / JOINT_RAD_S for joint in body.joints],
        abs=1e-6,
    )
    assert np.abs(seen).max(initial=0.0) < 1.0
    assert info["cars"].tolist() == [
        [state[f"car{car}_{what}"] for what in ("x_m", "y_m", "yaw_rad")] for car in range(3)
    ]
    assert info["direction"] == np.sign(body.omega.mean())


def test_the_same_seed_and_kicks_give_the_same_bits_and_other_seeds_or_kicks_do_not():
    def ran(seed, mode):
        train = Train(cars=2, decision_s=0.5)
        train.reset(seed=seed)
        for _ in range(3):
            seen, *_ = train.step(kicks(train, car0_left=mode))
        return seen.tobytes()

    first = ran(1, PHASE)
    assert ran(1, PHASE) == first
    assert len({first, ran(2, PHASE), ran(1, None)}) == 3


def test_reset_takes_a_scene_and_phases_and_refuses_what_it_does_not_know():
    train = gymnasium.make(f"sim_motor.bodies.environment:{ID}", cars=1).unwrapped
    seen, info = train.reset(seed=1, options={"phases": [0.0, pi / 2], "scene": "walls"})
    assert seen[:4] == pytest.approx([0.0, 1.0, 1.0, 0.0])
    assert info["time_s"] == 0.0
    assert any(
        train._body.model.geom(geom).name.startswith("wall")
        for geom in range(train._body.model.ngeom)
    )
    for options, words in (
        ({"sceen": "flat"}, "sceen"),
        ({"scene": "moon"}, "moon"),
        ({"phases": [0.0]}, "2 angles"),
    ):
        with pytest.raises(ValueError, match=words):
            train.reset(options=options)
    for wrong, words in (
        ({"preset": "lego"}, "lego"),
        ({"decision_s": float("nan")}, "nan"),
        ({"kick_s": 11.0}, "to 10"),
    ):
        with pytest.raises(ValueError, match=words):
            Train(**wrong)
    with pytest.raises(ValueError, match="0 to 3"):
        train.step(np.array([0, 4]))


def test_reward_is_the_users_and_time_ends_an_episode():
    train = Train(cars=1, decision_s=0.25, time_s=0.5, reward=lambda info: 10.0 * info["time_s"])
    train.reset(seed=1)
    ends = [train.step(kicks(train))[1:4] for _ in range(2)]
    assert ends == [(2.5, False, False), (5.0, False, True)]


def test_an_episode_ends_when_a_car_lies_on_its_back_or_cannot_be_followed():
    train = Train(cars=1)
    train.reset(seed=1)
    train._body.data.qpos[2:7] = (0.2, 0.0, 1.0, 0.0, 0.0)
    *_, terminated, _, info = train.step(kicks(train))
    assert terminated
    assert "fell over" in info["ended"]
    train.reset(seed=1)
    train._body.data.qvel[0] = 1e12
    seen, _, terminated, _, info = train.step(kicks(train))
    assert terminated
    assert "cannot be followed" in info["ended"]
    assert train.observation_space.contains(seen)
    train.reset(seed=1)
    assert not train.step(kicks(train))[2]


def arc(turn_rad):
    """A metre's way in ten looks, turning so much."""
    part = np.linspace(0.1, 1.0, 10)
    return np.stack([part, turn_rad * part**2 / 2, turn_rad * part], axis=1)


def test_a_plan_turns_to_its_goal_whatever_the_kicks_are_called():
    turns = np.array([arc(0.0), arc(0.5), arc(-0.5)])
    true = np.broadcast_to(turns, (3, 3, 10, 3))
    mirrored = true[:, [NO_KICK, RIGHT, LEFT]]
    for bearing, choice, other in (
        (0.0, NO_KICK, NO_KICK),
        (0.7, LEFT, RIGHT),
        (-0.7, RIGHT, LEFT),
    ):
        for start in ((0.0, 0.0, 0.0), (5.0, -2.0, 2.5)):
            goal = np.array(
                [start[0] + 3.0 * cos(start[2] + bearing), start[1] + 3.0 * sin(start[2] + bearing)]
            )
            assert plan(true, start, NO_KICK, goal) == choice
            assert plan(mirrored, start, NO_KICK, goal) == other


def test_a_plan_that_is_followed_ends_at_goals_all_around():
    effects = np.broadcast_to(np.array([arc(0.0), arc(0.5), arc(-0.5)]), (3, 3, 10, 3))
    for bearing in (-pi, -2.0, 0.5, 1.6):
        goal, pose, nearest = 3.0 * np.array([cos(bearing), sin(bearing)]), np.zeros(3), 3.0
        for _ in range(12):
            step = effects[0, plan(effects, pose, NO_KICK, goal)]
            turn = np.array([[cos(pose[2]), sin(pose[2])], [-sin(pose[2]), cos(pose[2])]])
            way = pose[:2] + step[:, :2] @ turn
            nearest = min(nearest, np.hypot(*(way - goal).T).min())
            assert relative_to(pose, np.column_stack([way, pose[2] + step[:, 2]])) == pytest.approx(
                step
            )
            pose = np.array([*way[-1], pose[2] + step[-1, 2]])
        assert nearest < 0.2


def test_every_choice_is_tried_after_every_other():
    pairs = list(zip((ALL_PAIRS[-1], *ALL_PAIRS), ALL_PAIRS, strict=False))
    assert sorted(pairs) == [(last, choice) for last in CHOICES for choice in CHOICES]
    assert ALL_PAIRS[-1] == NO_KICK


def test_a_train_learns_what_kicks_do_and_drives_to_a_goal_which_one_that_is_not_kicked_misses(
    monkeypatch,
):
    monkeypatch.setattr(train_goal, "ROUNDS", 1)
    monkeypatch.setattr(train_goal, "LIMIT_S", 20.0)
    setting = Setting(1, {"goals": 1})
    cells = [{"goal": 2, "way": way} for way in (train_goal.PLANNED, train_goal.NONE)]
    planned, left_alone = (
        {**cell, **row} for cell in cells for row in train_goal.simulate(cell, setting)
    )
    assert planned["goal_m"] == left_alone["goal_m"]
    assert np.hypot(*planned["goal_m"]) == pytest.approx(3.0)
    course = np.array(planned["course"])
    assert np.hypot(*(course[-11:, :2] - planned["goal_m"]).T).min() < 0.2
    assert planned["reached_s"] < 20.0
    assert left_alone["reached_s"] is None
    turned = np.array(planned["effects"])[..., 2]
    assert turned[LEFT, LEFT] > 0.3
    assert turned[RIGHT, RIGHT] < -0.3
    assert abs(turned[NO_KICK, NO_KICK]) < 0.1
    rows = json.loads(json.dumps([planned, left_alone], allow_nan=False))
    findings = train_goal.report(rows + [{**left_alone, "way": train_goal.RANDOM}], setting)
    assert [way["reached"] for way in findings.numbers["ways"]] == [1, 0, 0]
    json.dumps(findings.numbers, allow_nan=False)
    assert len(draw(rows + [{**left_alone, "way": train_goal.RANDOM}], findings).axes) == 7


def test_without_gymnasium_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(WrongUse) as told:
        steering.build_environment("snake2019")
    assert install_command("gym") in told.value.hint
