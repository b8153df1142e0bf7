"""Scenes from above as MuJoCo has them, walls and ground; and a train's joints."""

from math import tan

import mujoco
import numpy as np
import pytest
from matplotlib.figure import Figure

from host.figures.bodies.from_above import draw_scene, ground_heights, scene_data, walls
from sim_motor.bodies.model import compose
from sim_motor.bodies.presets import preset


def test_the_walls_of_an_octagon_meet_in_its_corners():
    found = walls(scene_data("octagon"))
    ends = np.array(
        [one.middle + sign * one.half_m * one.along for one in found for sign in (-1, 1)]
    )
    apart = np.linalg.norm(ends[:, None] - ends, axis=2) + np.eye(len(ends))
    assert len(found) == 8
    assert apart.min(axis=1) == pytest.approx(0.0, abs=1e-3)


def test_slopes_rise_without_end_from_their_feet_by_the_angle_that_was_asked_for():
    data = scene_data("slopes", 0.3)
    (heights,) = ground_heights(data, np.array([0.0, 3.9, 6.0, -30.0]), np.zeros(1))
    assert heights == pytest.approx([0.0, 0.0, 2 * tan(0.3), 26 * tan(0.3)], abs=1e-3)


def test_hills_are_as_high_as_a_ray_from_above_finds_them_and_the_model_stays_as_it_was():
    data = scene_data("hills")
    model, groups = data.model, data.model.geom_group.copy()
    (heights,) = ground_heights(data, np.array([5.0, -7.0]), np.array([3.0]))
    for x, height in zip((5.0, -7.0), heights, strict=True):
        start, down = np.array([x, 3.0, 9.0]), np.array([0.0, 0.0, -1.0])
        far = mujoco.mj_ray(model, data, start, down, None, 1, -1, np.zeros(1, np.int32))
        assert height == pytest.approx(9.0 - far)
    assert (model.geom_group == groups).all()


@pytest.mark.parametrize(("scene", "lines", "boxes"), [("walls", 1, 0), ("box", 0, 1)])
def test_a_picture_has_what_is_near_the_path(scene, lines, boxes):
    axes = Figure().subplots()
    draw_scene(axes, scene_data(scene), np.array([[0.0, 0.0], [4.0, 1.0]]))
    low, high = axes.get_xlim()
    seen = [line for line in axes.lines if low < line.get_xdata()[0] < high]
    assert (len(seen), len(axes.patches)) == (lines, boxes)


def test_bars_show_a_bent_joint_and_weigh_and_touch_nothing():
    model = compose(preset("paper"), cars=2).compile()
    data = mujoco.MjData(model)
    data.qpos[model.joint("car1_yaw").qposadr[0]] = 0.4
    mujoco.mj_kinematics(model, data)
    bars = [model.geom(name).id for name in ("car1_front_bar", "car1_rear_bar")]
    assert not model.geom_contype[bars].any()
    assert not model.geom_conaffinity[bars].any()
    assert sum(model.body_mass) == pytest.approx(2 * 0.2)
    ends = []
    for bar in bars:
        reach = data.geom_xmat[bar].reshape(3, 3)[:, 2] * model.geom_size[bar, 1]
        ends.append([data.geom_xpos[bar] + reach, data.geom_xpos[bar] - reach])
    apart = np.linalg.norm(np.subtract(ends[0], np.array(ends[1])[:, None]), axis=2)
    assert apart.min() == pytest.approx(0.0, abs=1e-6)
