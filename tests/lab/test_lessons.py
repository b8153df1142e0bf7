"""The guided exercises: a simulated robot passes their checks, and one that cheats does not."""

import pytest

from host.lab.desk_robot import child_options
from host.lab.lessons import checks, model, model_checks
from host.lab.lessons.texts import lessons
from host.logs.log import Log
from robot.kicks import WHEELS
from tests.lab.pupils import (
    DO,
    RUN,
    WALLS,
    copied,
    failed,
    log_of,
    runs_of,
    runs_with_another_tau,
    with_another_tau,
    with_swapped_kicks,
    with_swapped_runs,
)

LESSONS = {lesson["name"]: lesson for lesson in lessons()}
ROBOTS = [name for name in LESSONS if name not in RUN]


@pytest.fixture(scope="module")
def works():
    """What who does each exercise as it should be done leaves behind."""
    return {
        name: runs_of(lesson) if name in RUN else log_of(lesson) for name, lesson in LESSONS.items()
    }


def test_the_labs_own_robot_can_have_the_walls_of_the_exercise():
    words = ["--walls", "2", "--axle", "400", "--grip", "1.83", "--bumper", "0.25"]
    assert child_options(WALLS) == words


def test_each_exercise_has_a_check_and_one_right_answer():
    assert set(LESSONS) == {*checks.CHECKS, *model_checks.CHECKS} == {*DO, *RUN}
    assert set(RUN) == set(model.RUNS) == {name for name in LESSONS if "model" in LESSONS[name]}
    for lesson in LESSONS.values():
        assert 0 <= lesson["right"] < len(lesson["answers"])
        assert lesson["hints"]


def test_the_texts_have_the_numbers_of_the_theory():
    assert f"k = {model.exact_k():.2f}" in LESSONS["rest"]["explanation"]
    assert f"{model.exact_slope():.2f}" in LESSONS["twins"]["explanation"]
    assert abs(model.exact_slope() - 0.868) < 0.02  # that of thousands of wheels
    assert f"{model_checks.K_OFF:g} off" in LESSONS["rest"]["task"]
    assert f"{model_checks.SLOPE_OFF:g} off" in LESSONS["twins"]["task"]


@pytest.mark.parametrize("name", LESSONS)
def test_who_does_an_exercise_passes(works, name):
    assert failed(LESSONS[name], works[name]) == []


def test_a_check_counts_as_people_do():
    assert [checks._times(count) for count in (0, 1, 9)] == ["0 times", "once", "9 times"]


@pytest.mark.parametrize("name", LESSONS)
def test_who_has_done_nothing_does_not_pass(name):
    assert failed(LESSONS[name], ([], None) if name in RUN else Log({}))


# While a hand turns a wheel, the motors are off, and tau matters to nothing.
@pytest.mark.parametrize("name", [name for name in ROBOTS if name != "trace"])
def test_a_robot_with_another_tau_than_it_says_is_found_out(works, name):
    words = failed(LESSONS[name], with_another_tau(works[name]))
    assert "the robot did not do what its parameters" in words[0]


@pytest.mark.parametrize("name", RUN)
def test_a_model_wheel_with_another_tau_than_the_exercise_says_is_found_out(name):
    words = failed(LESSONS[name], runs_with_another_tau(LESSONS[name]))
    assert "run 1 is not what the model does" in words[-1]


def test_a_robot_whose_kicks_are_swapped_is_found_out(works):
    words = failed(LESSONS["jump"], with_swapped_kicks(works["jump"]))
    assert any("of a membrane kick the memory moved" in line for line in words)
    assert any("did not do what its parameters and kicks" in line for line in words)


@pytest.mark.parametrize("name", RUN)
def test_a_model_wheel_whose_runs_are_swapped_is_found_out(works, name):
    assert "not what the model does" in failed(LESSONS[name], with_swapped_runs(works[name]))[-1]


@pytest.mark.parametrize(("name", "off"), [("rest", 0.06), ("twins", 0.3)])
def test_an_own_number_that_is_off_does_not_pass_and_the_exact_one_stays_a_secret(works, name, off):
    runs, _ = works[name]
    exact = {"rest": model.exact_k, "twins": model.exact_slope}[name]()
    words = failed(LESSONS[name], (runs, exact + off))
    assert len(words) == 1
    assert "off the exact one" in words[0]
    assert f"{exact:.3f}" not in words[0]
    assert "missing" in failed(LESSONS[name], (runs, None))[0]


def test_a_robot_that_starts_straight_has_its_own_k_and_both_wheels_forward(works):
    log = works["wall"]
    assert [event["set"]["k"] for event in log.events if event["event"] == "params"] == [0.0, 2.0]
    turned = [log.column(f"{side}_phi_rad") for side in WHEELS]
    early = log.column("t_s") < log.column("t_s")[0] + 4.0
    left, right = (angles[early][-1] - angles[0] for angles in turned)
    assert left > 5.0
    assert abs(left - right) < 1.0


def test_each_exercise_says_what_is_missing(works):
    jump, start = works["jump"], works["start"]

    def failed_with(name, log):
        return failed(LESSONS[name], log)

    assert any("with the motors off" in words for words in failed_with("trace", jump))
    assert any("rolled: 1, needed: 10" in words for words in failed_with("start", jump))
    assert any("a membrane kick while" in words for words in failed_with("jump", start))
    assert any("an outcome: 1, needed: 10" in words for words in failed_with("longer", jump))
    assert any("you lowered k" in words for words in failed_with("there-and-back", jump))
    assert any("anything: 0, needed: 2" in words for words in failed_with("wall", start))


def test_kicks_that_do_not_fit_the_simulation_are_found_out(works):
    log = copied(works["longer"])
    for _, kick in log.kicks():  # those of 10 ticks were said to be shorter
        kick["ticks"] = {1: 10, 10: 5}.get(kick["ticks"], kick["ticks"])
    words = [finding.words for finding in checks.CHECKS["longer"](log) if not finding.ok]
    assert len(words) == 1
    assert "but not here: 5 ticks should reverse" in words[0]


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"lesson": "\ud800"}, "there is no exercise"),
        ({"lesson": "rest", "runs": None}, "a check takes up to 50 runs"),
        ({"lesson": "rest", "runs": [{"value": 1.5}]}, "a run is not as the model gave it"),
        ({"lesson": "rest", "runs": [{"value": 9, "seen": [1, 1]}]}, "not possible here"),
        ({"lesson": "rest", "runs": [], "own": "x"}, "this is no number"),
        ({"logs": []}, "a check needs 1 to"),
        ({"logs": ["x"] * 51}, "a check needs 1 to"),
        ({"logs": [7]}, "no log of this name"),
        ({"logs": ["../secret.mcap"]}, "no log of this name"),
    ],
)
def test_a_check_that_cannot_be_is_refused(lab, fields, words):
    asked = {"lesson": "jump", "logs": ["a.mcap"], **fields}
    assert words in lab.viewer().ask("check", **asked)["error"]["message"]


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"lesson": "jump", "value": 1.5}, "'jump' has no model wheel"),
        ({"lesson": "rest", "value": 1.39}, "not possible here"),
        ({"lesson": "rest", "value": True}, "this is no number"),
        ({"lesson": "rest", "value": 1.5}, "this lab checks no exercises"),
    ],
)
def test_a_run_of_the_model_that_cannot_be_is_refused(lab, fields, words):
    assert words in lab.viewer().ask("model", **fields)["error"]["message"]


def test_a_page_waits_for_one_answer_at_a_time(lab):
    class Slow:
        def ask(self, work, question, done):
            self.done = done

    class Pages:
        def call(self, function):
            function()

    lab.session.marking.worker = slow = Slow()
    lab.anna.pages = Pages()
    page = lab.viewer()
    assert page.ask("model", lesson="rest", value=1.5) is None
    assert "waits for an answer" in page.ask("model", lesson="rest", value=1.5)["error"]["message"]
    slow.done({"t_s": []})
    assert page.latest("reply")["result"] == {"t_s": []}
    page.ask("model", lesson="rest", value=1.5)
    slow.done({"t_s": [1]})
    assert page.latest("reply")["result"] == {"t_s": [1]}
