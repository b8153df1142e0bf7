"""The exact step of a motor: its numbers, their bits, and motors that are too fast for it."""

from dataclasses import replace
from math import exp

import numpy as np
import pytest
from scipy.linalg import expm

from sim_motor.arrays import tables
from sim_motor.constants import SUBSTEP_S, Steps, load, names
from sim_motor.exact_step import COAST


def matrix_of(c, wheel, duty):
    """The motor's equations as (A B; 0 0): speed, current, angle, volts and torque."""
    ohms = c.resistance + 2 * c.source_resistance * (duty / 100) ** 2
    inertia = c.motor_inertia + wheel * c.wheel_inertia
    matrix = np.zeros((5, 5))
    matrix[0] = -c.viscous / inertia, c.torque_constant / inertia, 0, 0, 1 / inertia
    matrix[1] = -c.emf_constant / c.inductance, -ohms / c.inductance, 0, 1 / c.inductance, 0
    matrix[2, 0] = 1
    if duty == COAST:
        matrix[0, 1], matrix[1] = 0, 0
    return matrix


@pytest.mark.parametrize("name", names())
@pytest.mark.parametrize("wheel", [0, 1])
@pytest.mark.parametrize("duty", [0, 1, 57, 100, COAST])
def test_it_is_the_exponential_of_the_motors_equations(name, wheel, duty):
    c = load(name)
    step, matrix = Steps(c)[wheel, duty], matrix_of(c, wheel, duty) * SUBSTEP_S
    exact = expm(matrix)[:3][:, (0, 1, 3, 4)].ravel()
    assert step[:12] == pytest.approx(exact, rel=1e-11, abs=1e-18)
    locked, resistance = exp(matrix[1, 1]), -matrix[1, 1] / (matrix[1, 3] or 1)
    volts = (1 - locked) / resistance if duty != COAST else 0.0
    assert step[12:] == pytest.approx((locked if duty != COAST else 0.0, volts), rel=1e-11)


@pytest.mark.parametrize("name", names())
def test_compiled_code_and_plain_python_have_the_same_bits(name):
    constants = load(name).varied(1.03, 0.9)
    steps = Steps(constants)
    (table,) = tables([constants])
    for wheel in (0, 1):
        for duty in range(COAST + 1):
            assert steps[wheel, duty] == tuple(table[wheel, duty].tolist())


@pytest.mark.parametrize("make", [Steps, lambda constants: tables([load(), constants])])
@pytest.mark.parametrize("change", [{"inductance": 1e-9}, {"motor_inertia": 1e-12}])
def test_a_motor_that_is_too_fast_is_refused(make, change):
    with pytest.raises(ValueError, match="faster than in a simulated step of 1 ms"):
        make(replace(load(), **change))
