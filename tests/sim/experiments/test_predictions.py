"""The experiment `predictions`: kicks at random, predicted and given."""

import json

import numpy as np
import pytest

from host.experiments.robot.predictions import EDGES, bins, random_kick, report, score
from host.figures.robot.predictions import draw
from host.kicking.prediction import DELAYS
from host.perform.run import perform
from host.runs.contract import Setting
from robot.kick_requests import parse
from robot.kicks import MODES, WHEELS
from robot.params import Params

KICKS = len(MODES)
SETTING = Setting(1, {"kicks": KICKS})


def row(share, reverses, number=0, mode="phase"):
    """A wheel of which this share of 40 was predicted to reverse."""
    return {
        "kick": number,
        "mode": mode,
        "result": "reverses" if reverses else "continues",
        "reverses": round(40 * share),
        "of": 40,
    }


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("predictions")
    return folder, perform("predictions", kicks=KICKS, seed=3, out=folder)


def test_a_run_has_a_kick_of_each_mode_and_a_row_for_each_wheel(run):
    folder, summary = run
    assert summary["claims"] == []
    table = next(folder.glob("*/predictions.csv")).read_text().splitlines()
    names = table[0].split(",")
    rows = [dict(zip(names, line.split(","), strict=True)) for line in table[1:]]
    assert [(one["mode"], one["wheel"]) for one in rows] == [
        (mode, side) for mode in MODES for side in WHEELS
    ]
    assert {int(one["delay"]) for one in rows} <= set(DELAYS)
    assert next(folder.glob("*/*.png")).stat().st_size > 20_000


def test_predictions_beat_the_forecasts_that_know_less(run):
    """Ten wheels tell no more; docs/experiments.md has the calibration over 500 kicks."""
    scores = run[1]["numbers"]["scores"]
    assert set(scores) == {"all", *MODES}
    assert scores["membrane"] == {
        "wheels": 2,
        "reversed": 1.0,
        "brier": 0.0,
        "always": 0.0,
        "same": 0.0,
    }
    assert scores["all"]["brier"] < 0.5 * min(scores["all"]["always"], scores["all"]["same"])


def test_every_kick_at_random_is_one_that_the_robot_takes():
    rng = np.random.default_rng(0)
    kicks = [random_kick(number, rng) for number in range(300)]
    for kick in kicks:
        parse({"id": "k", **kick}, (1, -1), Params(), 0)
    assert {kick["mode"] for kick in kicks} == set(MODES)
    assert len({kick.get("ticks") for kick in kicks}) > 10


def test_the_brier_score_of_known_predictions():
    rows = [row(1.0, True), row(0.5, False), row(0.25, False), row(0.0, True)]
    found = score(rows)
    assert found["brier"] == pytest.approx((0 + 0.25 + 0.0625 + 1) / 4)
    assert (found["always"], found["same"]) == (0.5, 0.25)


def test_bins_say_where_predictions_do_not_come_true():
    right = [row(0.5, number % 2 == 0) for number in range(40)]
    wrong = [row(0.9, number % 2 == 0) for number in range(40)]
    sure = [row(1.0, True)] * 10 + [row(0.0, False)] * 10
    found = bins(right + wrong + sure)
    assert [(one["predicted"], one["wheels"], one["fits"]) for one in found] == [
        (0.0, 10, True),
        (0.5, 40, True),
        (pytest.approx(0.9), 40, False),
        (1.0, 10, True),
    ]
    assert len(bins([row(edge, True) for edge in EDGES])) <= len(EDGES)


def test_the_report_is_plain_data_and_its_figure_can_be_drawn():
    rows = [row(0.5, True, 0), row(0.5, False, 0), row(1.0, False, 1, "jump")]
    findings = report(rows, SETTING)
    numbers = findings.numbers
    assert json.loads(json.dumps(numbers, allow_nan=False)) == numbers
    assert (numbers["kicks"], numbers["reversed"], numbers["expected"]) == (2, 1, 2.0)
    assert numbers["spread"] == pytest.approx(0.5**0.5)
    assert numbers["in_words"].splitlines()[0] == (
        "2 kicks: 1 wheels reversed, predicted were 2 +- 1"
    )
    assert draw(rows, findings).get_size_inches()[0] * 160 == 1920
