"""The guided exercises: a simulated robot passes their checks, and one that cheats does not."""

import pytest

from host.lab.desk_robot import child_options
from host.lab.lessons.checks import CHECKS, check
from host.lab.lessons.texts import lessons
from host.logs.log import Log
from tests.lab.pupils import DO, WALLS, log_of

LESSONS = {lesson["name"]: lesson for lesson in lessons()}


@pytest.fixture(scope="module")
def logs():
    """A log of each exercise, done as it should be."""
    return {name: log_of(lesson) for name, lesson in LESSONS.items()}


def test_the_labs_own_robot_can_have_the_walls_of_the_exercise():
    words = ["--walls", "2", "--axle", "400", "--grip", "1.83", "--bumper", "0.25"]
    assert child_options(WALLS) == words


def failed(name, log):
    return [finding.words for finding in check(name, log) if not finding.ok]


def copied(log):
    """The same log, whose events may be changed."""
    copy = Log(log.info)
    for item in log.stream():
        if isinstance(item, dict):
            kick = {"kick": dict(item["kick"])} if item.get("kick") else {}
            copy.take_event({**item, **kick})
        else:
            copy.take_records([item])
    return copy


def test_each_exercise_has_a_check_and_one_right_answer():
    assert list(LESSONS) == list(CHECKS) == list(DO)
    for lesson in LESSONS.values():
        assert 0 <= lesson["right"] < len(lesson["answers"])
        assert lesson["hints"]


@pytest.mark.parametrize("name", LESSONS)
def test_who_does_an_exercise_passes(logs, name):
    assert failed(name, logs[name]) == []


@pytest.mark.parametrize("name", LESSONS)
def test_who_has_done_nothing_does_not_pass(name):
    assert failed(name, Log({}))


# While a hand turns a wheel, the motors are off, and tau matters to nothing.
@pytest.mark.parametrize("name", [name for name in LESSONS if name != "trace"])
def test_a_robot_with_another_tau_than_it_says_is_found_out(logs, name):
    log = copied(logs[name])
    log.events[0]["params"] = {**log.events[0]["params"], "tau_s": 0.4}
    assert "the robot did not do what its parameters" in failed(name, log)[0]


def test_a_robot_whose_kicks_are_swapped_is_found_out(logs):
    log = copied(logs["jump"])
    (_, one), (_, other) = log.kicks()
    for field in ("mode", "ticks", "pulse", "values"):
        one[field], other[field] = other[field], one[field]
    words = failed("jump", log)
    assert any("of a membrane kick the memory moved" in line for line in words)
    assert any("did not do what its parameters and kicks" in line for line in words)


def test_each_exercise_says_what_is_missing(logs):
    jump, start = logs["jump"], logs["start"]
    assert any("with the motors off" in words for words in failed("trace", jump))
    assert any("rolled: 1, needed: 10" in words for words in failed("start", jump))
    assert any("a membrane kick while" in words for words in failed("jump", start))
    assert any("an outcome: 1, needed: 10" in words for words in failed("longer", jump))
    assert any("you lowered k" in words for words in failed("there-and-back", jump))
    assert any("anything: 0, needed: 2" in words for words in failed("wall", start))


def test_kicks_that_do_not_fit_the_simulation_are_found_out(logs):
    log = copied(logs["longer"])
    for _, kick in log.kicks():  # those of 10 ticks were said to be shorter
        kick["ticks"] = {1: 10, 10: 5}.get(kick["ticks"], kick["ticks"])
    words = [finding.words for finding in CHECKS["longer"](log) if not finding.ok]
    assert len(words) == 1
    assert "but not here: 5 ticks should reverse" in words[0]


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"lesson": "\ud800"}, "there is no exercise"),
        ({"logs": []}, "a check needs 1 to"),
        ({"logs": ["x"] * 51}, "a check needs 1 to"),
        ({"logs": [7]}, "no log of this name"),
        ({"logs": ["../secret.mcap"]}, "no log of this name"),
    ],
)
def test_a_check_that_cannot_be_is_refused(lab, fields, words):
    asked = {"lesson": "jump", "logs": ["a.mcap"], **fields}
    assert words in lab.viewer().ask("check", **asked)["error"]["message"]
