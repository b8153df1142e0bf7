"""A link that nobody ends, but that carries nothing any more: the host dials again."""

import stat
import sys

import pytest

from host.client.connection import Connection
from host.client.robot import Robot
from host.errors import NoLink
from host.link.addresses import make_link
from host.logs.log import Log
from host.util.own_name import own_name
from robot import wire
from robot.record import STATES
from robot.session import Session
from tests.link.machines import Middlebox, TcpRobot
from tests.rig import TOKEN, packed


def whole(log, link):
    """Assert that a log has every tick from its first on, once, as in the robot's black box."""
    ticks = [record.tick for record in log.records]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    assert packed(log.records) == packed(link.records()[ticks[0] : ticks[-1] + 1])
    assert [event["event"] for event in log.events if event["event"] in ("snapshot", "lost")] == [
        "snapshot"
    ]


def recording(robot):
    """Record a robot, which runs on without this host: the log after a second, and the troubles."""
    if robot.trusted:
        robot.set(link_loss="continue")
    log, troubles = Log(), []
    robot.on_trouble = troubles.append
    robot.add_tap(log)
    robot.wait(1.0)
    return log, troubles


# In virtual time


@pytest.mark.parametrize("token", [True, False], ids=["who drives", "who only watches"])
def test_who_records_dials_again_and_loses_no_tick(link, token):
    with Robot(link, link.token if token else None) as robot:
        log, troubles = recording(robot)
        link.forget()
        begin = link.now()
        robot.wait(5.0)
        robot.remove_tap(log)
        assert link.opened == 2
        assert "nothing has come over it for 2 s" in troubles[0]
        assert link.now() - begin < 5.5
        whole(log, link)
        if token:
            robot.kick("membrane")


# A serial line stays open when the robot's end is opened anew, as by its program's next start


@pytest.fixture
def line(link, monkeypatch):
    """The link as a serial line. `line.begin_anew()`: the robot opens its end again."""
    monkeypatch.setattr(type(link), "is_line", True)

    def begin_anew():
        (peer,) = link.server._peers
        peer.lasting = True
        peer.session = Session(link.loop, link.token, link.server.boot)

    link.begin_anew = begin_anew
    return link


@pytest.mark.parametrize("token", [True, False], ids=["who drives", "who only watches"])
def test_who_records_over_a_line_says_hello_to_a_robot_that_has_begun_anew(line, token):
    with Robot(line, line.token if token else None) as robot:
        log, troubles = recording(robot)
        line.begin_anew()
        robot.wait(5.0)
        robot.remove_tap(log)
        whole(log, line)
        assert len(troubles) == 1
        assert ("there was no hello before it" if token else "nothing has come") in troubles[0]
        assert robot.drives == token


def test_a_command_to_a_robot_that_has_begun_anew_is_carried_out_once(line):
    with Robot(line, line.token) as robot:
        robot.kick("membrane")
        robot.wait(1.0)
        line.begin_anew()
        robot.kick("membrane")
        robot.wait(0.1)
    assert [event["event"] for event in line.events()].count("kick") == 2


def test_what_was_on_its_way_before_the_new_hello_does_not_refuse_it(line, monkeypatch):
    with Robot(line, line.token) as robot:
        robot.lease()
        late = [robot._talk.beat() for _ in range(3)]
        line.begin_anew()
        # To open the host's end takes nothing away that is on its way to the robot.
        monkeypatch.setattr(line, "open", lambda: line.send(b"".join(late)))
        robot.kick("membrane")
        assert robot.drives


def test_a_start_that_a_robot_that_has_begun_anew_refuses_is_not_sent_again(line):
    with Robot(line, line.token) as robot:
        robot.lease()
        robot.stop()
        line.begin_anew()
        with pytest.raises(NoLink, match="somebody may have stopped the robot since"):
            robot.start()
        assert robot.status()["state"] == "stopped"


def test_a_robot_that_ends_every_conversation_is_not_asked_for_ever(line, monkeypatch):
    receive = Session.receive

    def end(session, kind, payload):
        if kind == wire.ASK:
            return session.refuse("broken", "that was no message", "")
        return receive(session, kind, payload)

    with Robot(line, line.token) as robot:
        line.begin_anew()
        monkeypatch.setattr(Session, "receive", end)
        troubles = []
        robot.on_trouble = troubles.append
        begin = line.now()
        with pytest.raises(NoLink, match="does not answer to 'describe'"):
            robot.request("describe", {"what": "channels"})
        assert line.now() - begin < robot.answer_s + robot.reconnect_s + 1.0
        assert "that was no message" in troubles[-1]


def test_a_stop_needs_no_new_hello(line):
    with Robot(line, line.token) as robot:
        line.begin_anew()
        assert robot.stop_at_once().state == "stopped"
        assert robot.status()["state"] == "stopped"


def test_the_lease_is_taken_again_and_a_held_run_resumes(link):
    with Robot(link, link.token) as robot:
        robot.set(link_loss="hold")
        link.forget()
        robot.wait(5.0)
        assert STATES[link.loop.safety.state] == "running"
        assert [event["event"] for event in link.events()[-3:]] == ["link_loss", "hold", "resume"]
        assert robot.drives


def test_a_request_is_sent_again(link):
    with Robot(link, link.token) as robot:
        robot.lease()
        for ask in (robot.status, lambda: robot.set(k=3.0), lambda: robot.describe("channels")):
            link.forget()
            begin = link.now()
            assert ask()
            assert link.now() - begin < Robot.silence_s + 1.0


def test_a_connection_on_which_nothing_is_due_is_left_alone(link):
    """Nobody has subscribed or asked: silence is what the protocol demands."""
    with Connection(link, None) as connection:
        for _ in range(100):
            connection.pump(0.1)
        assert link.opened == 1
        assert connection.request("status")


def test_a_host_that_was_asleep_does_not_take_that_for_silence(link):
    with Robot(link, link.token) as robot:
        robot.lease()
        robot.wait(0.2)
        for _ in range(200):  # six seconds in which the host reads nothing
            link.run_tick()
        robot.wait(0.5)
        assert link.opened == 1


def test_a_robot_that_says_nothing_any_more_is_given_up_on(link):
    with Robot(link, None) as robot:
        robot.wait(0.1)
        serve, link.server.serve = link.server.serve, lambda timeout_s: None
        begin = link.now()
        with pytest.raises(NoLink, match="did not come back"):
            robot.status()
        assert link.now() - begin < Robot.silence_s + Robot.reconnect_s + Robot.answer_s + 1.0
        link.server.serve = serve
        link.run_tick()  # lets the robot notice what has hung up


def test_a_request_that_is_never_answered_ends(link, monkeypatch):
    """The robot answers heartbeats, but not this."""
    real = Session.receive

    def deaf(session, kind, payload):
        return b"" if kind == wire.ASK else real(session, kind, payload)

    monkeypatch.setattr(Session, "receive", deaf)
    with Robot(link, link.token) as robot:
        robot.lease()
        begin = link.now()
        with pytest.raises(NoLink, match="does not answer to 'status'"):
            robot.status()
        assert link.now() - begin < Robot.answer_s + 1.0
        assert link.opened == 1


def test_a_robot_that_lets_everybody_in_and_says_no_more_is_given_up_on(link, monkeypatch):
    real = Session.receive

    def deaf(session, kind, payload):
        return b"" if kind in (wire.ASK, wire.COMMAND) else real(session, kind, payload)

    with Robot(link, None) as robot:
        robot.wait(0.1)
        monkeypatch.setattr(Session, "receive", deaf)
        link.forget()
        begin = link.now()
        with pytest.raises(NoLink):
            robot.wait(60.0)
        assert link.now() - begin < Robot.silence_s + Robot.reconnect_s + Robot.answer_s


def test_an_outage_that_was_mended_late_is_no_reason_to_give_up(link, monkeypatch):
    monkeypatch.setattr(Robot, "reconnect_s", 30.0)
    with Robot(link, None) as robot, robot.recording() as log:
        robot.wait(0.1)
        link.cut(away_s=25.0)
        robot.wait(26.0)
    whole(log, link)


def test_on_a_serial_line_a_request_is_repeated_when_its_answer_gets_lost(link, monkeypatch):
    """As by noise, or by another program that reads there. Records come all the time."""
    real, lost = Session.receive, []

    def lose(session, kind, payload):
        answer = real(session, kind, payload)
        if kind == wire.ASK and b'"status"' in payload and not lost:
            lost.append(answer)
            return b""
        return answer

    with Robot(link, link.token) as robot:
        robot.wait(0.1)
        monkeypatch.setattr(link, "is_line", True, raising=False)
        monkeypatch.setattr(Session, "receive", lose)
        begin = link.now()
        assert robot.status()["state"] == "running"
        assert lost
        assert link.now() - begin < Robot.silence_s + 0.5
        assert link.opened == 1
        monkeypatch.setattr(Session, "receive", lambda session, kind, payload: b"")
        with pytest.raises(NoLink, match="does not answer"):
            robot.status()
        assert link.now() - begin < Robot.silence_s + Robot.answer_s + 1.0
        monkeypatch.undo()


def test_answers_to_heartbeats_are_no_records(link):
    """The robot has lost the subscription: the host asks again, and gives up in the end."""
    with Robot(link, link.token) as robot:
        robot.lease()
        log = Log()
        robot.add_tap(log)
        robot.wait(0.5)
        for peer in link.server._peers:
            peer.session.unsubscribe()
        robot.wait(4.0)
        assert link.opened == 1
        whole(log, link)
        for peer in link.server._peers:
            peer.session.stream = lambda: None
        with pytest.raises(NoLink, match="no more records"):
            robot.wait(1.0)
        assert robot.status()["controller"] == own_name()


# Over sockets


@pytest.fixture
def forgetful(monkeypatch):
    """A middlebox before a robot; nobody waits as long as in real life."""
    monkeypatch.setattr(Robot, "silence_s", 0.3)
    machine = TcpRobot(link_loss="continue")
    box = Middlebox(machine.port)
    yield box
    box.close()
    machine.close()


def ssh(folder, monkeypatch):
    """A stand-in for ssh: what comes after `-W` is where it carries its input."""
    program = folder / "ssh"
    program.write_text(
        f"#!{sys.executable}\n"
        "import os, select, socket, sys\n"
        "host, port = sys.argv[sys.argv.index('-W') + 1].split(':')\n"
        "far = socket.create_connection((host, int(port)))\n"
        "while True:\n"
        "    for end in select.select((0, far), (), ())[0]:\n"
        "        data = os.read(end if end == 0 else far.fileno(), 65536)\n"
        "        if not data:\n"
        "            sys.exit(255)\n"
        "        far.sendall(data) if end == 0 else os.write(1, data)\n",
        encoding="utf-8",
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(folder), prepend=":")


@pytest.mark.parametrize("scheme", ["tcp", "ssh"])
@pytest.mark.parametrize("token", [TOKEN, None], ids=["who drives", "who only watches"])
def test_a_middlebox_that_forgets_costs_time_and_no_tick(
    forgetful, tmp_path, monkeypatch, scheme, token
):
    box = forgetful
    ssh(tmp_path, monkeypatch)
    uri = f"tcp://127.0.0.1:{box.port}" if scheme == "tcp" else f"ssh://brick?port={box.port}"
    with Robot(make_link(uri), token) as robot:
        if token:
            robot.lease()
        log = Log()
        robot.add_tap(log)
        for _ in range(2):
            robot.wait(0.2)
            box.forget()
            robot.wait(0.6)
        robot.remove_tap(log)
        if token:
            robot.set(k=4.0)
        assert box.accepted >= 3
    assert log.missing() == []
    ticks = [record.tick for record in log.records]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    assert log.records[-1].t_s - log.records[0].t_s > 1.5
