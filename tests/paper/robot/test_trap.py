"""The trap of chaos (R14): a wheel that rests within a degree of a multiple of 45 degrees.

The encoder then reads the multiple itself. There both rods' pulls cancel exactly (M = 0), and the
wheel rests until something else moves it, at any k. A degree beside it M is beyond the motor's
stall.
"""

import numpy as np
import pytest

from robot.params import Params
from sim_motor import batch
from sim_motor.constants import load

STALL = 0.1


def run_chaotic(degrees, dither_deg):
    """Torques M and angles (degrees) of a wheel whose potentials are those of the angle read."""
    params = Params()
    params.apply(params.check({"k": 15.0, "tau_s": 1.0}))
    states = np.zeros((1, 6))
    states[:, :2] = np.radians(degrees)
    read = np.radians(int(degrees))
    record = batch.run(
        1,
        700,
        3,
        params=params,
        motors=(load().with_dither(dither_deg),),
        start=batch.Start(states, np.array([[np.cos(read), np.sin(read)]])),
        record=1,
    ).records[0]
    return record[:, 4], np.degrees(record[:, 0])


@pytest.mark.parametrize("multiple", range(1, 8))
def test_a_wheel_rests_where_its_encoder_reads_a_multiple_of_45_degrees(multiple):
    torques, angles = run_chaotic(45 * multiple + 0.3, 0.0)
    assert np.abs(torques).max() < 1e-12
    assert np.ptp(angles) == 0.0


@pytest.mark.parametrize("multiple", range(1, 8))
def test_a_degree_beside_it_nothing_holds_the_wheel(multiple):
    torques, angles = run_chaotic(45 * multiple + 1.3, 0.0)
    assert abs(torques[0]) > STALL
    assert np.ptp(angles) > 90.0


@pytest.mark.parametrize("multiple", range(1, 8))
def test_an_encoder_that_dithers_leads_out_of_it(multiple):
    torques, angles = run_chaotic(45 * multiple + 0.3, 0.2)
    assert abs(torques[0]) < 1e-12
    assert np.ptp(angles) > 90.0
