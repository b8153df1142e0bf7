"""The experiment `starts`: which way robots go from rest, and what decides it."""

import json
from fractions import Fraction
from math import comb, radians

import pytest

from host.client.robot import connect
from host.experiments.robot import starts
from host.figures.robot.starts import draw
from host.logs.log import Log
from host.perform.run import perform
from host.runs.contract import Setting
from host.util.intervals import fair_p, wilson
from robot.kicks import WHEELS
from sim_motor.motor import ANGLE, LAST_ANGLE

SETTING = Setting(1, {"starts": 12})


def start(cell, **changes):
    """A cell's rows with its fields, of a new simulated robot."""
    with connect("sim://", SETTING.seed_of(cell)) as robot:
        if changes:
            robot.set(**changes)
        log = Log(robot.info())
        robot.add_tap(log)
        return [{**cell, **row} for row in starts.trial(cell, robot, log, SETTING)]


@pytest.fixture(scope="module")
def rows():
    return [row for cell in starts.cells(SETTING.options, batch=False) for row in start(cell)]


def row(number, wheel, direction, ahead_deg=90.0):
    return {
        "start": number,
        "wheel": wheel,
        "phi_deg": 0.0,
        "ahead_deg": ahead_deg,
        "direction": direction,
    }


def test_wheels_go_both_ways_and_away_from_the_angle_that_they_remember(rows):
    assert [(one["start"], one["wheel"]) for one in rows] == [
        (number, side) for number in range(12) for side in WHEELS
    ]
    numbers = starts.report(rows, SETTING).numbers
    assert numbers["both"]["forward"] >= 4
    assert numbers["both"]["backward"] >= 4
    for one in rows:
        assert 0 <= one["phi_deg"] < 360
        assert -180 <= one["ahead_deg"] <= 180
        if one["direction"] and 20 < abs(one["ahead_deg"]) < 140:
            assert one["direction"] == (1 if one["ahead_deg"] > 0 else -1)


def test_the_same_seed_gives_the_same_starts_and_another_seed_others(rows):
    assert start({"start": 3}) == rows[6:8]
    assert len({(one["phi_deg"], one["ahead_deg"]) for one in rows}) == len(rows)


@pytest.mark.parametrize("angle_deg", [0, 45, 90, 225])
@pytest.mark.parametrize(("offset", "directions"), [(0.0, [0, 0]), (0.5, [-1, -1]), (-0.5, [1, 1])])
def test_a_robot_exactly_at_a_fixed_point_stays_there_and_one_beside_it_goes(
    angle_deg, offset, directions
):
    with connect("sim://?idle=1", 1) as robot:
        for motor in robot.link.brick.motors:
            motor.state[ANGLE] = motor.state[LAST_ANGLE] = radians(angle_deg + 0.5)
        # Instead of angles at random, the neurons remember that of the wheels, or nearly so.
        remembered = radians(angle_deg) + offset
        robot.link.loop._random_angle = lambda: remembered
        log = Log(robot.info())
        robot.add_tap(log)
        rows = starts.trial({"start": 0}, robot, log, SETTING)
    assert [one["phi_deg"] for one in rows] == [angle_deg, angle_deg]
    assert [one["direction"] for one in rows] == directions


def test_a_wheel_that_never_settles_is_counted_apart(monkeypatch):
    monkeypatch.setattr(starts, "wait_settled", lambda robot: False)
    assert [one["direction"] for one in start({"start": 0})] == [None, None]


def test_the_counts_of_each_wheel():
    rows = [
        *(row(number, "left", 1) for number in range(8)),
        *(row(number, "left", -1) for number in (8, 9)),
        *(
            row(number, "right", way, -90.0)
            for number, way in enumerate([1, -1, 0, None] + [-1] * 6)
        ),
    ]
    findings = starts.report(rows, SETTING)
    numbers = findings.numbers
    assert findings.claims == []
    assert (numbers["starts"], numbers["same_way"]) == (10, 3)
    assert numbers["left"] == {
        "forward": 8,
        "backward": 2,
        "rest": 0,
        "unsettled": 0,
        "forward_share": 0.8,
        "interval": list(wilson(8, 10)),
        "p": pytest.approx(0.109375),
    }
    right = numbers["right"]
    assert [right[kind] for kind in ("forward", "backward", "rest", "unsettled")] == [1, 7, 1, 1]
    assert numbers["as_pushed"] == pytest.approx(15 / 18)
    words = numbers["in_words"].splitlines()
    assert words[:2] == [
        "left wheel: 8 forward, 2 backward",
        (
            "  the share of forward is 80 % (95 % interval 49 to 94 %); a fair coin is as uneven as"
            " this, or more, in 11 % of all tries"
        ),
    ]
    assert words[2] == "right wheel: 1 forward, 7 backward, 1 at rest, 1 not settled"
    assert words[-1] == "both wheels went the same way in 3 of 10 starts"
    assert json.loads(json.dumps(numbers, allow_nan=False)) == numbers


def test_of_wheels_that_all_rest_there_is_no_share():
    numbers = starts.report([row(0, "left", 0), row(0, "right", 0)], SETTING).numbers
    assert (numbers["left"]["forward_share"], numbers["left"]["p"]) == (None, 1.0)
    assert numbers["in_words"] == (
        "left wheel: 0 forward, 0 backward, 1 at rest\n"
        "right wheel: 0 forward, 0 backward, 1 at rest\n"
        "both wheels went the same way in 0 of 1 starts"
    )


@pytest.mark.parametrize("trials", [1, 2, 7, 20])
def test_the_test_against_a_half_is_exact(trials):
    weights = [Fraction(comb(trials, count), 2**trials) for count in range(trials + 1)]
    for successes in range(trials + 1):
        as_uneven = sum(weight for weight in weights if weight <= weights[successes])
        assert fair_p(successes, trials) == pytest.approx(float(as_uneven))
        assert fair_p(successes, trials) == fair_p(trials - successes, trials)


def test_the_test_against_a_half_bears_no_trials_and_many():
    assert fair_p(0, 0) == 1.0
    assert fair_p(50_000, 100_000) == 1.0
    assert 0.0 <= fair_p(40_000, 100_000) < 1e-300


def test_a_run_ends_with_a_table_a_figure_and_no_claims(tmp_path):
    summary = perform("starts", starts=3, seed=2, out=tmp_path)
    assert summary["claims"] == []
    assert summary["numbers"]["starts"] == 3
    table = next(tmp_path.glob("*/starts.csv")).read_text().splitlines()
    assert table[0].split(",") == ["start", "wheel", "phi_deg", "ahead_deg", "direction"]
    assert len(table) == 7
    assert next(tmp_path.glob("*/*.png")).stat().st_size > 20_000


def test_the_figure_bears_rows_of_one_start_and_of_wheels_that_rest():
    rows = [row(0, "left", 0), row(0, "right", None)]
    assert draw(rows, starts.report(rows, SETTING)).get_size_inches()[0] * 160 == 1920
