"""Predictions come from a process of their own, and its end is no end of the lab."""

from multiprocessing import active_children

import pytest

from host.errors import KickctlError
from host.lab.forecasts import MOST_WAITING, Forecasts, Question
from robot.params import Params
from robot.record import Record
from sim_motor.constants import load
from tests.lab.live import Answers

TICK_S = 0.03


def question(**kick):
    """A robot whose wheels roll evenly, as far as its records say."""
    blank = Record(*([0] * len(Record._fields)))._replace(state=1)
    records = [
        blank._replace(
            tick=tick,
            t_s=TICK_S * tick,
            left_phi_rad=0.35 * tick,
            right_phi_rad=0.35 * tick,
            left_duty_pct=80,
            right_duty_pct=80,
            left_x1=0.3,
            right_x1=0.3,
        )
        for tick in range(50)
    ]
    return Question(records, Params().values(), kick, load(), None)


@pytest.fixture(scope="module")
def forecasts():
    forecasts = Forecasts()
    yield forecasts
    forecasts.close()
    assert not active_children()
    answers = Answers()
    forecasts.ask(question(mode="phase"), answers)
    assert isinstance(answers.next(), KickctlError)


def test_a_question_is_answered_and_a_wrong_one_in_words(forecasts):
    answers = Answers()
    forecasts.ask(question(mode="membrane"), answers)
    forecasts.ask(question(mode="fly"), answers)
    found = answers.next()
    assert all(sum(shares.values()) == found["of"] for shares in found["shares"].values())
    assert "fly" in answers.next().message


def test_a_failure_of_the_simulation_is_an_answer_too(forecasts):
    answers = Answers()
    forecasts.ask(question(mode="membrane")._replace(motor=None), answers)
    assert "the simulation failed" in answers.next().message
    forecasts.ask(question(mode="membrane")._replace(params=(one for one in ())), answers)
    assert "the simulation failed" in answers.next().message
    forecasts.ask(question(mode="fly"), answers)
    assert "fly" in answers.next().message


def test_too_many_questions_are_refused_at_once(forecasts):
    answers = Answers()
    for _ in range(MOST_WAITING + 1):
        forecasts.ask(question(mode="membrane"), answers)
    assert "too much" in answers.next().message
    assert all("of" in answers.next() for _ in range(MOST_WAITING))


def test_a_process_that_dies_is_replaced(forecasts):
    forecasts.begin()
    for process in active_children():
        process.kill()
        process.join()
    answers = Answers()
    forecasts.ask(question(mode="fly"), answers)
    assert isinstance(answers.next(), KickctlError)
    forecasts.ask(question(mode="fly"), answers)
    assert "fly" in answers.next().message
