"""Trains with a faulty wheel: whether the wheel is as faulty as it should be."""

import numpy as np
import pytest

from host.experiments.bodies import train_fault
from host.experiments.bodies.simulation import build_pushed_train
from sim_motor.bodies.presets import preset
from tests.paper.bodies.short_runs import setting


def test_a_wheel_is_as_large_and_as_weak_as_its_fault_says():
    radii = np.linspace(0.95, 1.05, 10)
    body = build_pushed_train(preset("paper"), seed=1, edit=train_fault.scale_wheels(radii))
    sizes = [body.model.geom(name + "_wheel").size[0] for name in body.wheels]
    assert sizes == pytest.approx(0.03 * radii)
    dead = train_fault.simulate(
        {"part": "weaker", "wheel": train_fault.WEAK, "percent": -100, "number": 1},
        setting("train-fault"),
    )
    whole = train_fault.simulate(
        {"part": "weaker", "wheel": train_fault.WEAK, "percent": 0, "number": 1},
        setting("train-fault"),
    )
    assert dead[0]["speed_m_s"] < whole[0]["speed_m_s"]
