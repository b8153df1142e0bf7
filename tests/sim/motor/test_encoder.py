"""The simulated encoder, and the grid of substeps."""

from math import radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_motor.constants import SUBSTEP_S
from sim_motor.motor import (
    SAMPLE_SUBSTEPS,
    encoder,
    substep_at,
    substep_from,
)


@pytest.mark.parametrize(
    ("angle_deg", "position"),
    [
        (0.0, 0),
        (0.49, 0),
        (0.99, 0),
        (1.01, 1),
        (-0.01, 0),
        (-0.49, 0),
        (-0.51, -1),
        (-1.01, -1),
        (-1.51, -2),
        (359.9, 359),
        (-720.2, -720),
    ],
)
def test_the_encoder_truncates_half_degrees_as_the_kernel_does(angle_deg, position):
    """720 counts, halved towards zero: the bin around zero is 1.5 degrees wide, all others one."""
    assert encoder(0, radians(angle_deg), 0.0, 720.0) == position


def test_the_encoder_is_sampled_every_other_millisecond():
    assert SAMPLE_SUBSTEPS * SUBSTEP_S == 0.002
    assert encoder(8, radians(50.1), radians(40.1), 720.0) == 50
    assert encoder(9, radians(50.1), radians(40.1), 720.0) == 40


@given(st.integers(0, 10**9))
def test_a_time_on_the_grid_is_its_own_substep(substep):
    for time_s in (
        substep / 1000,
        np.nextafter(substep / 1000, -1),
        np.nextafter(substep / 1000, 1e9),
    ):
        assert substep_at(time_s) == substep_from(time_s) == substep
    assert (
        substep_from((substep + 0.5) / 1000)
        == substep_at((substep + 0.5) / 1000) + 1
        == substep + 1
    )
