"""A train that learns what kicks do, and drives to a goal."""

import numpy as np
import pytest

from host.bodies.steering import LEFT, NO_KICK, RIGHT
from host.experiments.bodies import train_goal
from host.figures.bodies.train_goal import draw
from host.runs.contract import Setting
from tests.paper.bodies.short_runs import has_columns_of, plain


def test_a_train_learns_what_kicks_do_and_drives_to_a_goal_which_one_that_is_not_kicked_misses(
    monkeypatch,
):
    monkeypatch.setattr(train_goal, "ROUNDS", 1)
    monkeypatch.setattr(train_goal, "LIMIT_S", 20.0)
    setting = Setting(1, {"goals": 1})
    cells = [{"goal": 2, "way": way} for way in (train_goal.PLANNED, train_goal.NONE)]
    planned, left_alone = (
        {**cell, **row} for cell in cells for row in train_goal.simulate(cell, setting)
    )
    assert planned["goal_m"] == left_alone["goal_m"]
    assert np.hypot(*planned["goal_m"]) == pytest.approx(3.0)
    course = np.array(planned["course"])
    assert np.hypot(*(course[-11:, :2] - planned["goal_m"]).T).min() < 0.2
    assert planned["reached_s"] < 20.0
    assert left_alone["reached_s"] is None
    turned = np.array(planned["effects"])[..., 2]
    assert turned[LEFT, LEFT] > 0.3
    assert turned[RIGHT, RIGHT] < -0.3
    assert abs(turned[NO_KICK, NO_KICK]) < 0.1
    rows = plain([planned, left_alone, {**left_alone, "way": train_goal.RANDOM}])
    assert all(has_columns_of(row, train_goal.Row) for row in rows)
    findings = train_goal.report(rows, setting)
    assert [way["reached"] for way in findings.numbers["ways"]] == [1, 0, 0]
    assert plain(findings.numbers) == findings.numbers
    assert [axes.get_label() for axes in draw(rows, findings).axes] == ["goal-1", "reached"]
