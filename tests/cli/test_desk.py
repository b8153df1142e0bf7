"""The brick on the desk: a robot in a process of its own, in real time, driven by kickctl."""

import json
import os
import re
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

from host.client.robot import connect
from host.errors import RefusedByRobot


@contextmanager
def desk_robot(folder, *arguments):
    """A running `python -m sim_motor`: (its URI, the process).

    It bears a host that is silent for some seconds, as on a busy machine.
    """
    environment = dict(os.environ, KICK_TOKEN=str(folder / "token"))
    command = [sys.executable, "-m", "sim_motor", "--port", "0", "--seed", "3"]
    command += ["--set", "link_loss_s=10", *arguments]
    with subprocess.Popen(
        command,
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            line = process.stdout.readline()
            assert re.fullmatch(r"READY tcp://127\.0\.0\.1:\d+\n", line), (
                line + process.stderr.read()
            )
            yield line.split()[1], process
        finally:
            process.terminate()
            process.wait(10)


@pytest.fixture
def outside(tmp_path):
    """kickctl as a process of its own: (exit status, standard output, standard error)."""

    def run(*arguments, **environment):
        environment = {
            **os.environ,
            "KICK_TOKEN": str(tmp_path / "token"),
            "PYTHONPATH": str(Path.cwd()),
            **environment,
        }
        command = [sys.executable, "-m", "host", *arguments]
        done = subprocess.run(
            command,
            env=environment,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        return done.returncode, done.stdout, done.stderr

    return run


def test_a_kick_from_another_process_reverses_the_desk_robot_and_leaves_it_running(
    tmp_path, outside
):
    with desk_robot(tmp_path) as (uri, process):
        status, out, err = outside(
            "--brick", uri, "kick", "--mode", "phase", "--ticks", "4", "--json"
        )
        result = json.loads(out)
        assert status == 0, err
        assert (result["reversed"], result["brick"]) == (True, uri)
        assert json.loads(outside("--brick", uri, "status", "--json")[1])["state"] == "running"
        replay = outside("log", "replay", result["log"], "--json")
        assert json.loads(replay[1])["exact"] is True
        process.send_signal(signal.SIGTERM)
        assert process.wait(10) == 0
        assert outside("--brick", uri, "status")[0] == 3


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "0"])  # noqa: S104
def test_ready_names_an_address_that_works_where_the_robot_listens_everywhere(tmp_path, host):
    environment = dict(os.environ, KICK_TOKEN=str(tmp_path / "token"))
    with subprocess.Popen(
        [sys.executable, "-m", "sim_motor", "--port", "0", "--host", host],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            uri = process.stdout.readline().split()[1]
            with connect(uri, observe=True) as robot:
                assert robot.status()["state"] == "running"
        finally:
            process.terminate()
        assert f"every address of this machine ({host})" in process.stderr.read()


def test_a_robot_does_not_listen_on_an_address_without_letters(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "sim_motor", "--host", "", "--port", "0"],
        env=dict(os.environ, KICK_TOKEN=str(tmp_path / "token")),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert "--host cannot be empty" in done.stderr


def test_an_idle_robot_waits_for_start(tmp_path, kickctl, monkeypatch):
    with desk_robot(tmp_path, "--idle") as (uri, _):
        monkeypatch.setenv("KICK_BRICK", uri)
        status, _, err = kickctl("kick", "--mode", "phase")
        assert status == 1
        assert "kickctl start" in err
        assert kickctl("start")[0] == 0
        status = kickctl("status", "--json")[1]
        assert json.loads(status)["state"] == "running"
        assert kickctl("stop")[0] == 0
        assert json.loads(kickctl("status", "--json")[1])["state"] == "stopped"


def test_without_the_token_one_may_look_and_stop_but_not_move(tmp_path, kickctl, monkeypatch):
    with desk_robot(tmp_path) as (uri, _):
        monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "none"))
        status, _, err = kickctl("--brick", uri, "kick", "--mode", "membrane")
        assert status == 4
        assert "token" in err
        assert kickctl("--brick", uri, "status")[0] == 0
        assert kickctl("--brick", uri, "start", "--token", str(tmp_path / "none"))[0] == 4
        assert kickctl("--brick", uri, "stop")[0] == 0
        monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
        assert json.loads(kickctl("--brick", uri, "status", "--json")[1])["state"] == "stopped"


def test_who_has_another_robots_token_may_look_and_stop_but_not_move(tmp_path, outside):
    with desk_robot(tmp_path) as (uri, _):
        wrong = tmp_path / "wrong"
        wrong.write_text("11" * 32)
        wrong.chmod(0o600)
        for verb in (("status",), ("record", "0.1"), ("watch", "--seconds", "0.1"), ("stop",)):
            status, _, err = outside("--brick", uri, "--token", str(wrong), *verb)
            assert status == 0, err
            assert err.count("is not that of the robot") == (verb != ("stop",))
        status, _, err = outside("--brick", uri, "--token", str(wrong), "start")
        assert status == 4
        assert "the token of another robot" in err
        assert f"kickctl robots add NAME {uri} --token FILE" in err


def test_one_controller_at_a_time(tmp_path, outside):
    with (
        desk_robot(tmp_path) as (uri, _),
        connect(uri, token=str(tmp_path / "token"), name="first") as first,
    ):
        first.lease()
        status, _, err = outside("--brick", uri, "kick", "--mode", "membrane", "--now")
        assert status == 4
        assert "the robot has been driven by 'first' for " in err
        first.release()
        assert outside("--brick", uri, "params", "set", "k=7")[0] == 0


def test_status_and_a_new_k_say_why_wheels_rest(tmp_path, kickctl):
    with desk_robot(tmp_path, "--set", "k=0") as (uri, _):
        status, out, err = kickctl("--brick", uri, "status")
        assert status == 0, err
        assert "the left wheel rests, with a torque of |M| = 0.00" in out
        assert "k = 0 is too small" in out
        assert re.search(r"^of \d+ ticks \d+ were missed", out, re.MULTILINE)
        status, out, err = kickctl("--brick", uri, "params", "set", "k=0.3")
        assert (status, out) == (0, "k = 0.3\n")
        assert "k = 0.3 is too small" in err


def test_the_api_of_the_readme(tmp_path):
    with desk_robot(tmp_path) as (uri, _):
        with connect(uri, token=str(tmp_path / "token")) as robot:
            robot.kick("phase", ticks=4)
            log = robot.record(0.5)
        assert 15 <= len(log) + sum(record.missed for record in log.records[1:]) <= 19
        assert log.missing() == []
        token = tmp_path / "token"
        token.chmod(0o640)
        with pytest.raises(RefusedByRobot, match="chmod 600"):
            connect(uri, token=str(token))


def test_a_port_in_use_is_told_in_words(tmp_path):
    with desk_robot(tmp_path) as (uri, _):
        port = uri.rsplit(":", 1)[1]
        command = [
            sys.executable,
            "-m",
            "sim_motor",
            "--port",
            port,
            "--token",
            str(tmp_path / "token"),
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
        assert done.returncode == 2
        assert "cannot listen" in done.stderr
        assert "Traceback" not in done.stderr


def test_a_hand_on_standard_input_turns_a_wheel_between_walls_and_its_end_is_the_robots(tmp_path):
    with desk_robot(tmp_path, "--hand", "--walls", "2", "--idle") as (uri, process):
        with connect(uri, observe=True) as robot:
            robot.wait(0.1)
            goal = robot.newest.left_phi_rad + 1.0

            def turned():
                process.stdin.write(f"left {goal}\n")
                process.stdin.flush()
                return abs(robot.newest.left_phi_rad - goal) < 0.1

            assert robot.wait(20.0, until=turned)
        process.stdin.close()
        assert process.wait(10) == 0


def test_walls_without_room_for_the_robot_are_refused(tmp_path):
    command = [sys.executable, "-m", "sim_motor", "--port", "0", "--walls", "0.1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert "give a number from 0.4 to 100 m" in done.stderr
