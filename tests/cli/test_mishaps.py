"""What goes wrong around kickctl: no room, no token, a robot that goes away, damaged logs.

kickctl says so in words, and nothing is lost.
"""

import json
import resource
import shutil
from pathlib import Path

import pytest

from host.client.robot import Robot, connect
from host.errors import NoLink, RefusedByRobot, WrongUse
from host.logs.log import Log
from robot.record import STATES
from robot.session import Session
from tests.cli.test_desk import desk_robot
from tests.link.machines import TcpRobot


def test_stop_needs_no_token_however_bad_the_one_that_is_there(kickctl, tmp_path):
    with desk_robot(tmp_path) as (uri, _):
        wrong = tmp_path / "wrong"
        wrong.write_text("11" * 32)
        wrong.chmod(0o644)
        assert kickctl("status", "--brick", uri, "--token", str(wrong))[0] == 4
        assert kickctl("stop", "--brick", uri, "--token", str(wrong))[0] == 0
        assert json.loads(kickctl("status", "--brick", uri, "--json")[1])["state"] == "stopped"


@pytest.mark.parametrize("answer", ["another version", "nothing"])
def test_stop_needs_no_robot_that_understands_hello(kickctl, monkeypatch, answer):
    def hello(session, message):
        return session.refuse("version", "9.0", "") if answer == "another version" else b""

    monkeypatch.setattr(Session, "_hello", hello)
    monkeypatch.setattr(Robot, "answer_s", 0.3)
    machine = TcpRobot()
    try:
        uri = machine.link().uri
        assert kickctl("status", "--brick", uri)[0] == (4 if answer == "another version" else 3)
        status, out, _ = kickctl("stop", "--brick", uri, "--json")
        assert status == 0
        assert json.loads(out)["state"] == STATES[machine.loop.safety.state] == "stopped"
        assert json.loads(out)["brick"] == uri
    finally:
        machine.close()


def test_a_stop_that_nobody_confirms_exits_3_and_claims_nothing(kickctl, monkeypatch):
    monkeypatch.setattr(Session, "receive", lambda session, kind, payload: b"")
    monkeypatch.setattr("host.client.stop.CONFIRM_S", 0.3)
    machine = TcpRobot()
    try:
        status, out, err = kickctl("stop", "--brick", machine.link().uri)
    finally:
        machine.close()
    assert (status, out) == (3, "")
    assert "may still be running" in err


def test_a_stop_without_a_robot_of_its_own_is_no_success(kickctl):
    """It ends with the command, and a real robot may drive: nobody must take that for a stop."""
    for arguments in ((), ("--brick", "sim://"), ("--seed", "1"), ("--set", "k=2")):
        status, out, err = kickctl("stop", *arguments)
        assert (status, out) == (2, "")
        assert "none has been stopped" in err
        status, out, _ = kickctl("stop", *arguments, "--json")
        assert json.loads(out)["error"]["status"] == status == 2


@pytest.mark.parametrize("verb", ["stop", "status", "kick", "doctor", "experiment"])
def test_an_empty_address_is_no_simulated_robot(kickctl, monkeypatch, verb):
    """As in `--brick "$ROBOT"` with a variable of the shell that is not set."""
    arguments = {"kick": ["--mode", "membrane"], "experiment": ["timeline"]}.get(verb, [])
    status, out, err = kickctl(verb, *arguments, "--brick", "")
    assert status == 2
    assert "address is empty" in out + err
    monkeypatch.setenv("KICK_BRICK", "")
    status, out, err = kickctl(verb, *arguments)
    assert status == 2
    assert "unset KICK_BRICK" in out + err


def test_a_robot_that_begins_anew_while_it_is_recorded_is_told(kickctl, tmp_path):
    with (
        desk_robot(tmp_path) as (uri, process),
        connect(uri, token=str(tmp_path / "token")) as robot,
    ):
        log = Log(robot.info())
        robot.add_tap(log)
        robot.wait(0.3)
        process.kill()
        process.wait()
        with desk_robot(tmp_path, "--port", uri.rsplit(":", 1)[1]):
            robot.wait(5.0, until=lambda: bool(log.restarts()))
            robot.wait(0.3)
    assert len(log.restarts()) == 1
    assert log.records[log.restarts()[0]].tick < log.records[log.restarts()[0] - 1].tick


def test_a_closed_robot_stays_closed():
    robot = connect("sim://")
    robot.close()
    with pytest.raises(NoLink, match="closed"):
        robot.kick("phase")


def test_nobody_waits_for_ever_for_nothing():
    with connect("sim://") as robot, pytest.raises(WrongUse, match="seconds cannot be inf"):
        robot.wait(float("inf"))


@pytest.mark.parametrize("seconds", [float("nan"), -1.0])
def test_nobody_records_for_no_number_of_seconds(seconds):
    with connect("sim://") as robot, pytest.raises(WrongUse):
        robot.record(seconds)


def test_a_full_disk_is_told_in_words(kickctl):
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full, which Linux has")
    path = json.loads(kickctl("record", "1", "--seed", "1", "--json")[1])["log"]
    status, _, err = kickctl("log", "export", path, "--out", "/dev/full")
    assert status == 1
    assert "No space left" in err
    assert "Traceback" not in err


def test_a_recording_that_finds_no_more_room_names_its_file_and_keeps_what_it_has(kickctl):
    """A limit on the size of a process's files stands in for a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60000, before[1]))
    try:
        status, _, err = kickctl("record", "60", "--seed", "1", "--out", "log.mcap")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert status == 1
    assert "log.mcap cannot be written" in err
    assert len(Log.load("log.mcap")) > 100


def test_a_log_goes_only_where_a_folder_is(kickctl):
    status, _, err = kickctl("record", "1", "--out", str(kickctl.folder / "nowhere" / "log.mcap"))
    assert status == 2
    assert "folder" in err
    assert not (kickctl.folder / "nowhere").exists()


def test_a_log_that_breaks_off_is_not_passed_by_replay(kickctl):
    path = kickctl.folder / json.loads(kickctl("record", "5", "--seed", "1", "--json")[1])["log"]
    cut = kickctl.folder / "cut.mcap"
    shutil.copy(path, cut)
    with cut.open("r+b") as file:
        file.truncate(path.stat().st_size // 2)
    status, out, _ = kickctl("log", "replay", str(cut), "--json")
    assert status == 1
    assert json.loads(out)["truncated"] is True
    assert "breaks off" in kickctl("log", "replay", str(cut))[2]


def test_a_host_that_was_taken_for_lost_takes_control_again_unless_another_has_it():
    with connect("sim://", seed=1) as robot:
        robot.lease()
        robot.stop()
        robot.link.loop.lease.release(
            robot.link.loop.lease.holder
        )  # as after a silence, over a link that stays
        robot.start()
        assert robot.status()["state"] == "running"
        robot.link.loop.lease.release(robot.link.loop.lease.holder)
        robot.link.loop.take_lease("another", "another host")
        with pytest.raises(RefusedByRobot, match="another host"):
            robot.set(k=2.0)
        assert robot.status()["params"]["k"] == 8.0
