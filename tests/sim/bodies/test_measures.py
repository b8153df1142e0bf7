"""What is measured in the rows of a body."""

import numpy as np
import pytest

from sim_motor.bodies.measures import course, directions, order, summary


def test_a_train_reverses_at_walls_as_a_whole_and_the_measures_say_so(train):
    found = summary(train.columns, train.rows)
    assert len(found["reversals"]) == 2
    assert found["order_parameter"] > 0.9
    assert not found["stuck"]
    assert not found["flipped"]
    moved = course(train.columns, train.rows)
    signs = directions(moved)
    for time_s in found["reversals"]:
        before, after = (signs[np.searchsorted(moved.t_s, time_s + wait)] for wait in (-1.5, 2.0))
        assert before == -after != 0


def test_the_order_parameter_is_that_of_signs():
    assert order(
        np.array([[5.0, 6.0, -1.0, 1.0], [0.1, 0.0, -0.2, 0.3], [-9.0, -9.0, -9.0, -9.0]])
    ) == pytest.approx([0.5, 0.0, 1.0])
