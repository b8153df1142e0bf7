"""The robot's program with an engineer's own motors, as a process: what it refuses and survives."""

import os
import select
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

from host.cli import main
from host.client.robot import connect
from host.errors import NoLink, RobotFault
from host.logs.log import Log
from tests.lint.sources import ROOT

PATIENCE_S = 20.0

# Motors in files, as a kernel shows them: another process sees the duty cycle, and can stop them.
FILES = """
import os, sys, time
from robot.motors import Motor, MotorFault

class FileMotor(Motor):
    model = "file"

    def __init__(self, name):
        self.name = name

    def angle_rad(self):
        if os.path.exists("hang"):
            time.sleep(3600)
        if os.path.exists("raise"):
            raise ValueError("no such register")
        if os.path.exists("exit"):
            sys.exit(0)
        return 0.5

    def write_duty(self, duty_pct):
        with open(self.name, "w") as file:
            file.write(str(duty_pct))

    def stop(self):
        if os.path.exists("deaf") and self.name == "left":
            raise MotorFault("the left motor is deaf")
        self.write_duty(0)

class Watched(FileMotor):
    def emergency_stop(self):
        self.write_duty(0)

def bare():
    return FileMotor("left"), FileMotor("right")

def watched():
    return Watched("left"), Watched("right")
"""


@contextmanager
def program(folder, *arguments):
    """The robot's program in a folder with FILES as motor_files.py."""
    (folder / "motor_files.py").write_text(FILES)
    with subprocess.Popen(
        [sys.executable, "-m", "robot", "--host", "127.0.0.1", "--port", "0", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def line_of(stream):
    assert select.select([stream], (), (), PATIENCE_S)[0]
    return stream.readline()


def wait_until(condition):
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def duties(folder):
    return [(folder / side).read_text() for side in ("left", "right")]


def runs(folder):
    """Whether both motors are driven; a file is empty for a moment while it is written."""
    return all(duty not in ("", "0") for duty in duties(folder))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--motors", "nosuch:motors"), "there is no module nosuch in"),
        (("--motors", "motor_files:nosuch"), "motor_files.py has no function nosuch"),
        (("--motors", "motor_files:FileMotor"), "missing 1 required positional argument"),
        (("--motors", "motor_files:bare", "--left", "outA"), "--left is about the brick's motors"),
        (("--motors", "motor_files:bare", "--sysfs", "sys"), "--sysfs is about the brick's"),
    ],
)
def test_what_cannot_work_is_refused_before_ready(tmp_path, arguments, words):
    with program(tmp_path, *arguments) as process:
        out, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


def test_a_robot_says_which_motor_it_has_and_that_nobody_else_can_stop_it(tmp_path):
    with program(tmp_path, "--motors", "motor_files:bare", "--idle") as process:
        uri = line_of(process.stdout).split()[1]
        with connect(uri) as robot:
            assert robot.hello["motor"] == "file"
            assert robot.status()["battery_v"] is None
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0
    assert "the watchdog cannot stop the left and the right motor" in err
    assert "`kickctl stop`" in err
    assert duties(tmp_path) == ["0", "0"]


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM, signal.SIGINT])
def test_the_end_of_its_terminal_and_all_that_asks_it_to_end_stop_the_motors(tmp_path, number):
    with program(tmp_path, "--motors", "motor_files:bare") as process:
        assert line_of(process.stdout).startswith("READY")
        wait_until(lambda: runs(tmp_path))
        process.send_signal(number)
        assert process.wait(PATIENCE_S) == 0
        assert duties(tmp_path) == ["0", "0"]


def test_a_program_that_is_to_outlive_its_terminal_does(tmp_path):
    deaf = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with program(tmp_path, "--motors", "motor_files:bare") as process:
            assert line_of(process.stdout).startswith("READY")
            process.send_signal(signal.SIGHUP)
            (tmp_path / "exit").touch()  # the next tick ends it, and no signal has
            assert process.wait(PATIENCE_S) == 1
    finally:
        signal.signal(signal.SIGHUP, deaf)


@pytest.mark.parametrize("factory", ["bare", "watched"])
def test_a_motor_that_does_not_obey_in_the_end_is_said_and_the_status_is_1(tmp_path, factory):
    with program(tmp_path, "--motors", "motor_files:" + factory) as process:
        uri = line_of(process.stdout).split()[1]
        wait_until(lambda: runs(tmp_path))
        (tmp_path / "deaf").touch()
        with connect(uri, observe=True) as robot:
            assert robot.stop_at_once().unstopped == ("left",)
            with pytest.raises(RobotFault, match="left motor has NOT obeyed the stop"):
                robot.stop()
        assert main(["--brick", uri, "stop"]) == 5
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1
    assert "the left motor did not obey when the program ended, and may run on" in err
    assert "the left motor is deaf" in err
    assert (duties(tmp_path)[0] == "0") == (factory == "watched")  # which the watchdog has stopped


def test_a_motor_that_ends_the_program_stops_both_and_is_said(tmp_path):
    with program(tmp_path, "--motors", "motor_files:watched") as process:
        assert line_of(process.stdout).startswith("READY")
        wait_until(lambda: runs(tmp_path))
        (tmp_path / "exit").touch()
        _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1
    assert "a part of the robot's program has ended it" in err
    assert "motor_files.py" in err
    assert duties(tmp_path) == ["0", "0"]


@pytest.mark.parametrize("end", ["hang", "kill"])
def test_the_watchdog_stops_motors_whose_program_hangs_or_is_killed(tmp_path, end):
    with program(tmp_path, "--motors", "motor_files:watched") as process:
        assert line_of(process.stdout).startswith("READY")
        wait_until(lambda: runs(tmp_path))
        if end == "hang":
            (tmp_path / "hang").touch()
        else:
            process.kill()
        assert "motors stopped" in line_of(process.stderr) + line_of(process.stderr)
        assert duties(tmp_path) == ["0", "0"]


def test_an_exception_of_a_motor_stops_both_and_is_said_to_the_host(tmp_path):
    with program(tmp_path, "--motors", "motor_files:watched") as process:
        uri = line_of(process.stdout).split()[1]
        with connect(uri) as robot:
            wait_until(lambda: runs(tmp_path))
            log = Log()
            robot.add_tap(log)
            (tmp_path / "raise").touch()
            robot.reconnect_s = 0.3
            with pytest.raises(NoLink):
                robot.wait(PATIENCE_S)
            assert process.wait(PATIENCE_S) == 1
        (fault,) = [event for event in log.events if event["event"] == "fault"]
        assert "ValueError('no such register')" in fault["reason"]
        assert duties(tmp_path) == ["0", "0"]
        assert "no such register" in process.stderr.read()
