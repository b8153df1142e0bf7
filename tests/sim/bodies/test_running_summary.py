"""The summary of a body that still runs is that of all its rows, and forgets them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_motor.bodies.measures import summary
from sim_motor.bodies.running_summary import RunningSummary

COLUMNS = (
    "t_s",
    "car0_left_omega_rad_s",
    "car0_right_omega_rad_s",
    *(f"car0_{name}" for name in ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")),
)
# Speeds at rest, that rock, that travel; runs of the same sign, with peaks of all sizes.
OMEGAS = st.sampled_from([0.0, 0.2, 0.6, 0.8, 2.0, 2.9, 3.0, 3.1, 7.0, 10.0, 13.0])
STEPS_M = st.sampled_from([0.0, 0.001, 0.3])


@st.composite
def rows(draw):
    """The rows of a body, a second apart."""
    wheels = draw(st.lists(st.tuples(OMEGAS, OMEGAS, st.sampled_from([-1, 1])), min_size=1))
    count = len(wheels)
    steps = draw(st.lists(STEPS_M, min_size=count, max_size=count))
    lean = draw(st.lists(st.sampled_from([0.0, 1.0, 1.7]), min_size=count, max_size=count))
    table = np.zeros((count, len(COLUMNS)))
    table[:, 0] = np.arange(count)
    table[:, 1:3] = [(sign * left, sign * right) for left, right, sign in wheels]
    table[:, 3] = np.cumsum(steps)
    table[:, 6] = lean
    return table


@given(rows(), st.integers(1, 4))
def test_it_is_that_of_all_rows_so_far(rows, block):
    running = RunningSummary(COLUMNS)
    for start in range(0, len(rows), block):
        running.add(rows[start : start + block])
        count = min(start + block, len(rows))
        found, whole = running.summary(), summary(COLUMNS, rows[:count])
        assert found["started_s"] == whole["started_s"]
        means = {name: value for name, value in whole.items() if value is not None}
        assert {name: found[name] for name in means} == {
            name: pytest.approx(value, rel=1e-9, abs=1e-12) for name, value in means.items()
        }


def test_it_keeps_the_rows_of_the_last_seconds_only():
    running = RunningSummary(COLUMNS)
    row = np.zeros(len(COLUMNS))
    for number in range(1000):
        row = row.copy()
        row[0], row[1:3] = 0.1 * number, 10.0 * np.sin(0.2 * number) + 0.001 * number
        running.add(row[None])
    kept = (running._latest, running._fastest)
    assert max(map(len, kept)) < 60
    assert len(running._reversals._turns) == len(running.summary()["reversals"]) + 1
