"""Kicks of a running train: which wheels they reach, and how outcomes are classified."""

import numpy as np
import pytest

from host.experiments.bodies import train_kick
from host.experiments.bodies.simulation import build_pushed_train
from sim_motor.bodies.presets import preset


@pytest.mark.parametrize(
    ("after", "outcome"),
    [
        (-40.0, train_kick.REVERSED),
        (40.0, train_kick.GOES_ON),
        (1.0, train_kick.STOPS),
        (np.array([40.0] * 5 + [-40.0] * 5), train_kick.MIXED),
    ],
)
def test_a_kicks_outcome_depends_on_all_wheels(after, outcome):
    assert train_kick.classify_outcome(np.full(10, 50.0), np.broadcast_to(after, (10,))) == outcome


def test_a_kick_takes_the_wheels_it_names_only():
    body = build_pushed_train(preset("paper"), seed=1)
    body.run(0.2)
    before = body.neurons.x1.copy()
    body.kick(
        train_kick.build_kick(
            {"mode": "membrane", "wheels": 1, "seconds": None}, ["car1_left"], body
        )
    )
    body.run(0.001)
    signs = np.sign(body.neurons.x1 * before)
    assert signs.tolist() == [1, 1, -1, *[1] * 7]
