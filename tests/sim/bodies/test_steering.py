"""Plans that drive a train to a goal by kicks."""

import sys
from math import cos, pi, sin

import numpy as np
import pytest

from host.bodies import steering
from host.bodies.steering import ALL_PAIRS, CHOICES, LEFT, NO_KICK, RIGHT, plan, relative_to
from host.errors import WrongUse
from host.util.installation import install_command


def arc(turn_rad):
    """A metre's way in ten looks, turning so much."""
    part = np.linspace(0.1, 1.0, 10)
    return np.stack([part, turn_rad * part**2 / 2, turn_rad * part], axis=1)


def test_a_plan_turns_to_its_goal_whatever_the_kicks_are_called():
    turns = np.array([arc(0.0), arc(0.5), arc(-0.5)])
    true = np.broadcast_to(turns, (3, 3, 10, 3))
    mirrored = true[:, [NO_KICK, RIGHT, LEFT]]
    for bearing, choice, other in (
        (0.0, NO_KICK, NO_KICK),
        (0.7, LEFT, RIGHT),
        (-0.7, RIGHT, LEFT),
    ):
        for start in ((0.0, 0.0, 0.0), (5.0, -2.0, 2.5)):
            goal = np.array(
                [start[0] + 3.0 * cos(start[2] + bearing), start[1] + 3.0 * sin(start[2] + bearing)]
            )
            assert plan(true, start, NO_KICK, goal) == choice
            assert plan(mirrored, start, NO_KICK, goal) == other


def test_a_plan_that_is_followed_ends_at_goals_all_around():
    effects = np.broadcast_to(np.array([arc(0.0), arc(0.5), arc(-0.5)]), (3, 3, 10, 3))
    for bearing in (-pi, -2.0, 0.5, 1.6):
        goal, pose, nearest = 3.0 * np.array([cos(bearing), sin(bearing)]), np.zeros(3), 3.0
        for _ in range(12):
            step = effects[0, plan(effects, pose, NO_KICK, goal)]
            turn = np.array([[cos(pose[2]), sin(pose[2])], [-sin(pose[2]), cos(pose[2])]])
            way = pose[:2] + step[:, :2] @ turn
            nearest = min(nearest, np.hypot(*(way - goal).T).min())
            assert relative_to(pose, np.column_stack([way, pose[2] + step[:, 2]])) == pytest.approx(
                step
            )
            pose = np.array([*way[-1], pose[2] + step[-1, 2]])
        assert nearest < 0.2


def test_every_choice_is_tried_after_every_other():
    pairs = list(zip((ALL_PAIRS[-1], *ALL_PAIRS), ALL_PAIRS, strict=False))
    assert sorted(pairs) == [(last, choice) for last in CHOICES for choice in CHOICES]
    assert ALL_PAIRS[-1] == NO_KICK


def test_without_gymnasium_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(WrongUse) as refused:
        steering.build_environment("snake2019")
    assert install_command("gym") in refused.value.hint
