"""The chaotic mode (R14): switches and exponents of known series, and what simulated wheels do."""

import json
from math import log, pi

import numpy as np
import pytest

from host.client.robot import connect
from host.errors import NotDone
from host.experiments.robot import chaos, chaos_pieces
from host.experiments.robot.chaos_numbers import APART_S, growth
from host.experiments.robot.switching import (
    CONDITIONS,
    DELAYED,
    OLDER,
    ORDINARY,
    RESTS,
    ROLLS,
    SWITCHES,
    Jump,
    ending,
    switches,
    wheels_run,
)
from host.figures.robot.chaos import draw
from host.logs.log import Log
from host.runs.contract import Setting
from host.theory.analysis import series_exponents
from host.theory.analysis.series_exponents import from_series, from_twins, of_noise
from robot.controller import motor_torque
from robot.params import Params
from sim_motor.batch import CHANNELS

SETTING = Setting(3, {"minutes": 2.5})
PHI, X1, FORCE, TORQUE = (CHANNELS.index(name) for name in ("phi_rad", "x1", "force", "torque"))
MODE = {"k": chaos_pieces.K, "tau_s": chaos_pieces.TAU_S}


def runs(name, wheels, seconds, seed=1, jump=None, **changes):
    params = {**MODE, **changes}
    records = wheels_run(CONDITIONS[name], SETTING, wheels, seconds, seed, jump, **params)
    return np.concatenate(list(records))


def with_fields(rows, **fields):
    return [{**fields, **row} for row in rows]


@pytest.fixture(scope="module")
def delayed():
    """Two wheels that switch irregularly."""
    return runs(DELAYED, 2, 150.0)


def test_the_exponent_of_the_logistic_map_is_ln_2():
    values = [0.3]
    while len(values) < 3000:
        values.append(4 * values[-1] * (1 - values[-1]))
    exponent, embedded = from_series(np.array(values), 1.0, 2.0, (0.0, 4.0))
    assert embedded.dimension == 1
    assert exponent.rate == pytest.approx(log(2), rel=0.01)


def test_the_exponent_of_the_henon_map_is_the_known_one():
    x, y = 0.1, 0.1
    values = []
    for _ in range(4000):
        x, y = 1 - 1.4 * x * x + y, 0.3 * x
        values.append(x)
    exponent, embedded = from_series(np.array(values), 1.0, 2.0, (1.0, 7.0))
    assert embedded.dimension == 2
    assert exponent.rate == pytest.approx(0.419, rel=0.05)


def test_a_noisy_rhythm_has_no_greater_exponent_than_noise_makes():
    rng = np.random.default_rng(0)
    phase = np.cumsum(0.2 + 0.01 * rng.standard_normal(8000))
    exponent, _ = from_series(3 * np.sin(phase) + 0.01 * rng.standard_normal(8000), 0.03, 2.0)
    assert exponent.interval[0] < of_noise()


@pytest.mark.parametrize(
    "values", [np.zeros(9000), np.sin(np.arange(300.0))], ids=["still", "short"]
)
def test_no_exponent_is_made_up_where_there_is_nothing_to_estimate(values):
    assert from_series(values, 0.03, 2.0) is None


def test_a_neighbour_is_the_nearest_state_of_another_passage():
    """Most of a slow walk's nearest states belong to the same passage."""
    states = np.random.default_rng(0).standard_normal((400, 2)).cumsum(axis=0)
    number = np.arange(len(states))
    away = np.linalg.norm(states[:, None] - states, axis=2)
    away[abs(number[:, None] - number) <= 40] = np.inf
    rows, others, distances = series_exponents._neighbours(states, 40)
    assert len(rows) == 400
    assert np.array_equal(others, away.argmin(axis=1))
    assert distances == pytest.approx(away.min(axis=1))


def test_twins_that_double_in_a_second_part_at_ln_2():
    first = np.array([1e-3, 2e-3, 4e-3])
    assert from_twins(first, 4 * first, 2.0).rate == pytest.approx(log(2))


def test_a_wheel_turns_around_where_its_angle_is_greatest_or_least():
    phi = np.concatenate(
        [np.linspace(0, 9, 61), np.linspace(9, 2, 50)[1:], np.linspace(2, 12, 70)[1:]]
    )
    assert switches(phi).tolist() == [60, 109]


def test_a_wheel_that_chatters_by_two_degrees_at_rest_does_not_switch():
    assert len(switches(np.tile([0.0, 2 * pi / 180], 100))) == 0


@pytest.mark.parametrize(
    ("after", "expected"),
    [
        (np.zeros(1200), RESTS),
        (np.arange(1200) * 0.3, ROLLS),
        (np.abs(np.arange(1200) % 100 - 50) * 0.3, SWITCHES),
    ],
    ids=[RESTS, ROLLS, SWITCHES],
)
def test_what_a_wheel_does_in_the_end_is_classified(after, expected):
    swing = np.abs(np.arange(200) % 100 - 50) * 0.3
    until_s, end = ending(np.concatenate([swing, swing[-1] + after - after[0]]), 0.03)
    assert end == expected
    assert (until_s > 30.0) == (expected == SWITCHES)


@pytest.mark.parametrize("name", [ORDINARY, DELAYED, OLDER])
def test_twins_are_the_same_up_to_the_jump_and_not_after_it(name):
    plain, other = (runs(name, 4, 10.0, jump=jump) for jump in (None, Jump(100, 1e-3)))
    assert np.array_equal(plain[:, :100], other[:, :100])
    assert plain.shape == (4, 333, len(CHANNELS))
    assert np.all(plain[:, 100, X1] < other[:, 100, X1])
    assert np.allclose(plain[:, 100, X1] + 1e-3, other[:, 100, X1], atol=1e-4)


def test_records_of_the_whole_loop_have_their_channels_in_the_batchs_order(delayed):
    for record in delayed[:, ::50].reshape(-1, len(CHANNELS)):
        assert motor_torque(record[FORCE]) == record[TORQUE]


def test_the_brick_as_it_is_stops_switching_within_a_minute():
    ends = [ending(phi, Params().tick_s) for phi in runs(ORDINARY, 40, 90.0)[:, :, PHI]]
    assert sum(end == SWITCHES for _, end in ends) == 0
    assert max(until_s for until_s, _ in ends) > 4.0  # chaos there is, but it does not last


def test_wheels_on_bodies_whose_rods_are_older_go_on_switching():
    """All of them, and their exponents are above that of noise; without the lag they do not."""
    tick_s = Params().tick_s
    for record in runs(OLDER, 8, 300.0):
        assert ending(record[:, PHI], tick_s)[1] == SWITCHES
        exponent, _ = from_series(record[:, FORCE], tick_s, APART_S)
        assert exponent.interval[0] > of_noise()
    ends = [ending(phi, tick_s)[1] for phi in runs("on one body", 20, 90.0)[:, :, PHI]]
    assert ends == [ROLLS] * 20


def test_a_wheel_alone_may_rest_for_good_where_its_reading_is_a_multiple_of_45_degrees():
    """There M is 0 once the neurons have followed it. On a body the other wheel frees it."""
    alone = runs(f"{OLDER}, wheels alone", 40, 300.0)
    resting = [record for record in alone if ending(record[:, PHI], 0.03)[1] == RESTS]
    assert len(resting) > 5
    for record in resting:
        assert round(record[-1, PHI] * 180 / pi) % 45 == 0
        assert abs(record[-1, TORQUE]) < 0.01


def test_with_a_longer_latency_wheels_go_on_switching_and_their_exponent_is_positive(delayed):
    for record in delayed:
        assert ending(record[:, PHI], Params().tick_s)[1] == SWITCHES
        exponent, _ = from_series(record[:, FORCE], Params().tick_s, APART_S)
        assert exponent.interval[0] > of_noise()


def test_twins_part_with_the_latency_and_a_jump_below_the_steps_dies_with_tau(monkeypatch):
    monkeypatch.setattr(chaos_pieces, "TWIN_PAIRS", 24)
    cell = {"part": "twins", "condition": DELAYED}
    seen = growth(chaos.simulate({**cell, "jump": chaos_pieces.SEEN}, SETTING))
    unseen = growth(chaos.simulate({**cell, "jump": chaos_pieces.UNSEEN}, SETTING))
    assert seen.interval[0] > 0.5
    assert unseen.rate == pytest.approx(-1 / chaos_pieces.TAU_S, abs=0.05)


def test_it_is_the_bound_of_the_torque_that_ends_the_chaos_of_the_papers_model():
    cell = {"part": "model", "wheel": "paper"}
    free = chaos.simulate({**cell, "bounded": False}, SETTING)
    bounded = chaos.simulate({**cell, "bounded": True}, SETTING)
    assert {row["end"] for row in free} == {SWITCHES}
    assert {row["end"] for row in bounded} == {ROLLS}


def test_a_piece_done_again_has_the_same_rows_and_they_survive_json():
    for cell in (
        {"part": "map", "rod_lag_s": 0.0075, "battery_v": 7.5},
        {"part": "speed", "condition": ORDINARY},
    ):
        rows = chaos.simulate(cell, SETTING)
        assert (
            rows == chaos.simulate(cell, SETTING) == json.loads(json.dumps(rows, allow_nan=False))
        )


def series_rows(records):
    """Both wheels of a robot."""
    return [
        {
            "part": "series",
            "condition": ORDINARY,
            "side": side,
            "t_s": 0.03 * tick,
            "phi_rad": phi,
            "force": force,
            "torque": torque,
        }
        for side, record in zip(("left", "right"), records, strict=True)
        for tick, (phi, force, torque) in enumerate(record[:, [PHI, FORCE, TORQUE]].tolist())
    ]


def test_r14_holds_for_a_robot_whose_wheels_switch_irregularly(delayed):
    rows = series_rows(delayed)
    findings = chaos.report(rows, Setting(3, {"minutes": 10.0}))
    (claim,) = findings.claims
    assert (claim.id, claim.measured, claim.holds) == ("R14", 1.0, True)
    (claim,) = chaos.report(rows, SETTING).claims
    assert (claim.measured, claim.holds) == (1.0, None)
    assert "minutes = 10 or more (here 2.5)" in claim.note
    panels = [axes.get_label() for axes in draw(rows, findings).axes]
    assert panels == ["torque-1", "torque-2", "model", "return-map", "intervals"]


def test_a_median_is_said_to_be_later_where_half_of_the_wheels_switch_to_the_end(delayed):
    findings = chaos.report(series_rows(delayed), SETTING)
    until = next(one for one in findings.answers if one.name.startswith("half of them"))
    assert until.name == "half of them switch for more than"
    assert f"for more than {until.value:.1f} s" in findings.claims[0].note


def test_r14_does_not_hold_for_a_robot_that_rolls_nor_for_one_that_rolls_to_and_fro_evenly(delayed):
    for records in (runs(ORDINARY, 2, 150.0), np.stack([_even(delayed[0])] * 2)):
        (claim,) = chaos.report(series_rows(records), Setting(3, {"minutes": 10.0})).claims
        assert claim.holds is False


def _even(record):
    """A wheel to and fro, like clockwork but for a late tick now and then."""
    time_s = 0.03 * np.arange(len(record)) + 0.001 * np.random.default_rng(0).standard_exponential(
        len(record)
    )
    even = record.copy()
    even[:, PHI] = np.round(180 / pi * 3 * np.sin(4 * time_s)) * pi / 180
    even[:, FORCE] = 8 * np.sin(4 * time_s + 1)
    return even


def test_all_pieces_together_judge_the_brick_as_it_is_and_say_where_it_would_hold(monkeypatch):
    monkeypatch.setattr(chaos, "LAGS_S", (0.0, 0.0075))
    monkeypatch.setattr(chaos, "VOLTAGES_V", (7.5,))
    monkeypatch.setattr(chaos_pieces, "LIVES_WHEELS", 6)
    monkeypatch.setattr(chaos_pieces, "LIVES_WHEELS_OTHERS", 2)
    monkeypatch.setattr(chaos_pieces, "LIVES_WHEELS_DELAYED", 2)
    monkeypatch.setattr(chaos_pieces, "TWIN_PAIRS", 4)
    setting = Setting(1, {"minutes": 1.0})
    rows = [
        row
        for cell in chaos.cells(setting.options, batch=True)
        for row in with_fields(chaos.simulate(cell, setting), **cell)
    ]
    findings = chaos.report(rows, setting)
    (claim,) = findings.claims
    assert claim.holds is None  # one minute
    assert claim.measured == 0.0
    assert (
        f"with {OLDER} than the angle in F_tan, and both wheels on one body, 6 of 6" in claim.note
    )
    assert DELAYED in claim.note
    assert "100 %, 9 V" in claim.note
    lagged, own = (
        [place["chaotic"] for place in findings.numbers["map"] if place["rod_lag_s"] == lag_s]
        for lag_s in (0.0075, 0.0)
    )
    assert (lagged, own) == ([chaos_pieces.MAP_WHEELS], [0])
    json.dumps(findings.numbers, allow_nan=False)
    panels = [axes.get_label() for axes in draw(rows, findings).axes]
    assert panels[:3] == ["torque-1", "torque-2", "model"]
    assert panels[3:-1] == ["return-map", "lives", "twins", "map"]  # the last is a colour bar
    paper = [
        row
        for row in rows
        if row.get("condition") == OLDER and row.get("jump") != chaos_pieces.UNSEEN
    ]
    panels = [axes.get_label() for axes in draw(paper, findings).axes]
    assert panels == ["torque-1", "model", "return-map", "intervals", "lives", "twins"]


def test_a_robot_gives_both_wheels_from_its_start():
    setting = Setting(1, {"minutes": 0.1})
    with connect("sim://", 1) as robot:
        log = Log()
        robot.add_tap(log)
        rows = chaos.trial({"part": "series", "condition": ORDINARY}, robot, log, setting)
    left, right = ([row for row in rows if row["side"] == side] for side in ("left", "right"))
    assert left[0]["t_s"] == right[0]["t_s"] == 0.0
    assert 6.0 <= left[-1]["t_s"] < 6.1
    assert len(left) == len(right) == round(left[-1]["t_s"] / Params().tick_s) + 1


def test_a_stop_in_between_is_reported():
    with connect("sim://", 1) as robot:
        log = Log()
        robot.add_tap(log)
        wait = robot.wait

        def stopped_meanwhile(seconds, until=None):
            wait(1.0)
            robot.stop()
            return wait(seconds, until)

        robot.wait = stopped_meanwhile
        with pytest.raises(NotDone, match="does not run"):
            chaos.trial(
                {"part": "series", "condition": ORDINARY}, robot, log, Setting(1, {"minutes": 10.0})
            )
        assert log.seconds < 5.0
