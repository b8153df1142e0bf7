"""The experiment `explore`: which cells count as visited, when a robot returns, and where it is."""

import numpy as np
import pytest

from host.errors import WrongUse
from host.experiments.robot import explore
from host.experiments.robot.explore import (
    CELL_M,
    CHAOTIC,
    FLOOR_M,
    KICKED,
    SIDE,
    STEP_S,
    STRAIGHT,
)
from host.runs.contract import Setting

SETTING = Setting(1, {"robots": 2, "minutes": 0.5})


def in_cells(*columns):
    """Places in the middle line of the floor, in these columns of cells."""
    return np.array([((column - SIDE // 2) * CELL_M, 0.0) for column in columns])


def test_each_cell_counts_once_and_corners_are_in_the_outermost_cells():
    shares = explore.visited_shares(in_cells(4, 5, 4, 5, 6))
    assert (shares * SIDE**2).round().tolist() == [1, 2, 2, 2, 3]
    corner = np.array([[FLOOR_M / 2, FLOOR_M / 2], [-FLOOR_M / 2, -FLOOR_M / 2]])
    assert explore.cells_of(corner).tolist() == [SIDE**2 - 1, 0]


def test_a_return_lasts_from_leaving_a_cell_to_the_next_visit():
    times = explore.return_times(in_cells(4, 4, 5, 5, 6, 5, 4))
    assert times == pytest.approx([STEP_S, 4 * STEP_S])
    assert len(explore.return_times(in_cells(4, 5, 6))) == 0


def test_the_random_walk_goes_at_the_robots_speed_and_stays_inside():
    path = explore.random_walk(2000, np.random.default_rng(1))
    assert np.hypot(*np.diff(path, axis=0).T) == pytest.approx(explore.SPEED_M_S * STEP_S)
    assert np.abs(path).max() <= (FLOOR_M - CELL_M) / 2


def test_a_straight_robot_has_the_walks_speed_and_chaos_gets_less_far():
    rows = [
        {"way": way, **place}
        for way in (STRAIGHT, CHAOTIC)
        for place in explore.simulate({"way": way}, SETTING)
    ]
    straight, chaotic = (explore.paths_of(rows, way) for way in (STRAIGHT, CHAOTIC))
    speeds = np.hypot(*np.diff(straight, axis=1).transpose(2, 0, 1)) / STEP_S
    assert np.median(speeds) == pytest.approx(explore.SPEED_M_S, rel=0.05)
    lengths = [
        np.hypot(*np.diff(paths, axis=1).transpose(2, 0, 1)).sum(axis=1).mean()
        for paths in (chaotic, straight)
    ]
    assert 0.5 < lengths[0] < lengths[1]


def test_a_real_robot_is_refused_in_words():
    with pytest.raises(WrongUse, match="simulated robot"):
        explore.cells(SETTING.options, batch=False)


def test_robots_drive_the_same_ways_in_parts(monkeypatch):
    setting = Setting(1, {"robots": 3, "minutes": 0.1})
    cell = {"way": KICKED}
    whole = explore.simulate(cell, setting)
    monkeypatch.setattr(explore, "ROBOTS_OF_A_PART", 2)
    first, last = explore.parts(cell, setting, None)
    assert (first.share, last.share) == (2 / 3, 1.0)
    assert [*first.rows, *last.rows] == whole
    assert list(explore.parts(cell, setting, first)) == [last]
