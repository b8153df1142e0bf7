"""Cars and trains in MuJoCo: their physics against theory, their controllers against the robot's own."""

from math import cos, pi, sin, sqrt

import mujoco
import numpy as np
import pytest

from host.bodies.build import BodyRequest, build_body, build_scene, choose_preset
from host.bodies.kicks import parse_kick, run_with_kicks
from host.errors import NotDone, WrongUse
from robot.kicks import MEMBRANE, PHASE, WHEELS, Kick, parse
from robot.params import Params
from robot.wheel import Wheel
from sim_motor.bodies.body import Body
from sim_motor.bodies.measures import course, directions, order, reversals_s, summary
from sim_motor.bodies.model import SCENES, compose
from sim_motor.bodies.presets import HERE, NAMES, preset


def rolling_speed(own, k):
    """Of one car with one rod a wheel whose speed does not vary and whose neurons are linear, rad/s."""
    braking = own.body_drag * own.wheel_radius**2 / 2 + own.wheel_drag * own.wheel_radius
    return sqrt(own.a * k * own.wheel_radius * own.tau / (4 * braking) - 1) / own.tau


def launch(body, own, omega):
    """Let a car already roll at that speed."""
    body.data.qvel[:] = 0.0
    body.data.qvel[0] = omega * own.wheel_radius
    body.data.qvel[[body.model.joint(name).dofadr[0] for name in body.wheels]] = omega


def column(body, ending):
    return body.rows[:, [name.endswith(ending) for name in body.columns]]


@pytest.fixture(scope="module")
def train():
    body = build_body(BodyRequest(cars=5, scene="walls", seed=3))
    body.run(15.0)
    return body


@pytest.mark.parametrize(
    ("name", "k", "drag"),
    [("snake2019", 2.0, 0.002), ("snake2019", 2.0, 0.005), ("paper", 0.5, 0.1)],
)
def test_a_car_rolls_at_the_speed_that_theory_gives(name, k, drag):
    own = preset(name).with_drag(drag)
    assert (
        own.a
        * k
        * own.wheel_radius
        * own.tau
        / (4 * (own.body_drag * own.wheel_radius**2 / 2 + own.wheel_drag * own.wheel_radius))
        > 8.0
    )
    expected = rolling_speed(own, k)
    for start in (0.97, 1.03):
        body = Body(compose(own, "flat").compile(), own._replace(k=k), phases=np.zeros(2))
        launch(body, own, start * expected)
        body.run(8.0)
        late = column(body, "_omega_rad_s")[-400:]
        assert late.mean() == pytest.approx(expected, rel=0.03)


def test_without_drive_and_drag_energy_is_not_created_and_hardly_lost():
    own = preset("paper")._replace(body_drag=0.0, k=0.0)
    model = compose(own, "flat").compile()
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    body = Body(model, own, phases=np.zeros(2))
    launch(body, own, 30.0)
    body.run(0.2)
    energies = [sum(body.data.energy)]
    for _ in range(20):
        body.run(0.2)
        energies.append(sum(body.data.energy))
    rolling = 0.5 * (0.2 * (30.0 * 0.03) ** 2 + 2 * 0.5 * 0.05 * 0.03**2 * 30.0**2)
    assert max(np.diff(energies)) < 1e-5 * rolling
    assert energies[0] - energies[-1] < 0.02 * rolling


def test_at_rest_a_train_stands_on_its_wheels_and_weighs_what_the_preset_says():
    for name in NAMES:
        own = preset(name)._replace(k=0.0)
        body = Body(compose(own, "flat", 5).compile(), own)
        body.run(0.5)
        assert body.model.body_mass.sum() == pytest.approx(5 * (own.body_mass + 2 * own.wheel_mass))
        assert column(body, "_z_m")[-1] == pytest.approx([own.wheel_radius] * 5, abs=2e-4)
        assert np.abs(column(body, "_joint_rad")[-1]).max() < 1e-3


def test_shorter_steps_move_reversals_by_less_than_a_fifth_of_a_second(train):
    own = choose_preset(BodyRequest(cars=5))
    finer = Body(compose(own, "walls", 5, timestep=0.0005).compile(), own, seed=3)
    finer.run(15.0)
    plain, halved = (reversals_s(course(body.columns, body.rows)) for body in (train, finer))
    assert len(plain) == len(halved) == 2
    assert halved == pytest.approx(plain, abs=0.2)


def test_the_same_seed_gives_the_same_bits_and_another_does_not(train):
    again, other = (build_body(BodyRequest(cars=5, scene="walls", seed=seed)) for seed in (3, 4))
    for body in (again, other):
        body.run(1.0)
    count = len(again.rows)
    assert again.rows.tobytes() == train.rows[:count].tobytes()
    assert other.rows.tobytes() != again.rows.tobytes()


def test_torques_are_those_of_one_rod_and_neurons_those_of_the_robot():
    own = preset("paper")
    body = Body(compose(own, "flat", 2).compile(), own, seed=5, record_s=0.001)
    request = {"id": "1", "mode": PHASE, "ticks": 50, "shift": 3 * pi / 4}
    quenched = parse(request, (1, 1), Params(), 100)
    frozen = Kick("2", MEMBRANE, WHEELS, 1, begin=200)
    for kick in (quenched, frozen):
        named = Kick(**kick.as_dict())
        named.wheels = ("car0_left", "car1_right")
        body.kick(named)
    body.run(0.3)
    phi, x, target, torque = (
        column(body, ending) for ending in ("_phi_rad", "_x", "_target", "_torque_nm")
    )
    params = Params()
    params.a, params.tau_s, params.k, params.rods = own.a, own.tau, 0.5, 1
    for index, name in enumerate(body.wheels):
        wheel = Wheel("left")
        for step in range(300):
            wheel.phi = phi[step, index]
            kick = next(
                (
                    kick
                    for kick in (quenched, frozen)
                    if kick.acts_at(step) and name in ("car0_left", "car1_right")
                ),
                None,
            )
            wheel.step(step, 0.001, params, kick)
            assert x[step + 1, index] == pytest.approx(wheel.x1, rel=1e-12, abs=1e-15)
            assert torque[step + 1, index] == pytest.approx(
                own.wheel_radius * wheel.force, rel=1e-9, abs=1e-15
            )
            expected = 0.03 * 0.5 * sin(wheel.phi) * (target[step + 1, index] - cos(wheel.phi))
            assert torque[step + 1, index] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_a_wheel_at_its_dead_centre_stays_there():
    own = preset("paper")
    body = Body(compose(own, "flat").compile(), own, phases=np.array([0.0, pi]))
    body.run(2.0)
    assert np.abs(column(body, "_omega_rad_s")[-1]).max() < 1e-3


def test_a_train_reverses_at_walls_as_a_whole_and_the_measures_say_so(train):
    found = summary(train.columns, train.rows)
    assert len(found["reversals"]) == 2
    assert found["order_parameter"] > 0.9
    assert not found["stuck"]
    assert not found["flipped"]
    moved = course(train.columns, train.rows)
    signs = directions(moved)
    for time_s in found["reversals"]:
        before, after = (signs[np.searchsorted(moved.t_s, time_s + wait)] for wait in (-1.5, 2.0))
        assert before == -after != 0


def test_the_order_parameter_is_that_of_signs():
    assert order(
        np.array([[5.0, 6.0, -1.0, 1.0], [0.1, 0.0, -0.2, 0.3], [-9.0, -9.0, -9.0, -9.0]])
    ) == pytest.approx([0.5, 0.0, 1.0])


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


def test_boxes_and_hills_come_from_the_seed():
    for scene in ("octagon", "hills"):
        one, same, other = (
            build_scene(BodyRequest(scene=scene, seed=seed)).compile() for seed in (1, 1, 2)
        )
        fields = [
            (model.body_pos.tobytes(), model.hfield_data.tobytes()) for model in (one, same, other)
        ]
        assert fields[0] == fields[1] != fields[2]


def test_words_make_kicks_of_wheels_and_wrong_words_are_refused():
    wheels = ("car0_left", "car0_right", "car1_left", "car1_right")
    assert parse_kick("t=5,mode=membrane,wheel=all", wheels).wheels == wheels
    assert parse_kick("t=5,mode=membrane,wheel=left", wheels).wheels == ("car0_left", "car1_left")
    assert parse_kick("t=1, mode=phase, wheel=car1, shift=-pi/2, seconds=0.2", wheels).wheels == (
        "car1_left",
        "car1_right",
    )
    kick = parse_kick("t=1,mode=phase,wheel=car1_left,seconds=0.2", wheels).kicks(
        1000, 0.001, [-3.0]
    )[0]
    assert (kick.begin, kick.ticks, kick.wheels, kick.values[0]) == (
        1000,
        200,
        ("car1_left",),
        -3 * pi / 4,
    )
    for words, reason in (
        ("mode=phase", "time"),
        ("t=1,mode=phase,wheel=car7", "car7"),
        ("t=1,mode=shout", "mode"),
        ("t=1,mode=membrane,seconds=3", "membrane"),
        ("t=x,mode=phase", "t of a kick"),
        ("t=1,colour=red", "colour"),
        ("t=nan,mode=phase", "time"),
        ("t=1,mode=phase,shift=100", "shift"),
        ("t=1,mode=phase,shift=foo", "shift"),
        ("t=1,mode=phase,seconds=-1", "last"),
        ("t=1,t=2,mode=phase", "one t"),
    ):
        with pytest.raises(WrongUse, match=reason):
            parse_kick(words, wheels)


def test_a_body_that_cannot_be_followed_says_so_and_keeps_what_there_was():
    body = build_body(BodyRequest(cars=5, k=1e9))
    with pytest.raises(NotDone, match="cannot be followed"):
        run_with_kicks(body, 5.0, [], lambda time_s: None)
    assert 0.0 < body.time_s < 5.0
    assert np.isfinite(body.rows).all()


def test_what_cannot_be_is_refused_in_words(tmp_path):
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody><geom type='plane' size='1 1'/></worldbody></mujoco>")
    torn = tmp_path / "torn.xml"
    torn.write_text("<mujoco><worldbody>")
    for asked, reason in (
        (BodyRequest(scene="moon"), "no scene"),
        (BodyRequest(scene=str(broken)), "size"),
        (BodyRequest(scene=str(torn)), "XML"),
        (BodyRequest(scene=str(tmp_path / "none.xml")), "none.xml"),
        (BodyRequest(cars=0), "0 cars"),
        (BodyRequest(scene="flat", angle=0.2), "no slopes"),
        (BodyRequest(scene="slopes", angle=2.0), "slopes of"),
        (BodyRequest(k=float("nan")), "k cannot"),
        (BodyRequest(tau=0.0), "tau"),
        (BodyRequest(drag=-1.0), "drag"),
        (BodyRequest(preset="porsche"), "no preset"),
    ):
        with pytest.raises(WrongUse, match=reason):
            build_body(asked)
