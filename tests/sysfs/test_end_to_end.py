"""The robot's program through python-ev3dev2 on the live tree, kicked over TCP."""

import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

from host.client.robot import connect
from host.errors import RobotFault
from host.kicking.outcome import kick_and_watch, wait_settled
from host.logs.log import Log
from tests.sysfs.mount import ROOT, ended, inject, motor_folder, mounted, needs_mount, started

pytestmark = needs_mount


@pytest.fixture
def live(tmp_path):
    with mounted(tmp_path / "sys", "--seed", "4") as folder:
        yield folder


@contextmanager
def robot_on(live, *options):
    """A host's connection to a robot on the live tree."""
    process, uri = started(
        "robot", "--sysfs", str(live), "--host", "127.0.0.1", "--port", "0", "--seed", "5", *options
    )
    try:
        with connect(uri) as robot:
            yield robot
    finally:
        status, errors = ended(process)
    assert status == 0, errors


def wait_until(condition, seconds=30.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


def text(live, port, name):
    return (motor_folder(live, port) / name).read_text(encoding="ascii").strip()


def state_of(robot):
    return robot.status()["state"]


def cleared(robot):
    try:
        robot.clear()
    except RobotFault:
        return False
    return True


@pytest.mark.parametrize(("mode", "ticks"), [("phase", 4), ("membrane", 1)])
def test_a_kick_reverses_the_robot(live, mode, ticks):
    with robot_on(live) as robot:
        assert wait_settled(robot)
        log = Log(robot.info())
        robot.add_tap(log)
        outcome = kick_and_watch(robot, log, mode, ticks=ticks)
        assert outcome.reversed, outcome
        # Both motors draw three amperes while they reverse, perhaps as it is read.
        assert 6.0 < robot.status()["battery_v"] < 8.1
    assert text(live, "outB", "state") == text(live, "outC", "state") == ""


def test_a_cable_that_comes_off_is_a_fault_until_it_is_back_and_cleared(live):
    with robot_on(live) as robot:
        robot.record(1.0)
        inject(live, "unplug outB")
        wait_until(lambda: state_of(robot) == "fault")
        assert "left motor (outB): its cable came off" in robot.status()["reason"]
        assert text(live, "outC", "state") == ""
        assert text(live, "outC", "duty_cycle") == "0"
        assert robot.stop_at_once().unstopped == ()  # no motor is there that could run
        with pytest.raises(RobotFault, match="there is none"):
            robot.clear()
        with pytest.raises(RobotFault, match="is in fault"):
            robot.start()
        inject(live, "replug outB")
        wait_until(lambda: cleared(robot))
        assert state_of(robot) == "stopped"
        robot.start()
        log = robot.record(2.0)
        assert {record.state for record in log.records[3:]} == {1}
        assert (
            max(abs(record.left_phi_rad - log.records[0].left_phi_rad) for record in log.records)
            > 1.0
        )
        assert [event["event"] for event in log.events].count("fault") == 0


def test_the_fault_is_told_once_in_the_record(live):
    with robot_on(live) as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        inject(live, "eio outC")
        robot.wait(20.0, until=lambda: any(event["event"] == "fault" for event in log.events))
        robot.wait(1.0)
        assert [
            event["reason"].partition(":")[0] for event in log.events if event["event"] == "fault"
        ] == ["right motor (outC)"]
        assert log.records[-1].state == 4
        assert text(live, "outB", "state") == text(live, "outC", "state") == ""
        assert cleared(robot)


def test_a_robot_without_its_motors_starts_in_fault_and_can_be_mended(live):
    inject(live, "unplug outC")
    wait_until(lambda: len(list(live.glob("tacho-motor/*"))) == 1)
    with robot_on(live) as robot:
        wait_until(lambda: state_of(robot) == "fault")
        assert "right motor (outC): there is none" in robot.status()["reason"]
        inject(live, "replug outC")
        wait_until(lambda: cleared(robot))
        robot.start()
        assert state_of(robot) == "running"


@pytest.mark.parametrize(
    "make",
    [
        lambda path: None,
        lambda path: path.write_text(""),
        lambda path: (path.mkdir(), (path / "a").touch()),
    ],
)
def test_what_cannot_be_mounted_on_is_refused_in_words(tmp_path, make):
    make(tmp_path / "sys")
    arguments = [sys.executable, "-m", "sim_motor", "--sysfs", str(tmp_path / "sys")]
    done = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "is no empty folder to mount on: make one" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_an_empty_battery_stops_the_robot_and_the_lights_follow(live):
    def lights():
        return [
            (live / f"leds/led0:{colour}:brick-status/brightness")
            .read_text(encoding="ascii")
            .strip()
            for colour in ("red", "green")
        ]

    # Ten milliseconds a tick have the battery read every three seconds.
    with robot_on(live, "--tick", "0.01") as robot:
        wait_until(lambda: lights() == ["0", "255"])
        log = Log(robot.info())
        robot.add_tap(log)
        inject(live, "battery 5.8")
        robot.wait(60.0, until=lambda: any(event["event"] == "stop" for event in log.events))
        wait_until(lambda: lights() == ["255", "0"])
        assert "the battery is empty" in robot.status()["reason"]
        assert [
            event["event"] for event in log.events if event["event"] in ("battery", "stop")
        ] == ["battery", "stop"]
        assert text(live, "outB", "state") == ""
    assert lights() == ["0", "0"]
