"""The robot at a wall (R13): what counts as a bounce, how a log is read, what simulations do."""

import json
from math import pi

import numpy as np
import pytest

from host.client.robot import connect
from host.experiments.robot import wall, wall_hits, wall_rows
from host.figures.robot.wall import draw
from host.logs.log import Log
from host.runs.contract import Setting
from robot.kicks import WHEELS

SETTING = Setting(1, {"bounces": 50, "k": 2.0})
TICK_S = 0.03
FLOOR = {"part": "claim", "k": 2.0, **wall_rows.PAPER}


def ticks(*phases):
    """(t, phi, torque) of phases of (seconds, left speed, right speed) in rad/s.

    M has the speed's sign.
    """
    speeds = np.concatenate(
        [np.tile([left, right], (round(seconds / TICK_S), 1)) for seconds, left, right in phases]
    ).astype(float)
    return (
        np.arange(len(speeds)) * TICK_S,
        np.cumsum(speeds, axis=0) * TICK_S,
        0.8 * np.sign(speeds),
    )


# What counts.


def test_a_lasting_reversal_of_both_wheels_is_a_bounce():
    t, phi, torque = ticks((2, 10, 10), (0.3, 0, 0), (2, -10, -10), (0.3, 0, 0), (2, 10, 10))
    first, second = wall_hits.bounces(t, phi, torque)
    assert t[first] == pytest.approx(2.3, abs=0.2)
    assert t[second] == pytest.approx(4.6, abs=0.2)


@pytest.mark.parametrize(
    "phases",
    [
        [(2, 10, 10), (0.4, -10, -10), (2, 10, 10)],  # does not last
        [(2, 10, 10), (2, -10, 10)],  # turns on the spot
        [(2, 10, 10), (2, 0, -10)],
        [(2, 10, 10), (2, 0, 0)],
        [(2, 10, 10), (1, 0, 0), (2, 10, 10)],  # goes on as before
        [(2, 10, 10)],
        [(2, 0, 0)],
        [(0.1, 10, 10)],
    ],
)
def test_anything_else_is_none(phases):
    assert wall_hits.bounces(*ticks(*phases)) == []


def test_wheels_that_are_pushed_back_against_their_torque_have_not_bounced():
    t, phi, torque = ticks((2, 10, 10), (2, -10, -10))
    assert wall_hits.bounces(t, phi, np.abs(torque)) == []


@pytest.mark.parametrize(
    ("after", "ended"),
    [
        ((2, -10, -10), wall_hits.BOUNCED),
        ((2, 7, 7), wall_hits.SPUN),
        ((2, -10, 10), wall_hits.TURNED),
        ((2, 0, 10), wall_hits.ROUNDED),
        ((2, 0, 0), wall_hits.RESTED),
        ((2, 10, 10), wall_hits.NO_WALL),
    ],
)
def test_a_hit_is_classified_from_angles_and_torques_alone(after, ended):
    row = wall_hits.read_hit(*ticks((2, 10, 10), after))
    assert (row["ended"], row["reversed"]) == (ended, ended == wall_hits.BOUNCED)
    assert row == json.loads(json.dumps(row, allow_nan=False))


def test_a_bounces_row_has_its_torques_its_time_and_the_wheels_phases():
    t, phi, torque = ticks((2, 10, 10), (0.6, 0, 0), (2, -10, -10))
    row = wall_hits.read_hit(t, phi + [0.0, 2 * pi - 0.5], torque)
    assert row["before"] == pytest.approx(0.8)
    assert row["after"] == pytest.approx(-0.8)
    assert row["took_s"] == pytest.approx(0.75, abs=0.25)
    assert row["apart_rad"] == pytest.approx(-0.5)


# What is done.


def test_cells_are_plain_data_and_name_every_condition_once():
    for batch in (True, False):
        cells = wall.cells(SETTING.options, batch=batch)
        assert json.loads(json.dumps(cells)) == cells
        texts = [json.dumps(cell, sort_keys=True) for cell in cells]
        assert len(set(texts)) == len(texts)
    assert len(wall.cells({"bounces": 7, "k": 2.0}, batch=False)) == 7
    claimed = wall.cells({"bounces": 7, "k": 2.0}, batch=True)[0]
    assert (claimed["part"], claimed["k"], claimed["hits"]) == ("claim", 2.0, 7)


def test_walls_stand_at_all_phases_of_the_wheels():
    reach = [float(wall.world({**FLOOR, "hits": 8, "hit": hit})["walls"]) / 2 for hit in range(8)]
    phases = np.array(reach) / wall.WHEEL_RADIUS_M
    assert np.diff(phases) == pytest.approx(2 * pi / 8, rel=0.01)


def test_the_same_seed_is_the_same_robot_after_any_other_cell():
    cell = {**FLOOR, "hits": 3}
    first = wall.simulate(cell, SETTING)
    wall.simulate({**FLOOR, "k": 3.0, "hits": 1}, SETTING)
    assert wall.simulate(cell, SETTING) == first == json.loads(json.dumps(first, allow_nan=False))
    assert wall.simulate(cell, Setting(2, SETTING.options)) != first


def test_a_robot_over_a_link_does_as_the_simulation_does():
    cell = {**FLOOR, "hit": 0, "hits": 1, "grip": wall_rows.SMOOTH}
    options = "&".join(f"{name}={value}" for name, value in wall.world(cell).items())
    with connect("sim://?idle=1&" + options, seed=5) as robot:
        robot.set(k=0.0)
        robot.start()
        log = Log(robot.info())
        robot.add_tap(log)
        (row,) = wall.trial(cell, robot, log, SETTING)
    assert (row["ended"], row["reversed"]) == (wall_hits.SPUN, False)
    (same,) = wall.simulate({**cell, "hits": 1}, SETTING)
    assert row["before"] == pytest.approx(same["before"], rel=0.05)


def test_the_maps_cross_where_the_best_condition_is():
    for name, conditions in wall.MAPS.items():
        assert len({condition["axle"] for condition in conditions}) == len(wall.AXLES)
        along = {
            key for where in conditions for key in where if where[key] != wall_rows.ON_AXLES[key]
        }
        assert along == {"axle", name}


# What comes of it.


def test_on_a_rough_floor_most_hits_bounce_and_m_changes_its_sign():
    rows = wall.simulate({**FLOOR, "hits": 16}, SETTING)
    bounced = [row for row in rows if row["reversed"]]
    assert len(bounced) >= 8
    assert all(row["before"] > 0.5 and row["after"] < -0.5 for row in bounced)


def test_on_soft_axles_nearly_every_hit_bounces():
    """The blocked motor springs back on its axle. A rigid one reverses two of three hits."""
    rows = wall.simulate({**FLOOR, **wall_rows.ON_AXLES, "hits": 24}, SETTING)
    assert sum(row["reversed"] for row in rows) >= 22
    assert all(row["after"] < -0.5 for row in rows if row["reversed"])


def test_the_battery_of_a_condition_counts_before_that_of_the_run():
    """A weaker battery lets the wheels turn more slowly, so that M is greater."""
    cell = {**FLOOR, "hits": 1}
    weak = Setting(1, SETTING.options, battery_v=6.5)
    own, run = (wall.simulate(cell | volts, weak) for volts in ({"battery_v": 8.0}, {}))
    assert own[0]["before"] < run[0]["before"] - 0.01


def test_on_a_smooth_floor_the_tyres_spin_at_the_wall():
    rows = wall.simulate({**FLOOR, "grip": wall_rows.SMOOTH, "hits": 4}, SETTING)
    assert {row["ended"] for row in rows} == {wall_hits.SPUN}
    assert all(row["after"] > row["before"] > 0.5 for row in rows)


def test_a_series_shows_a_reversal_and_says_in_which_run():
    rows = wall.simulate({"part": "series", "k": 2.0, **wall_rows.PAPER}, SETTING)
    assert any(row["bounce"] for row in rows)
    assert {row["run"] for row in rows} == {1}


def rows_of(bounced, stuck, **fields):
    felt = {"hit": 0, "before": 0.8, "took_s": 1.0, "apart_rad": 0.1, **fields}
    good = {**felt, "ended": wall_hits.BOUNCED, "reversed": True, "after": -0.8}
    bad = {**felt, "ended": wall_hits.RESTED, "reversed": False, "after": 0.0, "took_s": None}
    return [good] * bounced + [bad] * stuck


@pytest.mark.parametrize(
    ("bounced", "stuck", "holds"),
    [(50, 0, True), (48, 2, True), (47, 3, False), (0, 50, False), (49, 0, None), (0, 0, None)],
)
def test_r13_holds_from_95_percent_on(bounced, stuck, holds):
    rows = rows_of(bounced, stuck, k=2.0)
    (claim,) = wall.report(rows, SETTING).claims
    assert (claim.id, claim.holds) == ("R13", holds)
    assert json.dumps(claim.as_dict(), allow_nan=False)
    if rows:
        assert f"{bounced} of {bounced + stuck}" in claim.note


def test_r13_is_undecided_for_another_motor():
    setting = Setting(1, SETTING.options, motor="nxt_unroller")
    (claim,) = wall.report(rows_of(0, 50, k=2.0), setting).claims
    assert claim.holds is None
    assert "made for motor = pybricks (here nxt_unroller)" in claim.note


def test_a_bounce_at_which_m_keeps_its_sign_speaks_against_the_claim():
    rows = rows_of(50, 0, k=2.0)
    assert not wall.report([{**row, "after": 0.1} for row in rows], SETTING).claims[0].holds


def test_hits_under_other_conditions_do_not_count_for_the_claim_but_are_named():
    rows = rows_of(50, 0, **FLOOR) + rows_of(0, 50, part="claim", **wall_rows.ON_SMOOTH)
    (claim,) = wall.report(rows, SETTING).claims
    assert claim.measured == 1.0
    assert "turns on at the wall: 0 of 50" in claim.note


def test_the_figure_is_drawn_from_a_robots_rows_and_from_simulated_ones():
    robots = rows_of(5, 2, k=2.0)
    assert len(draw(robots, wall.report(robots, SETTING)).axes) == 1
    series = [
        {
            "part": "series",
            **condition,
            "t_s": tick * TICK_S,
            **{side + "_torque": 0.8 for side in WHEELS},
            "bounce": tick == 9,
        }
        for condition in (wall_rows.PAPER, wall_rows.ON_AXLES)
        for tick in range(20)
    ]
    simulated = [*rows_of(5, 2, **FLOOR), *series]
    assert len(draw(simulated, wall.report(simulated, SETTING)).axes) == 5
