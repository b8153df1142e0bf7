"""Basins say where the robot itself ends."""

from dataclasses import replace
from math import atan2, hypot, pi

import numpy as np
import pytest

from host.errors import NotDone
from host.lab.basins import compute, ends_of, starts
from host.lab.derived import wrapped
from sim_motor.constants import load
from tests.bench_basins import (
    changed,
    kicks_as_foretold,
    picture,
    question,
    starts_as_foretold,
)


@pytest.fixture(scope="module")
def ordinary():
    return picture({}, side=32)


def test_a_robot_ends_where_its_basins_say(ordinary):
    right = starts_as_foretold({}, ordinary, 40)
    right += [one for _, one in kicks_as_foretold({}, ordinary, 20)]
    assert np.mean(right) >= 0.95


def test_forward_and_backward_mirror_each_other(ordinary):
    turned = ordinary["ends"][::-1].translate(str.maketrans("fb", "bf"))
    differ = sum(one != other for one, other in zip(ordinary["ends"], turned, strict=True))
    assert differ < 0.03 * len(turned)  # the encoder rounds towards zero
    assert len(turned) == ordinary["side"] ** 2


def test_rows_are_those_of_the_whole_picture(ordinary):
    asked = question({}, side=32)._replace(rows=(8, 10), radius=ordinary["radius"])
    assert compute(asked)["ends"] == ordinary["ends"][8 * 32 : 10 * 32]


@pytest.mark.parametrize(
    ("changes", "end"),
    [({"k": 0.3}, "rest"), ({"k": 15.0, "tau_s": 1.0, "rod_lag_s": 0.01}, "neither")],
)
def test_a_robot_that_rests_and_one_in_chaos_have_basins_of_their_own(changes, end):
    drawn = picture(changes, side=4)
    assert drawn["ends"].count(end[0]) >= 14
    if end == "rest":
        assert drawn["radius"] == pytest.approx(1.0, abs=1e-3)  # memory of a wheel that stands


def test_a_wheel_has_ended_when_it_stays_as_it_is():
    ticks = np.arange(100)
    courses = [0.3 * ticks, -0.3 * ticks, 0.0 * ticks, 2 * np.sin(0.2 * ticks)]
    courses.append(np.minimum(ticks, 70) * 0.3)  # it has stopped only lately
    expected = ["forward", "backward", "rest", "neither", "neither"]
    assert ends_of(np.array(courses)) == expected


def test_starts_lie_in_the_plane_as_the_page_draws_it():
    start = starts(4, 0.5, changed({}))
    lags = [wrapped(start.states[0, 0] - atan2(x2, x1)) for x1, x2 in start.potentials[:4]]
    assert lags == pytest.approx([-0.75 * pi, -0.25 * pi, 0.25 * pi, 0.75 * pi])
    assert start.states[::4, 2] == pytest.approx(np.array([-4.5, -1.5, 1.5, 4.5]) * pi)
    assert [hypot(*x) for x in start.potentials] == pytest.approx([0.5] * 16)


def test_what_the_simulation_cannot_follow_is_said_in_words():
    motor = replace(load(), latency_s=0.05)
    found = compute(question({}, side=4)._replace(motor=motor))
    assert isinstance(found, NotDone)
    assert "longer" in found.hint
