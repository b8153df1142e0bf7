"""The experiment `timeline`: three kicks there and back, and the slip beside the drift."""

import json
from math import pi

import numpy as np
import pytest

from host.client.robot import connect
from host.experiments.robot import timeline
from host.experiments.robot.timeline_rows import kick_rows, settled_kicks
from host.figures.robot.timeline import draw
from host.logs.log import Log
from host.runs.contract import Setting

SETTING = Setting(1, {"trials": 2})


def done(cell):
    """A cell's rows with its fields, as a run has them."""
    with connect("sim://", SETTING.seed_of(cell)) as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        return [{**cell, **row} for row in timeline.trial(cell, robot, log, SETTING)]


@pytest.fixture(scope="module")
def rows():
    return [row for cell in timeline.cells(SETTING.options, batch=False) for row in done(cell)]


def kick(slip, drift=0.01, settling=0.6):
    return {
        "kind": "kick",
        "mode": "membrane",
        "turn": 1,
        "ticks": 1,
        "kick_s": 0.03,
        "reversed": True,
        "settling_left_s": settling,
        "settling_right_s": settling,
        "relative_before_rad": 0.0,
        "relative_after_rad": slip,
        "slip_rad": slip,
        "drift_rad": drift,
    }


def verdict(rows, number):
    return next(claim for claim in timeline.report(rows, SETTING).claims if claim.id == number)


def test_all_three_kicks_reverse_there_and_back_and_take_longer_to_settle_than_they_last(rows):
    kicks = kick_rows(rows)
    assert [row["mode"] for row in kicks] == 2 * [
        mode for mode in timeline.KICKS for _ in timeline.TURNS
    ]
    assert all(row["reversed"] for row in kicks)
    settling_s = [kick.settling_s for kick in settled_kicks(kick_rows(rows))]
    assert min(settling_s) > max(row["kick_s"] for row in kicks)
    assert verdict(rows, "R8").measured == 1.0
    assert verdict(rows, "R8").holds is None  # too few kicks
    assert verdict(25 * rows, "R8").holds


def test_kicks_make_the_relative_phase_slip_and_that_it_does_not_without(rows):
    done = settled_kicks(kick_rows(rows))
    greatest_drift = max(abs(kick.drift_rad) for kick in done)
    assert max(abs(kick.slip_rad) for kick in done) > 3 * greatest_drift


def test_slip_is_what_lies_between_the_phases_before_and_after(rows):
    for kick in settled_kicks(kick_rows(rows)):
        left_over = kick.before_rad + kick.slip_rad - kick.after_rad
        assert timeline.wrap(left_over) == pytest.approx(0.0, abs=1e-9)


def test_only_the_first_round_keeps_its_ticks_and_they_show_both_kicks_of_each_kind(rows):
    ticks = [row for row in rows if row["kind"] == "tick"]
    assert {row["trial"] for row in ticks} == {0}
    for mode in timeline.KICKS:
        kicked = [row["kicked"] for row in ticks if row["mode"] == mode]
        assert np.count_nonzero(np.diff(np.array([False, *kicked], dtype=int)) == 1) == len(
            timeline.TURNS
        )


def test_the_same_seed_gives_the_same_rows_which_survive_json(rows):
    again = done({"trial": 1})
    assert json.loads(json.dumps(again, allow_nan=False)) == [
        row for row in rows if row["trial"] == 1
    ]


def test_the_figure_shows_the_round(rows):
    figure = draw(rows, timeline.report(rows, SETTING))
    assert [len(axes.lines) for axes in figure.axes[:6]] == 6 * [3]


def test_slips_no_greater_than_the_drift_are_no_slips():
    slips = 5 * [0.1, -0.12, 0.15, -0.2]
    assert verdict([kick(slip) for slip in slips], "R12").holds
    assert verdict([kick(slip, drift=0.3) for slip in slips], "R12").holds is False
    assert verdict([kick(slip) for slip in slips[1:]], "R12").holds is None


def test_r11_does_not_hold_for_settling_within_the_kick_or_always_at_once():
    assert verdict([kick(0.1), *[kick(0.1, settling=0.3)] * 19], "R11").holds
    assert verdict([kick(0.1, settling=0.3)] * 20, "R11").holds is False
    assert verdict([kick(0.1), *[kick(0.1, settling=0.02)] * 19], "R11").holds is False
    assert verdict([kick(0.1)] * 19, "R11").holds is None


def test_kicks_that_did_not_reverse_count_against_the_inversion():
    assert verdict([kick(0.1), {**kick(0.1), "reversed": False}], "R8").holds is False


@pytest.mark.parametrize("number", ["R8", "R11", "R12"])
def test_another_battery_decides_nothing(number):
    rows = [kick(0.1)] * 50
    weak, full = (Setting(1, SETTING.options, battery_v=volts) for volts in (6.0, 7.5))
    holds = {
        setting.battery_v: claim.holds
        for setting in (weak, full)
        for claim in timeline.report(rows, setting).claims
        if claim.id == number
    }
    assert holds == {6.0: None, 7.5: True}


@pytest.mark.parametrize(
    ("angle", "same"), [(0.0, 0.0), (3 * pi, -pi), (-pi / 2, -pi / 2), (7.0, 7.0 - 2 * pi)]
)
def test_relative_phases_are_directions(angle, same):
    assert timeline.wrap(angle) == pytest.approx(same)
