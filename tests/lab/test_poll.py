"""What a class expects of a kick: hidden until it runs, then it holds, and is counted."""

import pytest

from host.errors import RefusedByRobot

KICK = {"mode": "phase", "ticks": 4, "wheel": "both"}
DO = {"robot": "anna", "command": "kick", "arguments": {**KICK, "guess": None}}


def outcome(lab, result, before="forward", after="backward"):
    """Let the latest kick of anna have an outcome."""
    kicks = [arguments for command, arguments in lab.anna.told if command == "kick"]
    message = {"type": "outcome", "robot": "anna", "kick_id": kicks[-1]["id"]}
    sides = ("left", "right")
    ways = {"before": dict.fromkeys(sides, before), "after": dict.fromkeys(sides, after)}
    lab.session.hear({**message, **ways, "result": dict.fromkeys(sides, result)})


@pytest.fixture
def teacher(lab):
    return lab.driver()


@pytest.fixture
def pupils(lab):
    return [lab.viewer(local=False) for _ in range(30)]


def poll(lab, visit, *awake):
    lab.wait(0.1, *awake)
    return visit.latest("poll")


def test_thirty_pupils_answer_and_see_after_the_kick_who_was_right(lab, teacher, pupils):
    assert "result" in teacher.ask("poll", robot="anna", kick=KICK)
    for number, pupil in enumerate(pupils):
        guess = "continues" if number < 12 else "reverses"
        assert "result" in pupil.ask("answer", guess=guess)
    assert "result" in pupils[0].ask("answer", guess="reverses")  # a pupil may change it
    seen = poll(lab, pupils[0], teacher)
    assert (seen["state"], seen["answered"], seen["of"]) == ("open", 30, 30)
    assert (seen["yours"], seen["counts"], seen["kick"]) == ("reverses", None, KICK)

    teacher.send("do", request=9, **DO)
    assert "no question is open" in pupils[1].ask("answer", guess="stops")["error"]["message"]
    seen = poll(lab, pupils[1], teacher)
    assert (seen["state"], seen["yours"]) == ("locked", "continues")
    assert seen["counts"] == {"reverses": 19, "continues": 11, "stops": 0}

    outcome(lab, "reverses")
    seen = poll(lab, teacher, teacher)
    assert (seen["state"], seen["right"], seen["yours"]) == ("done", ["reverses"], None)
    assert seen["score"] == {"kicks": 1, "majority": 1, "answers": 30, "right": 19}
    assert lab.viewer().latest("poll") == {**seen, "of": 31}  # who comes later sees it, too


def test_only_the_kick_that_was_asked_about_locks_the_answers(lab, teacher, pupils):
    teacher.send("poll", request=1, robot="anna", kick=KICK)
    pupils[0].send("answer", request=1, guess="stops")
    for other in ({"robot": "bert"}, {"arguments": {**KICK, "ticks": 5}}, {"command": "start"}):
        teacher.send("do", request=2, **(DO | other))
        assert poll(lab, teacher, teacher)["state"] == "open"
    teacher.send("do", request=3, **DO)
    assert poll(lab, teacher, teacher)["state"] == "locked"
    teacher.send("do", request=4, **DO)  # before there is an outcome
    seen = poll(lab, teacher, teacher)
    assert (seen["state"], seen["outcome"]["why"]) == ("done", "another kick came")
    assert seen["score"]["kicks"] == 0


def test_a_kick_that_the_robot_refuses_opens_the_question_again(lab, teacher, pupils):
    teacher.send("poll", request=1, robot="anna", kick=KICK)
    teacher.send("do", request=2, **DO)
    lab.anna.answers.pop()(RefusedByRobot("the robot does not run", "start it"))
    assert "result" in pupils[0].ask("answer", guess="reverses")


def test_the_teacher_asks_whoever_drives_and_all_others_answer(lab, teacher, pupils):
    pupil = pupils[0]
    refused = pupil.ask("poll", robot="anna", kick=KICK)["error"]["message"]
    assert "drive key asks the class" in refused
    assert "no question" in pupil.ask("answer", guess="stops")["error"]["message"]
    teacher.send("poll", request=1, robot="anna", kick=KICK)
    assert "asks the class, or drives" in teacher.ask("answer", guess="stops")["error"]["message"]
    assert "missing" in pupil.ask("answer", guess=None)["error"]["message"]
    assert "nobody can guess" in pupil.ask("answer", guess="explodes")["error"]["message"]
    assert "no 'noise'" in teacher.ask("poll", robot="anna", kick={"noise": 1})["error"]["message"]
    teacher.send("take", request=2)
    pupil.send("ask", request=2)
    teacher.send("give", request=3, page=pupil.page.number)
    assert pupil.drives
    assert "result" in teacher.ask("poll", robot="anna", kick=KICK)
    assert "asks the class, or drives" in pupil.ask("answer", guess="stops")["error"]["message"]
    pupil.send("do", request=4, **DO)
    assert poll(lab, teacher, pupil)["state"] == "locked"
    assert "result" in teacher.ask("poll", robot="anna", kick=None)
    assert poll(lab, teacher, pupil)["state"] == "none"
