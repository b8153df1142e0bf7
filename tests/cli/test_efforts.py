"""kickctl experiment --minutes, --quick and --yes."""

import argparse
import io
import json

import pytest

from host.commands._efforts import question
from host.errors import NotDone
from host.experiments.efforts import EFFORTS, Effort
from host.perform.run import perform
from tests.cli.test_experiment import COUNT, desk, toy

__all__ = ["desk", "toy"]  # fixtures


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def answer(monkeypatch):
    """A function that has a person at a terminal answer a text, and returns what was said."""

    def ask(text, seconds=120.0, *, yes=False, out=Terminal, into=Terminal):
        shown = out()
        monkeypatch.setattr("sys.stdin", into(text))
        monkeypatch.setattr("sys.stderr", shown)
        question(argparse.Namespace(yes=yes))(seconds)
        return shown.getvalue()

    return ask


@pytest.mark.parametrize("text", ["\n", "y\n", "Yes\n", " y \n"])
def test_a_long_run_starts_when_a_person_agrees(answer, text):
    assert answer(text) == "The robot will be busy for 2 minutes. Start? [Y/n]\n"


@pytest.mark.parametrize("text", ["n\n", "no\n", "never mind\n", ""])
def test_anything_else_and_an_end_of_input_start_nothing(answer, text):
    with pytest.raises(NotDone, match="not started") as refusal:
        answer(text)
    assert "--yes" in refusal.value.hint


@pytest.mark.parametrize(
    "options",
    [
        {"seconds": 60.0},
        {"yes": True},
        {"out": io.StringIO},
        {"into": io.StringIO},
    ],
)
def test_nobody_is_asked_about_a_short_run_or_without_a_terminal_or_with_yes(answer, options):
    assert answer("n\n", **options) == ""


def test_minutes_choose_the_trials(kickctl):
    status, out, err = kickctl("experiment", "starts", "--minutes", "0.2", "--json")
    assert status == 0, err
    assert json.loads(out)["numbers"]["starts"] == 3


def test_an_own_option_called_minutes_stays_what_it_was(kickctl):
    assert "length of the series" in kickctl("experiment", "chaos", "--help")[1]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("starts", "--minutes", "3", "--starts", "100"), "--minutes chooses --starts"),
        (("starts", "--quick", "--starts", "5"), "--quick chooses --starts"),
        (("chaos", "--quick", "--minutes", "5"), "--quick chooses --minutes"),
        (("starts", "--quick", "--minutes", "5"), "not allowed with"),
        (("bifurcation", "--minutes", "7"), "points = 5 takes 7 minutes on a robot"),
        (
            ("bifurcation", "--minutes", "10", "--rounds", "3"),
            "points = 5 takes 19 minutes on a robot",
        ),
        (("starts", "--minutes", "0"), "--minutes"),
        (("starts", "--minutes", "0.01"), "starts = 1 takes 5 s on a robot"),
        (("starts", "--minutes", "2,5"), "cannot be '2,5'"),
        (("starts", "--minutes", "-3"), "minutes"),
        (("starts", "--minutes", "nan"), "minutes"),
        (("starts", "--minutes", "inf"), "minutes"),
        (("train-wall", "--minutes", "3"), "--minutes"),
        (("starts", "--starts", "0"), "starts cannot be 0"),
    ],
)
def test_wrong_use_is_refused_in_words(kickctl, arguments, words):
    status, out, err = kickctl("experiment", *arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


# The time that a real robot needs.


def test_on_a_robot_the_time_that_is_left_is_said_and_asked_about_before_anything_moves(
    toy, desk, tmp_path, monkeypatch
):
    monkeypatch.setitem(EFFORTS, "toy", Effort("cells", 50.0))
    said = []
    asked = []

    def refuse(seconds):
        asked.append(seconds)
        raise NotDone("not started")

    def ask_and_run(**options):
        return perform("toy", desk[0], out=tmp_path, say=said.append, **options)

    with pytest.raises(NotDone):
        ask_and_run(ask=refuse)
    assert asked == [50.0 * COUNT]
    assert "toy: about 5 minutes on this robot" in said
    assert toy.done == []
    toy.trouble = {2: [KeyboardInterrupt()]}
    with pytest.raises(KeyboardInterrupt):
        ask_and_run()
    with pytest.raises(NotDone):
        ask_and_run(ask=refuse)
    assert asked[1:] == [50.0 * (COUNT - 2)]  # two cells are complete
    assert ask_and_run(ask=asked.append)["trials"] == COUNT
    assert ask_and_run(ask=refuse)["trials"] == COUNT  # nothing is left to be done


def test_nobody_is_asked_about_a_simulated_robot(toy, tmp_path, monkeypatch):
    monkeypatch.setitem(EFFORTS, "toy", Effort("cells", 5000.0))
    said = []
    perform("toy", "sim://", out=tmp_path, say=said.append, ask=said.append)
    assert not [words for words in said if "on this robot" in str(words) or words == 30000.0]
