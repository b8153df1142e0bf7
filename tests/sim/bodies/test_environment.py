"""The Gymnasium environment."""

import os
import subprocess
import sys
import tracemalloc
from math import cos, pi, sin

import gymnasium
import numpy as np
import pytest

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
from sim_motor.bodies.measures import summary
from sim_motor.bodies.presets import preset

CHECK = f"""
import gymnasium
from gymnasium.utils.env_checker import check_env
name = "sim_motor.bodies.environment:{ID}"
check_env(gymnasium.make(name, cars=2, decision_s=0.05, kick_s=0.05).unwrapped)
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
    def run_train(seed, mode):
        train = Train(cars=2, decision_s=0.5)
        train.reset(seed=seed)
        for _ in range(3):
            seen, *_ = train.step(kicks(train, car0_left=mode))
        return seen.tobytes()

    first = run_train(1, PHASE)
    assert run_train(1, PHASE) == first
    assert len({first, run_train(2, PHASE), run_train(1, None)}) == 3


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


def test_a_decision_late_in_an_episode_takes_no_more_memory_than_an_early_one():
    train = Train(cars=1, decision_s=0.01, time_s=1e6)
    train.reset(seed=1)
    action = kicks(train)

    def allocated(steps):
        """The most memory that one of the last 10 of so many steps took."""
        most = []
        for _ in range(steps - 10):
            train.step(action)
        tracemalloc.start()
        for _ in range(10):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            train.step(action)
            most.append(tracemalloc.get_traced_memory()[1] - before)
        tracemalloc.stop()
        return max(most)

    allocated(600)  # up to here the last seconds fill
    early = allocated(20)
    assert allocated(2000) < early + 2000
    assert len(train._body.rows) == 1


def test_its_summary_is_that_of_the_states_at_all_decisions():
    train = Train(cars=2, decision_s=0.1)
    train.reset(seed=3)
    rows = [train._body.rows[-1]]
    for number in range(120):
        seen = train.step(kicks(train, **({"car0_left": PHASE} if number == 50 else {})))
        rows.append(train._body.rows[-1])
    found, whole = seen[-1]["summary"], summary(train._body.columns, np.array(rows))
    assert list(found) == list(whole)
    for name, value in whole.items():
        assert found[name] == pytest.approx(value, rel=1e-9), name
    assert found["started_s"] is not None


def test_a_preset_whose_neurons_its_steps_cannot_follow_is_refused(monkeypatch):
    fast = preset("paper")._replace(tau=0.0004)
    monkeypatch.setattr("sim_motor.bodies.environment.preset_of", lambda name: fast)
    with pytest.raises(ValueError, match=r"tau cannot be 0\.0004"):
        Train(cars=1)


def test_angles_at_the_start_are_finite():
    train = Train(cars=1)
    with pytest.raises(ValueError, match="finite"):
        train.reset(seed=1, options={"phases": [0.0, float("nan")]})
