"""A host that takes over, and the one that had control before: it hears so and does not fight."""

import logging
from types import SimpleNamespace

import pytest

from host.client.robot import Robot
from host.commands._watch_keys import KeyActions
from host.errors import LeaseLost, RefusedByRobot, WrongUse
from host.util.own_name import NAME_LETTERS, choose, own_name
from robot import commands
from robot.record import STATES
from tests.link.machines import RigLink
from tests.talk import Client


def stranger(link, name="teacher@lab-1"):
    """A host of another program, which has the token; the robot waits for it for ever."""
    link.loop.params.link_loss_s = 1000.0
    client = Client(link.loop, link.token, name=name)
    client.session._token = link.token
    return client.greet()


@pytest.fixture
def teacher(link):
    return stranger(link)


def test_who_was_driving_hears_who_has_taken_over_while_it_waits(robot, link, teacher, caplog):
    robot.lease()
    teacher.tell("lease", take_over=True)
    with caplog.at_level(logging.WARNING, "kickctl"):
        robot.wait(0.3)
    assert not robot.drives
    (said,) = caplog.messages
    assert "'teacher@lab-1' has taken over the robot" in said
    assert STATES[link.loop.safety.state] == "running"
    for call in (robot.start, robot.clear, lambda: robot.kick("phase"), lambda: robot.set(k=1.0)):
        with pytest.raises(LeaseLost, match="'teacher@lab-1' has taken over"):
            call()
    with pytest.raises(LeaseLost, match="'teacher@lab-1' has taken over, 0 s ago"):
        robot.lease()
    assert robot.status()["controller"] == "teacher@lab-1"


def test_a_command_before_any_heartbeat_is_refused_with_the_same_words(robot, link, teacher):
    robot.set(k=7.0)
    teacher.tell("lease", take_over=True)
    with pytest.raises(LeaseLost, match="'teacher@lab-1' has taken over"):
        robot.set(k=1.0)
    assert not robot.drives
    assert robot.status()["params"]["k"] == 7.0


def test_who_was_driving_does_not_resume_by_itself_when_the_other_has_finished(
    robot, link, teacher
):
    robot.set(k=7.0)
    teacher.tell("lease", take_over=True)
    teacher.tell("release")
    for _ in range(2):
        with pytest.raises(LeaseLost, match="'teacher@lab-1' has taken over"):
            robot.set(k=1.0)
    assert link.loop.lease.holder is None
    robot.lease()
    robot.set(k=1.0)
    assert robot.status()["params"]["k"] == 1.0


def test_who_was_driving_can_take_over_in_turn_and_the_robot_runs_on(robot, link, teacher):
    robot.lease()
    teacher.tell("lease", take_over=True)
    robot.wait(0.3)
    robot.take_over()
    assert robot.drives
    robot.wait(0.3)
    robot.set(k=2.0)
    assert teacher.tell("heartbeat")["taken_over_by"] == own_name()
    assert [event["event"] for event in link.events()] == [
        "start",
        "take_over",
        "take_over",
        "params",
    ]


@pytest.mark.parametrize("finished", [False, True])
def test_control_is_not_taken_back_when_the_link_comes_back(robot, link, teacher, finished):
    robot.set(link_loss="continue")
    link.cut(away_s=1.0)
    teacher.tell("lease", take_over=True)
    if finished:
        teacher.tell("release")
    robot.wait(0.5)
    assert not robot.drives
    assert link.loop.lease.holder == (None if finished else "teacher@lab-1")
    with pytest.raises(LeaseLost, match="'teacher@lab-1' has taken over"):
        robot.kick("membrane")


def test_a_host_that_was_only_taken_for_lost_takes_control_again(robot, link):
    robot.set(k=7.0)
    link.loop.lease.release(link.loop.lease.holder)  # as after a silence
    robot.set(k=2.0)
    assert robot.drives


def test_connect_may_take_over_at_once(link, teacher):
    teacher.tell("lease")
    with Robot(link, link.token) as robot:
        with pytest.raises(LeaseLost, match="driven by 'teacher@lab-1' for 0 s"):
            robot.lease()
        robot.take_over()
        assert robot.drives
    assert link.loop.lease.holder is None
    with pytest.raises(WrongUse, match="take over"):
        Robot.connect("sim://", observe=True, take_over=True)
    with Robot.connect("sim://", take_over=True) as robot:
        assert robot.drives


def test_keys_of_a_watch_take_over_only_where_that_was_wished(link):
    stranger(link, "pupil").tell("lease")
    with Robot(link, link.token) as robot:
        words = []
        for take_over in (False, True):
            actions = KeyActions(
                robot.stop_at_once, words.append, words.append, take_over=take_over
            )
            actions.press("1")
            actions.kick(robot)
            assert link.loop.lease.holder == (None if take_over else "pupil")
    assert len(words) == 1
    assert "driven by 'pupil'" in words[0]
    assert [event["event"] for event in link.events()] == ["start", "take_over", "kick"]


def test_who_has_no_token_cannot_take_over(link, teacher):
    teacher.tell("lease")
    with Robot(link, None) as pupil, pytest.raises(RefusedByRobot, match="token"):
        pupil.take_over()
    assert link.loop.lease.holder == "teacher@lab-1"


class Older(RigLink):
    """A robot of protocol 1.1, which knows neither takeovers, nor beats, nor itself."""

    def __init__(self, monkeypatch):
        super().__init__()
        rows = {name: row for name, row in commands.TABLE.items() if name != "identify"}
        changes = {
            "lease": {"arguments": ()},
            "heartbeat": {"run": lambda loop, session, message: {"tick": loop.blackbox.next_tick}},
        }
        for name, changed in changes.items():
            rows[name] = SimpleNamespace(**vars(rows[name]) | changed)
        monkeypatch.setattr(commands, "TABLE", rows)
        self._monkeypatch = monkeypatch

    def open(self):
        super().open()
        (peer,) = self.server._peers
        hello = peer.session._hello

        def older(message):
            with self._monkeypatch.context() as patch:
                patch.setattr("robot.wire.PROTOCOL", (1, 1))
                return hello(message)

        self._monkeypatch.setattr(peer.session, "_hello", older)
        self._monkeypatch.setattr(peer.session, "_beat", None)


def test_an_older_robot_is_driven_as_ever_and_refuses_what_it_does_not_know(monkeypatch):
    link = Older(monkeypatch)
    with Robot(link, link.token) as robot:
        assert robot.hello["protocol"] == [1, 1]
        robot.set(k=2.0)
        robot.wait(1.0)
        assert robot.drives
        for call in (robot.take_over, robot.identify):
            with pytest.raises(RefusedByRobot, match=r"too old for .*: it has protocol 1\.1"):
                call()


def test_an_older_host_hears_of_a_takeover_by_refusals(link, teacher):
    """It sends no take_over, and does not look at what heartbeats answer."""
    pupil = stranger(link, "pupil@lab-3")
    pupil.tell("lease")
    teacher.tell("lease", take_over=True)
    pupil.tell("heartbeat")
    with pytest.raises(LeaseLost, match="'teacher@lab-1' has taken over"):
        pupil.tell("lease")


def test_a_robot_shows_itself_for_a_moment(robot, link):
    link.loop.beacon.ways = ["words"]
    assert robot.identify() == {"seconds": 3.0, "ways": ["words"]}
    assert link.loop.beacon.by == f"'{own_name()}'"
    assert robot.status()["controller"] is None


# Names


@pytest.fixture
def at(monkeypatch):
    """Be a user at a machine."""

    def be(user, machine):
        monkeypatch.setattr("getpass.getuser", lambda: user)
        monkeypatch.setattr("socket.gethostname", lambda: machine)
        return own_name()

    yield be
    choose(None)


def test_a_host_is_named_by_its_user_and_machine(at):
    assert at("anna", "lab-3.school.example") == "anna@lab-3"
    assert at("a\x1bnna\n", "lab") == "anna@lab"
    assert at("x" * 60, "lab") == "x" * NAME_LETTERS


def test_a_user_whom_the_system_does_not_know_has_a_name_too(at, monkeypatch):
    at("", "lab")

    def unknown():
        raise KeyError("getpwuid(): uid not found: 12345")

    monkeypatch.setattr("getpass.getuser", unknown)
    assert own_name() == "somebody@lab"


def test_a_chosen_name_is_that_of_every_connection(at, link):
    at("anna", "lab-3")
    choose("The teacher")
    with Robot(link, link.token) as robot:
        robot.lease()
        assert link.loop.lease.name == "The teacher"
    choose(None)
    assert own_name() == "anna@lab-3"


@pytest.mark.parametrize("name", ["", " ", "x" * 41, "red\x1b[31m", "two\nlines", 5])
def test_a_name_that_cannot_be_shown_is_refused_and_changes_nothing(at, name):
    at("anna", "lab-3")
    with pytest.raises(WrongUse, match="name"):
        choose(name)
    assert own_name() == "anna@lab-3"
