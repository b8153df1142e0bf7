"""The wheel of the model with constants that the paper does not have."""

import pytest

from host.theory.model.wheel import Wheel, rates
from robot.controller import actual_positions, step_wheel


def test_older_rods_are_a_friction_to_first_order():
    """Against the force of the rods at the angle of then, for wheels at constant speed."""
    lag_s = 0.006
    wheel = Wheel(k=8.0)
    lagging = wheel.with_older_rods(lag_s)
    for x1, x2, phi, omega in ((0.3, -0.7, 0.4, 12.0), (0.9, 0.1, 2.0, -5.0)):
        actual, older = actual_positions(phi), actual_positions(phi - omega * lag_s)
        force = step_wheel(x1, x2, *actual, *older, 0.0, 0.0, 0.0, wheel.a, 1.0, wheel.k, 2)[2]
        exact = (force - wheel.f * omega) / wheel.I
        error = rates(x1, x2, phi, omega, *lagging)[3] - exact
        cubic = -wheel.k * (omega * lag_s) ** 3 / 6 / wheel.I
        assert error == pytest.approx(cubic, rel=1e-2)
    assert wheel.with_older_rods(0.0) == wheel
