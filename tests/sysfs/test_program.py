"""The robot's program over the live tree.

How it starts, what it refuses, and motors that stop however badly they obey.
"""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from random import Random

import pytest

from host.logs.log import Log
from host.logs.mcap_files import LogError
from tests.live import PORTS, Live, impatient, wait_until
from tests.sysfs.mount import ROOT, mounted, needs_mount

pytestmark = needs_mount


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    with mounted(tmp_path_factory.mktemp("program") / "sys", "--seed", "2") as mount, impatient():
        yield mount


@pytest.fixture
def live(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    with Live(folder) as robot:
        robot.run(Random(1))
        yield robot


def python(*arguments):
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_a_second_program_leaves_the_first_alone(live):
    with live.watch() as watch:
        done = python("robot", "--sysfs", str(live.folder), "--port", "0")
        assert done.returncode == 2
        assert "another robot's program drives the motors" in done.stderr
        assert watch.running() == len(PORTS)
    assert live.state() == "running"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--left", "outZ"), "--left cannot be 'outZ': it is one of outA, outB, outC, outD"),
        (("--left", "outC"), "both motors cannot be at outC"),
        (("--set", "speed=3"), "there is no parameter 'speed'"),
        (("--set", "polarity_left"), "--set NAME=VALUE"),
        (("--set", "k=fast"), "k cannot be 'fast'"),
        (("--set", "k=2,5"), "k cannot be '2,5'; write a point: 2.5"),
        (("--port", "70000"), "cannot listen"),
    ],
)
def test_wrong_arguments_are_told_in_words_and_nothing_else_is(folder, tmp_path, arguments, words):
    done = python(
        "robot",
        "--sysfs",
        str(folder),
        "--port",
        "0",
        "--token",
        str(tmp_path / "token"),
        *arguments,
    )
    assert done.returncode == 2
    assert words in done.stderr
    assert "watchdog" not in done.stderr
    assert "Traceback" not in done.stderr


def test_parameters_are_there_from_the_first_tick(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    with Live(
        folder, "--set", "k=2", "--set", "polarity_right=-1", "--set", "link_loss=hold"
    ) as robot:
        params = robot.robot.status()["params"]
    assert (params["k"], params["polarity_right"], params["link_loss"]) == (2.0, -1, "hold")


@pytest.mark.parametrize("end", ["frozen", "killed"])
def test_motors_that_do_not_obey_at_first_stop_all_the_same(live, end):
    """More errors than one attempt to stop can meet, and nobody but the watchdog to try again."""
    with live.watch([PORTS[1]]) as watch:
        live.process.send_signal(signal.SIGSTOP)
        live.inject(f"eio {PORTS[0]} 9")
        if end == "killed":
            live.process.kill()
        wait_until(lambda: not watch.running(), "the other motor stops")
        time.sleep(1.0)  # so that errors meet the program's attempts, and not these looks

        def stopped():
            with suppress(OSError), live.watch([PORTS[0]]) as disturbed:
                return not disturbed.running()
            return False

        wait_until(stopped, "the disturbed motor stops")
    if end == "frozen":
        live.process.send_signal(signal.SIGCONT)
        live.reason_of("fault")
        live.robot.clear()


def test_a_silence_of_a_robot_that_does_not_run_is_no_fault(live):
    live.robot.stop()
    live.process.send_signal(signal.SIGSTOP)
    time.sleep(0.5)
    live.process.send_signal(signal.SIGCONT)
    live.robot.wait(0.3)
    assert live.state() == "stopped"
    live.run(Random(1))


def test_what_cannot_be_mended_is_not_cleared(live):
    os.kill(live.watchdog, signal.SIGKILL)
    live.reason_of("fault")
    assert "the fault stays: the watchdog has ended" in live.refusal(live.robot.clear)


def test_the_lights_are_red_when_the_program_is_dead(live):
    red, green = (
        live.folder / "leds" / f"led0:{colour}:brick-status" / "brightness"
        for colour in ("red", "green")
    )
    assert (red.read_text().strip(), green.read_text().strip()) == ("0", "255")
    live.process.kill()
    wait_until(
        lambda: (red.read_text().strip(), green.read_text().strip()) == ("255", "0"),
        "the lights are red",
    )


def test_a_record_tells_of_a_fault(live, tmp_path):
    log = tmp_path / "log.mcap"
    command = ("host", "--brick", live.address, "--json", "record", "4", "--out", str(log))
    with ThreadPoolExecutor() as pool:
        recording = pool.submit(python, *command)
        wait_until(lambda: _holds_ticks(log), "the first second is recorded")
        live.inject("unplug " + PORTS[0])
        done = recording.result()
    assert done.returncode == 5
    assert "its cable came off" in json.loads(done.stdout)["fault"]
    live.inject("replug " + PORTS[0])


def _holds_ticks(path):
    try:
        return len(Log.load(path)) > 0
    except LogError:  # it is not there yet, or does not say what it is
        return False


@pytest.mark.parametrize("line", ["eio outB -1", "eio outB many", "eio outZ 1"])
def test_faults_that_make_no_sense_are_refused(folder, line):
    with pytest.raises(OSError, match="Invalid argument"):
        (folder / ".faults").write_text(line)
