"""The axle between motor and rim: its stiffness, swings and losses, and what it leaves alone."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import diags
from scipy.sparse.linalg import spsolve

from host.errors import WrongUse
from host.link.addresses import make_link
from sim_motor.arrays import scalars, tables
from sim_motor.axle import axle_stiffness, stiffness_range
from sim_motor.brick import SimBrick
from sim_motor.constants import SUBSTEP_S, data, load
from sim_motor.exact_step import COAST
from sim_motor.motor import WHEEL_SPEED
from sim_motor.scene import Scene
from sim_motor.world import advance, no_stretches, numbers, tyre_force

ROBOT = {name: entry[0] for name, entry in data()["robot"].items()}
TREAD = ROBOT["tyre_stiffness"], ROBOT["tyre_damping"]
RADIUS = ROBOT["wheel_radius"]


# Its stiffness.


def test_the_torsion_constant_is_that_of_a_cross():
    """Prandtl: the Laplacian of a stress function is -2 inside and it is 0 at the edge.

    The constant is twice the function's integral. By finite differences.
    """
    step, half, arm = 0.075e-3, 2.4e-3, 0.9e-3
    place = (np.arange(1, 64) - 32) * step
    x, y = np.meshgrid(place, place)
    inside = ((abs(x) < arm - step / 2) | (abs(y) < arm - step / 2)).ravel()
    count = len(place)
    beside = np.ones(count**2 - 1)
    beside[count - 1 :: count] = 0.0  # the end of one line is no neighbour of the next one's start
    ones = np.ones(count**2 - count)
    laplacian = diags(
        [ones, beside, np.full(count**2, -4.0), beside, ones], [-count, -1, 0, 1, count]
    ).tocsr()[inside][:, inside]
    stress = spsolve(laplacian.tocsc(), np.full(inside.sum(), -2 * step**2))
    assert place[-1] + step == pytest.approx(half)
    assert 2 * stress.sum() * step**2 == pytest.approx(ROBOT["axle_torsion_constant"], rel=0.015)


def test_axles_one_behind_the_other_give_way_as_one_long_axle():
    parts = [axle_stiffness(length, 0.7e9) for length in (0.008, 0.012, 0.02)]
    assert 1 / axle_stiffness(0.04, 0.7e9) == pytest.approx(sum(1 / part for part in parts))


def test_all_that_an_axle_may_be_can_be_simulated():
    least, most = stiffness_range()
    assert 100 < least < most < 5000
    assert Scene(axle=least).axle != Scene(axle=most).axle


# Its swings.


@pytest.mark.parametrize("axle", [217.0, 600.0, 2980.0])
def test_a_mass_on_axle_and_tread_swings_as_on_one_spring(axle):
    """Springs one behind the other: 1/K = 1/K1 + 1/K2. Nothing damps them here."""
    mass, speed, swings = 0.35, 0.1, []
    stretch, way = np.zeros(3), 0.0
    for substep in range(2000):
        force, _ = tyre_force(stretch, -speed, 0.0, inf, (TREAD[0], 0.0, axle, 0.0))
        speed += SUBSTEP_S * force / mass
        if way < 0 <= way + SUBSTEP_S * speed:
            swings.append(substep - way / (SUBSTEP_S * speed))
        way += SUBSTEP_S * speed
    together = 1 / (1 / axle + 1 / TREAD[0])
    period_s = np.diff(swings).mean() * SUBSTEP_S
    assert len(swings) > 5
    assert period_s == pytest.approx(2 * pi * np.sqrt(mass / together), rel=0.01)


def test_a_motor_swings_on_its_axle_as_a_torsion_pendulum():
    """The body is too heavy to move. The wheel has the motor's inertia, and swings in its play."""
    axle = 600.0
    _, _, walls = numbers(Scene())
    motor = replace(load().with_wheel(load().motor_inertia), rolling=0.0)
    states = np.zeros((2, 6))
    states[:, WHEEL_SPEED] = 0.2
    body = 1e9, 1e9, ROBOT["track"], RADIUS, 1.0, 0.1, 0.08
    place, stretches, speeds = np.zeros(6), no_stretches(), []
    for _ in range(2000):
        advance(
            1,
            place,
            stretches,
            (states[0], states[1]),
            ((COAST, 7.5, 0.0), (COAST, 7.5, 0.0)),
            (1, 1),
            tuple(tables([motor, motor])),
            tuple(scalars([motor, motor])),
            body,
            (TREAD[0], 0.0, axle, 0.0),
            walls,
        )
        speeds.append(states[0, WHEEL_SPEED])
    forward = np.array(speeds) > 0
    turns = np.flatnonzero(forward[1:] & ~forward[:-1])
    stiffness = RADIUS**2 / (1 / axle + 1 / TREAD[0])
    assert len(turns) >= 3
    assert np.diff(turns).mean() * SUBSTEP_S == pytest.approx(
        2 * pi * np.sqrt(motor.wheel_inertia / stiffness), rel=0.01
    )


# Its losses.


@given(
    slips=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=60),
    axle=st.tuples(st.floats(50.0, 1e5), st.floats(0.0, 20.0)),
    most=st.floats(0.1, 20.0),
)
def test_axle_and_tread_give_back_no_more_than_they_got(slips, axle, most):
    """In no substep do the springs gain more than the work that is done on them."""
    stretch, stored = np.zeros(3), 0.0
    for slip in slips:
        force, _ = tyre_force(stretch, slip, 0.0, most, TREAD + axle)
        before, stored = stored, 0.5 * (TREAD[0] * stretch[0] ** 2 + axle[0] * stretch[2] ** 2)
        assert abs(force) <= most * (1 + 1e-12)
        assert stored - before <= force * slip * SUBSTEP_S + 1e-12


# What it leaves alone.


@given(slips=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=20))
def test_a_rigid_axle_is_the_limit_of_a_stiff_one(slips):
    rigid, stiff = np.zeros(3), np.zeros(3)
    for slip in slips:
        force, _ = tyre_force(rigid, slip, 0.1, 3.0, (*TREAD, inf, 2.0))
        near, _ = tyre_force(stiff, slip, 0.1, 3.0, (*TREAD, 1e12, 2.0))
        assert near == pytest.approx(force, abs=1e-5)
    assert rigid[2] == 0.0


def drive(scene, glances=1):
    """A brick after a second of constant duty in virtual time."""
    brick = SimBrick(3, scene=scene, jitter=False)
    for motor in brick.motors:
        motor.write_duty(60)
    for glance in range(glances):
        brick.clock.wait((glance + 1) / glances, lambda timeout_s: None)
        brick.truth()
    return brick


def test_a_robot_on_soft_axles_drives_as_fast_in_the_end():
    soft, rigid = (drive(Scene(grip=1.7, axle=axle)) for axle in (300.0, None))
    for one, other in zip(soft.truth(), rigid.truth(), strict=True):
        assert one.wheel_speed == pytest.approx(other.wheel_speed, rel=0.01)


def test_looking_more_often_changes_no_bit():
    seldom, often = drive(Scene(walls=0.6, axle=300.0)), drive(Scene(walls=0.6, axle=300.0), 100)
    assert seldom.world.place() == often.world.place()
    assert seldom.truth() == often.truth()


def test_nonsense_is_refused_in_words():
    with pytest.raises(WrongUse, match="axle cannot be 1"):
        make_link("sim://?walls=2&axle=1")
