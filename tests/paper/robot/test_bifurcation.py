"""The experiment `bifurcation`.

The jump, the hysteresis, the unstable branch that is one, and no claim where they are missing.
"""

import pytest

from host.client.robot import connect
from host.experiments.robot import bifurcation
from host.experiments.robot.bifurcation_pieces import LEAST_K, MIDDLE_K
from host.experiments.robot.bifurcation_rows import held_cycles, least_k
from host.figures.robot.bifurcation import draw, panels
from host.logs.log import Log
from host.runs.contract import Setting
from robot.kicks import WHEELS

SETTING = Setting(1, {"points": 33, "rounds": 3, "k": 8.0})


def done(cell, seed=3):
    """A cell's rows with its fields, as a run has them."""
    with connect("sim://", seed) as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        return [{**cell, **row} for row in bifurcation.trial(cell, robot, log, SETTING)]


@pytest.fixture(scope="module")
def sweep():
    return done({"part": "sweep", "motion": "backward", "trial": 0})


@pytest.fixture(scope="module")
def folds():
    return done({"part": "fold", "motion": "forward", "trial": 0})


@pytest.fixture(scope="module")
def branch():
    return {
        hertz: done({"part": "branch", "motion": "forward", "held_hz": hertz})[0]
        for hertz in (0.24, 0.3, 0.5)
    }


def verdict(rows, number, setting=SETTING):
    return next(claim for claim in bifurcation.report(rows, setting).claims if claim.id == number)


def test_the_same_k_finds_the_robot_running_on_the_way_down_and_at_rest_on_the_way_up(sweep):
    for side in WHEELS:
        runs = {
            way: {
                row["k"]
                for row in sweep
                if (row["way"], row["side"]) == (way, side) and not row["rests"]
            }
            for way in ("down", "up")
        }
        assert len(runs["down"] - runs["up"]) >= 2
        assert 8.0 in runs["up"]
        assert min(runs["down"] | runs["up"]) > 0.44


def test_locomotion_falls_from_a_torque_well_above_the_stall(folds):
    assert [row["side"] for row in folds] in (["left", "right"], ["right", "left"])
    assert all(abs(row["torque"]) > 0.15 and abs(row["torque_after"]) < 0.1 for row in folds)
    assert all(0.44 < row["k_after"] < row["k"] < 0.52 for row in folds)


def test_feedback_holds_cycles_on_both_sides_of_the_fold_and_does_not_change_them(branch):
    assert len(held_cycles(list(branch.values()))) == len(branch)
    assert branch[0.24]["k"] > branch[0.3]["k"] < branch[0.5]["k"]


def test_without_the_feedback_a_wheel_leaves_an_unstable_cycle_and_stays_on_a_stable_one(branch):
    assert abs(branch[0.24]["free_hz"] - 0.24) > 0.15 * 0.24
    assert branch[0.5]["free_hz"] == pytest.approx(0.5, rel=0.1)


def test_the_claims_hold(sweep, folds, branch):
    rows = [
        *sweep,
        *folds,
        *branch.values(),
        *done({"part": "ramp", "trial": 0}),
        *done({"part": "ramp", "trial": 1}, seed=4),
    ]
    assert verdict(rows, "R5").holds
    assert verdict(rows, "R6").holds
    few, weak = Setting(1, {"points": 32, "rounds": 3}), Setting(1, SETTING.options, battery_v=5.0)
    assert verdict(rows, "R6", few).holds is None
    short = verdict(rows, "R6", Setting(1, {"points": 20, "rounds": 1}))
    assert short.holds is None
    assert "points = 33 or more (here 20), rounds = 3 or more (here 1)" in short.note
    assert verdict(rows, "R5", few).holds
    assert [claim.holds for claim in bifurcation.report(rows, weak).claims] == [None, None]


@pytest.mark.parametrize(
    "changed",
    [
        {"torque": 0.11},  # a torque that fades away
        {"torque_after": 0.13},  # no rest
        {"k": 9.0, "k_after": 8.5},  # where it falls it runs again: no hysteresis
    ],
)
def test_r6_does_not_hold_without_jump_rest_and_hysteresis(sweep, folds, branch, changed):
    rows = [*sweep, *({**row, **changed} for row in folds), *branch.values()]
    assert verdict(rows, "R6").holds is False


def test_r5_does_not_hold_for_a_motor_that_moves_too_early(branch):
    early = {"part": "ramp", "torque": 0.05, "holds": False, "note": "left: moves at 0.050"}
    claim = verdict([*branch.values(), early], "R5")
    assert claim.holds is False
    assert "0.050" in claim.note


def test_a_speed_that_was_not_held_is_no_point_of_the_branch(branch):
    slipped = {**branch[0.24], "hz": 0.0}
    shaken = {**branch[0.24], "k_sd": 0.1}
    assert held_cycles([slipped, shaken]) == []
    assert least_k(held_cycles([slipped, shaken])) is None


def test_the_figure_separates_unstable_cycles_from_stable_ones(folds, branch):
    """The cycles lie on a smooth line whose least k is at 0.3 Hz."""
    cycles = [
        {**branch[0.24], "held_hz": hz, "hz": hz, "torque": hz / 2, "k": 0.47 + (hz - 0.3) ** 2}
        for hz in bifurcation.SPEEDS_HZ
    ]
    rows = [*folds, *cycles]
    figure = draw(rows, bifurcation.report(rows, SETTING))
    stable, unstable = (
        next(line.get_ydata() for line in figure.axes[5].lines if line.get_linestyle() == style)
        for style in ("-", "--")
    )
    assert (min(unstable), max(unstable)) == pytest.approx((0.2, 0.3), abs=0.01)
    assert (min(stable), max(stable)) == pytest.approx((0.3, 0.8), abs=0.01)


def test_a_ladder_has_as_many_rungs_as_asked_for_and_is_denser_at_small_k():
    steps = bifurcation.ladder(33, 8.0)
    assert len(set(steps)) == 33
    assert steps == sorted(steps)
    assert steps[0] == LEAST_K
    assert steps[-1] == 8.0
    assert sum(k <= MIDDLE_K for k in steps) >= 16


def test_without_held_cycles_the_figure_has_no_empty_panel(folds):
    figure = draw(folds, bifurcation.report(folds, SETTING))
    assert [axes.get_label() for axes in figure.axes] == ["torque", "torque-2", "speed", "speed-2"]
    assert [panels({"branch": count})[-1] for count in (0, 1)] == ["speed-2", "speed-near"]
