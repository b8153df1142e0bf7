"""Trains from random phases. What B2 wants: test_claims.py."""

from host.experiments.bodies import train_start
from tests.paper.bodies.short_runs import setting


def test_the_same_seed_is_the_same_train_bit_for_bit():
    cell = {"preset": "paper", "number": 3}
    first = train_start.simulate(cell, setting("train-start"))
    assert train_start.simulate(cell, setting("train-start")) == first
    assert train_start.simulate(cell, setting("train-start", seed=2)) != first
