"""The scenes for bodies."""

from math import sin

import mujoco
import numpy as np
import pytest

from host.bodies.build import BodyRequest, build_body, build_scene
from host.errors import WrongUse
from sim_motor.bodies.model import BOUNCY, SCENES, WALLED
from sim_motor.bodies.presets import HERE, preset
from tests.sim.bodies.body_rows import column


@pytest.mark.parametrize("scene", SCENES)
def test_in_every_scene_a_train_stands_on_the_ground(scene):
    body = build_body(BodyRequest(cars=5, scene=scene, k=0.0))
    body.run(0.4)
    assert np.abs(body.omega).max() < 8.0
    assert (column(body, "_z_m")[-1] > 0.02).all()
    assert column(body, "_z_m")[-1].max() < 0.4


def test_the_file_for_a_viewer_is_the_papers_car_on_a_floor():
    model = mujoco.MjModel.from_xml_path(str(HERE / "scene.xml"))
    data, own = mujoco.MjData(model), preset("paper")
    mujoco.mj_step(model, data, 500)
    assert model.body_mass.sum() == pytest.approx(own.body_mass + 2 * own.wheel_mass)
    assert data.body("car").xpos == pytest.approx([0.0, 0.0, own.wheel_radius], abs=1e-3)


def test_slopes_take_their_angle():
    for angle in (0.1, 0.35):
        model = build_scene(BodyRequest(scene="slopes", angle=angle)).compile()
        for side in ("east", "north", "west", "south"):
            normal = model.geom(f"slope_{side}").quat
            matrix = np.empty(9)
            mujoco.mju_quat2Mat(matrix, normal)
            assert np.arccos(matrix[8]) == pytest.approx(angle, abs=1e-6)
            foot = model.geom(f"slope_{side}").pos
            # The plane passes through the floor 4 m from the middle.
            assert abs(np.dot(matrix[[2, 5, 8]], foot)) == pytest.approx(4.0 * sin(angle), rel=1e-4)


@pytest.mark.parametrize("scene", SCENES)
def test_walls_are_bouncy_where_there_are_walls(scene):
    request = BodyRequest(scene=scene, bouncy=True)
    if scene not in WALLED:
        with pytest.raises(WrongUse, match="no walls"):
            build_scene(request)
        return
    model = build_scene(request).compile()
    walls = [geom for geom in map(model.geom, range(model.ngeom)) if geom.name.startswith("wall")]
    assert len(walls) >= 2
    assert all(tuple(wall.solref) == BOUNCY for wall in walls)


def test_boxes_and_hills_come_from_the_seed():
    for scene in ("octagon", "hills"):
        one, same, other = (
            build_scene(BodyRequest(scene=scene, seed=seed)).compile() for seed in (1, 1, 2)
        )
        fields = [
            (model.body_pos.tobytes(), model.hfield_data.tobytes()) for model in (one, same, other)
        ]
        assert fields[0] == fields[1] != fields[2]


def test_a_car_rolls_in_a_scene_of_ones_own_as_on_our_floor(tmp_path):
    scene = tmp_path / "mine.xml"
    floor = "<mujoco>{}<worldbody><geom type='plane' size='9 9 1'/></worldbody></mujoco>"
    scene.write_text(floor.format("<option gravity='0 0 -9.8'/>"))
    bodies = [build_body(BodyRequest(scene=name)) for name in ("flat", str(scene))]
    for body in bodies:
        body.run(0.5)
    there = [column(body, "_x_m")[-1] for body in bodies]
    assert there[1] == there[0] > 0.05

    scene.write_text(floor.format("<option gravity='0 0 -1.62'/>"))
    assert build_scene(BodyRequest(scene=str(scene))).compile().opt.gravity[2] == -1.62
    scene.write_text(floor.format("<bad>"))
    with pytest.raises(WrongUse, match="cannot be read as a scene of MuJoCo: XML"):
        build_scene(BodyRequest(scene=str(scene)))


def test_walls_of_ones_own_bounce_too(tmp_path):
    scene = tmp_path / "mine.xml"
    scene.write_text(
        "<mujoco><worldbody><geom name='wall' type='plane' size='9 9 1'/></worldbody></mujoco>"
    )
    model = build_scene(BodyRequest(scene=str(scene), bouncy=True)).compile()
    wall = model.geom("wall")
    assert tuple(wall.solref) == BOUNCY
    assert wall.priority > model.geom("car0_left_wheel").priority
