"""The car's route to locomotion: how motions are classified, and the formula for rolling."""

import numpy as np
import pytest

from host.experiments.bodies import car_route
from sim_motor.bodies.presets import preset


def turning(*speeds):
    return np.repeat(np.array([speeds], dtype=float), 1000, axis=0)


def test_a_cars_motion_has_one_name():
    t = np.arange(1000) * 0.005
    swing = np.stack([5 * np.cos(3 * t), 0 * t], axis=1)
    found = [
        car_route.classify_motion(omega, 0.005)
        for omega in (turning(0, 0), swing, turning(9, -9), turning(9, 8), turning(-9, -8))
    ]
    assert found == [
        car_route.REST,
        car_route.SWING,
        car_route.SPIN,
        car_route.ROLL,
        car_route.ROLL,
    ]


def test_the_formula_gives_the_speed_of_the_car_of_2019_and_none_below_its_onset():
    assert car_route.rolling_rad_s(preset("snake2019")) == pytest.approx(98.0, abs=0.1)
    assert car_route.rolling_rad_s(preset("snake2019")._replace(k=0.07)) is None
