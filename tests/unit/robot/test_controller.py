"""The paper's equations, against numbers worked out by hand, symmetries and a closed form."""

from math import cos, isclose, pi, sin, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot import controller

# 1/(1 + e^-4), e = 2.718281828459045: e^-4 = 0.018315638888734179
RATE_AT_1 = 0.98201379003790844
# (e^2 - 1)/(e^2 + 1) with e^2 = 7.3890560989306502
TANH_1 = 0.76159415595576489

angles = st.floats(-20.0, 20.0)
potentials = st.floats(-1.0, 1.0)
steps = st.tuples(
    st.floats(0.003, 0.09),
    st.floats(0.5, 10.0),
    st.floats(0.1, 5.0),
    st.floats(0.0, 20.0),
    st.sampled_from((1, 2)),
)


def near(expected):
    return pytest.approx(expected, rel=1e-11, abs=1e-11)


def step(x1, x2, phi, dt_s=0.03, a=4.0, tau_s=0.25, k=8.0, rods=2):
    """A tick of a wheel whose neurons see its true angle."""
    return controller.step_wheel(
        x1, x2, *3 * controller.actual_positions(phi), dt_s, a, tau_s, k, rods
    )


@pytest.mark.parametrize(
    ("computed", "expected"),
    [
        (controller.actual_positions(pi / 6), (sqrt(3) / 2, 0.5)),
        (controller.actual_positions(-pi / 2), (0.0, -1.0)),
        # 2 y - 1, and the hyperbolic tangent of a x / 2.
        (
            (controller.target_position(1.0, 4.0), controller.target_position(0.0, 9.0)),
            (2 * RATE_AT_1 - 1, 0.0),
        ),
        (
            (controller.target_position(0.5, 4.0), controller.target_position(-0.25, 8.0)),
            (TANH_1, -TANH_1),
        ),
        ((controller.rod_force(0.5, -0.25, 8.0),), (6.0,)),
        (
            (controller.membrane_rate(0.25, 0.75, 0.25), controller.membrane_rate(1.0, -1.0, 2.0)),
            (2.0, -1.0),
        ),
        # At phi = 0 only the second rod turns the wheel, and a pull upwards turns it backward; at a
        # quarter turn only the first.
        (
            (
                controller.tangential_force(5.0, 3.0, 1.0, 0.0),
                controller.tangential_force(5.0, 3.0, 0.0, 1.0),
            ),
            (-3.0, 5.0),
        ),
        ((controller.tangential_force(2.0, -4.0, sqrt(3) / 2, 0.5),), (1.0 + 2.0 * sqrt(3),)),
        (
            (
                controller.motor_torque(1.0),
                controller.motor_torque(0.0),
                controller.motor_torque(-1.0),
            ),
            (TANH_1, 0.0, -TANH_1),
        ),
    ],
)
def test_each_equation_gives_what_a_hand_computes(computed, expected):
    assert computed == near(expected)


def test_a_whole_tick_gives_what_a_hand_computes():
    # At phi = 0 both neurons are pulled by dt/tau = 1/4 of the way to (1, 0): x1 = 0.2 + 0.8/4 =
    # 0.4, x2 = 0.4 - 0.4/4 = 0.3. F_tan = -F_2 = -k (x_t2 - 0) with x_t2 = tanh(a x2 / 2) =
    # tanh(0.3) = 0.29131261245159090 for a = 2.
    x1, x2, force, torque = step(0.2, 0.4, 0.0, dt_s=0.0625, a=2.0, k=2.0)
    assert x1 == near(0.4)
    assert x2 == near(0.3)
    assert force == near(-0.58262522490318180)
    # (e^2F - 1)/(e^2F + 1) with e^2F = e^-1.1652504498 = 0.3118447
    assert isclose(torque, -0.524571, abs_tol=1e-6)


def test_the_rods_act_on_the_new_potentials():
    """One step with dt = tau brings x1 from 0 to cos(phi).

    The old x1 would give a force of -k/2.
    """
    x1, _, force, _ = step(0.0, 0.0, pi / 4, dt_s=0.25, rods=1)
    assert x1 == near(sqrt(0.5))
    # tanh(2 sqrt(1/2)) = tanh(1.4142135623730951) = 0.88838556158566054
    assert force == near(8.0 * (0.88838556158566054 - sqrt(0.5)) * sqrt(0.5))


def test_what_the_neurons_see_does_not_reach_the_projection():
    """With dt -> 0 the neurons do not move, and then nothing they see may change the force."""
    forces = {
        controller.step_wheel(
            0.3, -0.6, *2 * (cos(0.7), sin(0.7)), seen_1, seen_2, 0.0, 4.0, 0.25, 8.0, 2
        )[2]
        for seen_1 in (-1.0, 0.2, 1.0)
        for seen_2 in (-0.8, 0.9)
    }
    assert len(forces) == 1


def test_an_older_angle_lies_on_the_line_through_two_readings():
    assert controller.lagging_angle(3.0, 2.0, 0.04, 0.01) == near(2.75)
    assert controller.lagging_angle(-3.0, -2.0, 0.04, 0.03) == near(-2.25)
    assert controller.lagging_angle(3.0, 2.0, 0.04, 0.04) == 2.0
    assert controller.lagging_angle(3.0, 2.0, 0.004, 0.01) == 2.0


@given(potentials, potentials, angles, st.floats(-0.5, 0.5), st.floats(0.0, 20.0))
def test_older_rods_add_a_force_against_the_motion(x1, x2, phi, behind, k):
    """F_tan has -k sin(phi - older) in addition, whatever the neurons do."""
    actual = controller.actual_positions(phi)
    rods = controller.actual_positions(phi - behind)
    fresh, lagging = (
        controller.step_wheel(x1, x2, *actual, *positions, *actual, 0.03, 4.0, 0.25, k, 2)
        for positions in (actual, rods)
    )
    assert lagging[:2] == fresh[:2]
    assert lagging[2] - fresh[2] == pytest.approx(-k * sin(behind), abs=1e-12)


@given(potentials, potentials, angles, steps)
def test_a_quarter_turn_of_everything_changes_no_force_on_two_rods(x1, x2, phi, parameters):
    """(x1, x2, phi) -> (-x2, x1, phi + pi/2) is a rotation of the wheel with its rods.

    The two rods are alike.
    """
    dt_s, a, tau_s, k, _ = parameters
    x1_new, x2_new, force, torque = step(x1, x2, phi, dt_s, a, tau_s, k)
    turned = step(-x2, x1, phi + pi / 2, dt_s, a, tau_s, k)
    assert turned == near((-x2_new, x1_new, force, torque))


@given(potentials, potentials, angles, steps)
def test_a_mirrored_wheel_is_driven_the_other_way(x1, x2, phi, parameters):
    x1_new, x2_new, force, torque = step(x1, x2, phi, *parameters)
    mirrored = step(x1, -x2, -phi, *parameters)
    assert mirrored == near((x1_new, -x2_new, -force, -torque))


@given(potentials, potentials, angles, steps)
def test_one_rod_is_the_first_of_the_two(x1, x2, phi, parameters):
    """The second rod's share is -F_2 cos(phi).

    Without it the first neuron's force is left, and both neurons go on.
    """
    *first, _ = parameters
    alone, both = step(x1, x2, phi, *first, 1), step(x1, x2, phi, *first, 2)
    assert alone[:2] == both[:2]
    # Where cos(phi) = 0 the second rod has no lever.
    assert step(x1, x2, pi / 2, *first, 1)[2] == near(step(x1, x2, pi / 2, *first, 2)[2])
    # The share of the second rod does not depend on x1.
    other_alone, other_both = step(-x1, x2, phi, *first, 1), step(-x1, x2, phi, *first, 2)
    assert isclose(both[2] - alone[2], other_both[2] - other_alone[2], abs_tol=1e-9)


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), angles, steps)
def test_nothing_grows_without_bound(x1, x2, phi, parameters):
    x1, x2, force, torque = step(x1, x2, phi, *parameters)
    assert max(abs(x1), abs(x2)) <= 10.0
    assert abs(force) <= 4.0 * parameters[3]
    assert -1.0 <= torque <= 1.0


@pytest.mark.parametrize("omega", [0.5, 12.0, -6.0])
def test_m9_the_potentials_of_a_constantly_turning_wheel_approach_the_closed_form(omega):
    """Eq. x-t, and the Euler step is of first order.

    A tenth of the step is a tenth of the error.
    """
    tau_s = 0.25

    def error(dt_s):
        x1 = x2 = 0.0
        for tick in range(round(4.0 / dt_s)):
            x1, x2, _, _ = step(x1, x2, omega * tick * dt_s, dt_s=dt_s, tau_s=tau_s)
        angle = omega * round(4.0 / dt_s) * dt_s
        scale = 1.0 + (omega * tau_s) ** 2
        exact_1 = (cos(angle) + omega * tau_s * sin(angle)) / scale
        exact_2 = (sin(angle) - omega * tau_s * cos(angle)) / scale
        return max(abs(x1 - exact_1), abs(x2 - exact_2))

    errors = [error(dt_s) for dt_s in (0.01, 0.001, 0.0001)]
    assert errors[2] < 1e-3
    assert 8.0 < errors[0] / errors[1] < 12.0
    assert 8.0 < errors[1] / errors[2] < 12.0
