"""The wave along a train's joints: how it is measured."""

from math import pi

import numpy as np
import pytest

from host.experiments.bodies import train_wiggle


def test_a_wave_that_travels_has_its_frequency_its_lag_and_its_amplitudes():
    t = np.arange(6000) * 0.005
    waves = np.stack(
        [
            amplitude * np.cos(2 * pi * 3.8 * t - joint * 2.2)
            for joint, amplitude in enumerate((5, 10, 15, 20))
        ],
        axis=1,
    )
    rows = train_wiggle.measure_wiggling(waves, 0.005)
    assert [row["std_deg"] for row in rows] == pytest.approx(
        np.array((5, 10, 15, 20)) / np.sqrt(2), rel=0.01
    )
    assert [row["lag_deg"] for row in rows[1:]] == pytest.approx([-np.degrees(2.2)] * 3, abs=1.0)
    assert rows[0]["lag_deg"] is None
    assert [row["hz"] for row in rows] == pytest.approx([3.8] * 4, abs=0.05)
    assert train_wiggle.measure_wiggling(0.001 * waves, 0.005)[-1]["hz"] is None
