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


def read_many(dither_deg, seed, angle_deg=100.5, samples=4000):
    """Readings of a wheel that stands still, one for each sample."""
    return [
        encoder(SAMPLE_SUBSTEPS * sample, radians(angle_deg), 0.0, 720.0, radians(dither_deg), seed)
        for sample in range(samples)
    ]


def test_a_dither_has_its_deviation_and_no_bias():
    """It is wider than the encoder's steps here, so that readings show it."""
    read = np.array(read_many(20.0, 3)) + 0.5 - 100.5
    assert np.mean(read) == pytest.approx(0.0, abs=4 * 20.0 / np.sqrt(len(read)))
    assert np.std(read) == pytest.approx(20.0, rel=0.05)
    neighbours = np.corrcoef(read[:-1], read[1:])[0, 1]
    assert abs(neighbours) < 4 / np.sqrt(len(read))


def test_a_dither_belongs_to_the_sample_and_to_the_seed():
    assert read_many(0.5, 3) == read_many(0.5, 3)
    assert read_many(0.5, 3) != read_many(0.5, 4)
    angles = radians(50.0), radians(50.0)
    for sample in range(0, 200, 2):
        one, other = (encoder(sample + late, *angles, 720.0, 0.01, 9) for late in (0, 1))
        assert one == other


def test_without_dither_a_wheel_that_stands_reads_one_number():
    assert set(read_many(0.0, 3)) == {100}


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
