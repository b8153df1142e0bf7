"""The wheel of the model with constants that the paper does not have."""

import math

import numpy as np
import pytest

from host.errors import WrongUse
from host.theory.analysis.fixpoints import fixpoints
from host.theory.analysis.hopf import hopf
from host.theory.engine.ensemble import advance
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


@pytest.mark.parametrize("lag_s", [-5, math.nan, math.inf, "x"])
def test_rods_are_older_by_a_time(lag_s):
    with pytest.raises(WrongUse, match="cannot be"):
        Wheel().with_older_rods(lag_s)


@pytest.mark.parametrize(
    ("call", "wheel"),
    [
        (fixpoints, Wheel(f=1e308)),
        (fixpoints, Wheel(I=1e-308)),
        (hopf, Wheel(f=1e-300)),
        (hopf, Wheel(f=1e308)),
        (hopf, Wheel(tau=1e300)),
    ],
)
def test_constants_that_leave_no_digits_are_refused_by_their_letters(call, wheel):
    with pytest.raises(WrongUse, match=r"a wheel with a = 4, tau = .* too large or too small"):
        call(wheel)


def test_a_wheel_that_runs_away_is_told_by_its_letters():
    start = np.array([[1.0], [0.0], [0.0], [1e300]])
    with pytest.raises(WrongUse, match=r"a wheel with a = 4, tau = 0\.25, .* ran away") as caught:
        advance(start, Wheel().columns(1), 1.0)
    assert "start" in caught.value.hint
