"""The search for the smallest kick, and the simulated wheels on which it tries kicks."""

from math import pi
from types import SimpleNamespace

import numpy as np
import pytest

from host.kicking.rolling_wheels import BEGIN, WHEELS, RollingWheels, roll
from host.kicking.search import LEAST_EFFORT, SHORTEST, effort_s, search
from robot.params import Params
from sim_motor.batch import random_start, run
from sim_motor.constants import load


@pytest.fixture(scope="module")
def wheels():
    return roll(Params(), load(), 1)


def test_a_kick_meets_wheels_that_roll_on_as_if_nobody_had_looked(wheels):
    phases, _ = wheels.kicked({"mode": "membrane"})
    ticks = 250
    whole = run(
        WHEELS,
        ticks,
        0,
        motors=(load(),),
        start=random_start(WHEELS, np.random.default_rng(1), load()),
        times=0.03 * np.arange(ticks),
        record=WHEELS,
    )
    begin = round((3.0 + 8 * 0.25) / 0.03) + BEGIN
    met = whole.records[whole.after == 1, begin, 0] % (pi / 2)
    assert phases.tolist() == sorted(met.tolist())


@pytest.mark.parametrize(
    ("reverses", "first", "width"),
    [
        ("11111111", 0.0, 8.0),
        ("11000111", 5.0, 4.0),  # around the end of the circle
        ("01100111", 5.0, 2.0),
        ("01000000", None, None),
        ("00000000", None, None),
    ],
)
def test_a_window_is_the_longest_run_of_phases_around_the_circle(reverses, first, width):
    stub = SimpleNamespace(
        kicked=lambda request: (np.arange(8.0), np.array(list(reverses)) == "1"), period_rad=8.0
    )
    window = RollingWheels.window(stub, {})
    assert (window and (window.first_rad, window.width_rad)) == (
        None if first is None else (first, width)
    )


@pytest.mark.parametrize(
    ("kick", "effort"),
    [
        ({"mode": "position", "ticks": 3}, 0.09),
        ({"mode": "phase", "ticks": 4, "shift": 3 * pi / 4}, 0.09),
        ({"mode": "pulse", "param": "k", "value": 12.0, "ticks": 10}, 0.15),
        ({"mode": "pulse", "param": "k", "value": 12.0, "ticks": 10, "shape": "smooth"}, 0.075),
        ({"mode": "membrane"}, None),
    ],
)
def test_the_effort_of_a_kick_is_its_change_times_its_length(kick, effort):
    found = effort_s(kick, Params())
    assert found is effort is None or found == pytest.approx(effort, rel=1e-12)


def test_the_smallest_pulses_are_smaller_than_the_papers_and_none_below_them_does_it(
    wheels, monkeypatch
):
    monkeypatch.setattr(
        "host.kicking.search.AMPLITUDES", (("k", (-1.0,)), ("shift_rad", (0.375, 0.5)))
    )
    monkeypatch.setattr("host.kicking.search.lengths", lambda tick_s: [1, 2, 3])
    (shortest,) = search(wheels, SHORTEST)  # a pulse of k alone reverses no wheel
    assert shortest.request == {
        "mode": "pulse",
        "param": "shift_rad",
        "value": pi / 2,
        "ticks": 3,
    }
    assert wheels.window({**shortest.request, "ticks": 2}) is None
    assert shortest.effort_s == pytest.approx(0.045)
    (least,) = search(wheels, LEAST_EFFORT)
    assert wheels.step_rad <= least.window.width_rad < wheels.period_rad
    assert least.effort_s < shortest.effort_s
    smaller = wheels.window({**least.request, "value": least.request["value"] - 0.05})
    assert smaller is None or smaller.width_rad < wheels.step_rad
