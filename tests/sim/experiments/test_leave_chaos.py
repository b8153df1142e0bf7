"""The experiment `leave-chaos`: how it names an end, and that chaos comes back after kicks."""

import numpy as np
import pytest

from host.errors import WrongUse
from host.experiments.robot import leave_chaos
from host.experiments.robot.leave_chaos import (
    CHAOTIC,
    DEFAULT,
    REST_SET,
    RESTS,
    STAY,
    STRAIGHT,
    TURNS,
)
from host.runs.contract import Setting

SETTING = Setting(1, {"robots": 6})


def ends(kick, ticks, afterwards):
    cell = {"kick": kick, "ticks": ticks, "afterwards": afterwards}
    return [row["end"] for row in leave_chaos.simulate(cell, SETTING)]


def test_an_end_is_told_by_the_directions_of_both_wheels():
    ramp, still = np.linspace(0, 20, 100), np.zeros(100)
    swing = 5 * np.cos(ramp / 2)
    cases = ((ramp, ramp), (ramp, -ramp), (still, still), (ramp, swing), (ramp, still))
    found = [leave_chaos.end_of(np.array(case)) for case in cases]
    assert found == [STRAIGHT, TURNS, RESTS, CHAOTIC, TURNS]


def test_chaos_comes_back_after_a_pause_and_ends_with_other_parameters():
    assert set(ends("k = 0", 10, STAY)) == {CHAOTIC}
    assert set(ends("no kick", 0, DEFAULT)) <= {STRAIGHT, TURNS}
    assert set(ends("no kick", 0, REST_SET)) == {RESTS}


def test_every_kick_meets_the_robots_in_the_same_states():
    first, second = (
        leave_chaos.simulate({"kick": kick, "ticks": 1, "afterwards": STAY}, SETTING)
        for kick in ("membrane", "phase")
    )
    assert [row["left_rad_s"] for row in first] == [row["left_rad_s"] for row in second]


def test_a_real_robot_is_refused_in_words():
    with pytest.raises(WrongUse, match="simulated robot"):
        leave_chaos.cells(SETTING.options, batch=False)
