"""Cars and trains in MuJoCo: their physics against theory."""

import json
import tracemalloc
from math import sqrt

import mujoco
import numpy as np
import pytest

from host.bodies.build import BodyRequest, build_body, choose_preset
from sim_motor.bodies.body import Body
from sim_motor.bodies.measures import course, reversals_s
from sim_motor.bodies.model import compose
from sim_motor.bodies.presets import NAMES, preset
from tests.sim.bodies.body_rows import column


def k_over_onset(own, k):
    """How many times k is above the onset of rolling, for linear neurons and steady speed."""
    drag = own.body_drag * own.wheel_radius**2 / 2 + own.wheel_drag * own.wheel_radius
    return own.a * k * own.wheel_radius * own.tau / (4 * drag)


def test_a_body_goes_on_to_the_bit_from_its_state_in_another_one():
    """At a wall, where it hits and bends."""

    def build():
        body = build_body(BodyRequest(cars=2, scene="walls", seed=3))
        body.data.qpos[0] = 3.3
        return body

    whole, first, second = build(), build(), build()
    whole.run(1.5)
    first.run(0.8)
    second.resume(json.loads(json.dumps(first.state)))
    second.run(0.7)
    assert whole.data.ncon > 0
    np.testing.assert_array_equal(second.rows, whole.rows[len(first.rows) - 1 :])


def launch(body, own, omega):
    """Let a car already roll at that speed."""
    body.data.qvel[:] = 0.0
    body.data.qvel[0] = omega * own.wheel_radius
    body.data.qvel[[body.model.joint(name).dofadr[0] for name in body.wheels]] = omega


@pytest.mark.parametrize(
    ("name", "k", "drag"),
    [("snake2019", 2.0, 0.002), ("snake2019", 2.0, 0.005), ("paper", 0.5, 0.1)],
)
def test_a_car_rolls_at_the_speed_that_theory_gives(name, k, drag):
    own = preset(name).with_drag(drag)
    assert k_over_onset(own, k) > 8.0
    expected = sqrt(k_over_onset(own, k) - 1.0) / own.tau
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


def test_a_note_of_a_state_takes_no_more_memory_than_its_row():
    body = build_body(BodyRequest(cars=5))
    body.run(0.01)
    tracemalloc.start()
    body.run(1.0)
    taken = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert taken / 200 < 2 * body.rows[0].nbytes
