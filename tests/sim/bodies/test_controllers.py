"""The controllers of a body's wheels, against the robot's own."""

from math import cos, pi, sin

import numpy as np
import pytest

from robot.kick_requests import parse
from robot.kicks import MEMBRANE, PHASE, WHEELS, Kick
from robot.params import Params
from robot.wheel import Wheel
from sim_motor.bodies.body import Body
from sim_motor.bodies.model import compose
from sim_motor.bodies.presets import preset
from tests.sim.bodies.body_rows import column


def test_torques_are_those_of_one_rod_and_neurons_those_of_the_robot():
    own = preset("paper")
    body = Body(compose(own, "flat", 2).compile(), own, seed=5, record_s=0.001)
    request = {"id": "1", "mode": PHASE, "ticks": 50, "shift": 3 * pi / 4}
    quenched = parse(request, (1, 1), Params(), 100)
    frozen = Kick("2", MEMBRANE, WHEELS, 1, begin=200)
    kicks, kicked = (quenched, frozen), ("car0_left", "car1_right")
    for kick in kicks:
        named = Kick(**kick.as_dict())
        named.wheels = kicked
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
            acting = [kick for kick in kicks if kick.acts_at(step)]
            kick = acting[0] if acting and name in kicked else None
            wheel.step(step, 0.001, params, kick)
            assert x[step + 1, index] == wheel.x1
            assert torque[step + 1, index] == own.wheel_radius * wheel.force
            expected = 0.03 * 0.5 * sin(wheel.phi) * (target[step + 1, index] - cos(wheel.phi))
            assert torque[step + 1, index] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_a_wheel_at_its_dead_centre_stays_there():
    own = preset("paper")
    body = Body(compose(own, "flat").compile(), own, phases=np.array([0.0, pi]))
    body.run(2.0)
    assert np.abs(column(body, "_omega_rad_s")[-1]).max() < 1e-3
