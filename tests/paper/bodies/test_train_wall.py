"""The train between two walls: what a reversal is. What B3 wants: test_claims.py."""

import numpy as np
import pytest

from host.experiments.bodies import train_wall
from tests.paper.bodies.short_runs import build_run


def shuttling(reversals, leg=600, wheels=10):
    ways = np.repeat((-1.0) ** np.arange(reversals + 1), leg)
    return np.repeat(40.0 * ways[:, None], wheels, axis=1)


def test_a_train_that_shuttles_is_not_taken_for_one_that_is_stuck():
    omega = shuttling(3)
    away = np.cumsum(omega[:, 0]) * 0.005 * 0.04
    row = train_wall.summarize_run(build_run(omega, x=away))
    assert row["reversals_s"] == pytest.approx([3.0, 6.0, 9.0], abs=0.01)
    assert (row["whole"], row["ended"]) == (3, train_wall.RUNS)
    slipping = build_run(np.full((2400, 10), 40.0), x=3.8)
    still = train_wall.summarize_run(slipping)
    assert (still["reversals_s"], still["ended"]) == ([], train_wall.STUCK)


def test_a_reversal_of_some_wheels_is_not_one_of_the_whole_train():
    omega = shuttling(1)
    omega[600:, :2] *= -1
    row = train_wall.summarize_run(build_run(omega, x=np.linspace(0, 5, 1200)))
    assert (len(row["reversals_s"]), row["whole"]) == (1, 0)
