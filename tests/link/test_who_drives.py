"""Verbs at a robot that somebody else drives: a refusal comes at once, and leaves no log."""

import json

import pytest

from host.cli import main
from host.client.robot import Robot
from host.errors import NotDone
from host.util.own_name import choose
from robot.record import STATES
from tests.link.machines import TcpRobot
from tests.rig import TOKEN
from tests.talk import Client


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A robot that runs, and its token on this computer."""
    token = tmp_path / "token"
    token.write_text(TOKEN.hex())
    token.chmod(0o600)
    machine = TcpRobot()
    machine.loop.params.link_loss_s = 1000.0
    monkeypatch.setenv("KICK_BRICK", f"tcp://127.0.0.1:{machine.port}")
    yield machine
    machine.close()
    choose(None)


@pytest.fixture
def kickctl(capsys):
    def run(*arguments):
        status = main(arguments)
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


@pytest.fixture
def anna(machine):
    """A host of another program, which drives the robot."""
    client = Client(machine.loop, name="anna@lab-3").greet()
    client.tell("lease")
    return client


DRIVING = [
    ("kick", "--mode", "phase"),
    ("start",),
    ("clear",),
    ("drive", "forward", "--motor", "pybricks"),
    ("demo",),
    ("rods",),
    ("params", "set", "k=2"),
    ("experiment", "reliability", "--trials", "2", "--yes"),
    ("reproduce", "--only", "R8"),
]


@pytest.fixture
def nobody_waits(monkeypatch):
    """Whoever waits for the wheels to settle fails."""

    def wait(*_, **__):
        raise AssertionError("it waits before it is refused")

    monkeypatch.setattr(Robot, "wait", wait)


@pytest.mark.usefixtures("anna", "nobody_waits")
@pytest.mark.parametrize("verb", DRIVING, ids=lambda verb: verb[0])
def test_a_robot_of_somebody_else_refuses_before_any_wait_and_leaves_no_log(
    machine, kickctl, tmp_path, verb
):
    status, _, err = kickctl(*verb)
    assert (status, "driven by 'anna@lab-3' for " in err) == (4, True), err
    assert not list(tmp_path.rglob("*.mcap"))
    assert (STATES[machine.loop.safety.state], machine.loop.lease.name) == ("running", "anna@lab-3")


@pytest.mark.usefixtures("machine", "nobody_waits")
@pytest.mark.parametrize("verb", DRIVING, ids=lambda verb: verb[0])
def test_who_has_no_token_is_refused_before_any_wait_and_leaves_no_log(
    kickctl, tmp_path, monkeypatch, verb
):
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "none"))
    status, _, err = kickctl(*verb)
    assert (status, "token" in err) == (4, True), err
    assert not list(tmp_path.rglob("*.mcap"))


@pytest.mark.usefixtures("nobody_waits")
@pytest.mark.parametrize(("state", "exit_status"), [("stopped", 1), ("fault", 5)])
def test_a_robot_that_does_not_run_refuses_a_kick_before_any_wait(
    machine, kickctl, tmp_path, state, exit_status
):
    if state == "fault":
        machine.loop.fail("its cable came off")
    else:
        machine.loop.stop("enough")
    assert kickctl("kick", "--mode", "phase")[0] == exit_status
    assert not list(tmp_path.rglob("*.mcap"))


def test_a_kick_that_is_refused_after_the_wait_leaves_a_log_that_says_so(
    machine, kickctl, tmp_path, monkeypatch
):
    monkeypatch.setattr("host.kicking.outcome.wait_settled", lambda robot: machine.loop.stop("no"))
    status, _, err = kickctl("kick", "--mode", "phase")
    assert status == 1
    (log,) = tmp_path.rglob("*.mcap")
    assert "-no-kick-phase-4-ticks" in log.name
    assert str(log.relative_to(tmp_path)) in err


def test_take_over_drives_at_once_under_the_name_that_was_given(machine, kickctl, anna):
    status, out, err = kickctl("start", "--take-over", "--name", "Ms Frizzle", "--json")
    assert (status, "runs already" in err) == (1, True)
    assert anna.tell("heartbeat")["taken_over_by"] == "Ms Frizzle"
    assert STATES[machine.loop.safety.state] == "running"
    assert "stop it first" in json.loads(out)["error"]["hint"]


@pytest.mark.parametrize("verb", DRIVING, ids=lambda verb: verb[0])
def test_every_verb_that_drives_can_take_over(machine, kickctl, anna, monkeypatch, verb):
    def wait(*_, **__):
        raise NotDone("that is far enough")

    monkeypatch.setattr(Robot, "wait", wait)
    kickctl(*verb, "--take-over", "--name", "teacher")
    assert anna.tell("heartbeat")["taken_over_by"] == "teacher"


@pytest.mark.parametrize("verb", [("experiment", "train-wall"), ("status",), ("stop",)])
def test_a_verb_that_takes_no_control_has_no_take_over(kickctl, verb):
    status, _, err = kickctl(*verb, "--take-over")
    assert (status, "has no option '--take-over'" in err) == (2, True)


@pytest.mark.usefixtures("anna")
def test_status_says_who_drives_and_for_how_long(machine, kickctl):
    machine.loop.lease._since -= 130.0
    assert "; driven by 'anna@lab-3' for 2 min 1" in kickctl("status")[1]
    status = json.loads(kickctl("status", "--json")[1])
    assert status["controller"] == "anna@lab-3"
    assert 130.0 <= status["controller_held_s"] < 160.0
    machine.loop.lease.release("anna@lab-3")
    assert "; driven by nobody\n" in kickctl("status")[1]
    status = json.loads(kickctl("status", "--json")[1])
    assert (status["controller"], status["controller_held_s"]) == (None, None)


@pytest.mark.usefixtures("anna")
def test_identify_needs_neither_token_nor_lease_and_says_how_the_robot_shows_itself(
    machine, kickctl, tmp_path, monkeypatch
):
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "none"))
    status, _, err = kickctl("identify")
    assert (status, "neither lights nor a speaker" in err) == (1, True)
    machine.loop.beacon.ways = ["lights", "beep"]
    machine.loop.beacon._since = -1000.0
    status, out, _ = kickctl("identify")
    assert (status, out.split(" ", 1)[1]) == (0, "blinks its lights and beeps for 3 s\n")
    assert machine.loop.safety.reason == "started"


def test_identify_refuses_an_embedded_robot(kickctl, monkeypatch):
    monkeypatch.delenv("KICK_BRICK", raising=False)
    status, _, err = kickctl("identify")
    assert (status, "nothing to show itself by" in err) == (2, True)


@pytest.mark.parametrize("name", ["", "x" * 41, "a\x1b[31m"])
def test_a_name_that_cannot_be_shown_is_refused_in_words(kickctl, name):
    status, _, err = kickctl("--name", name, "status")
    assert (status, "name" in err) == (2, True)
