"""The watchdog process over a tree of plain files: whatever ends or stops the loop's process, the motors are told to stop."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

import robot
from robot.motors import MotorFault
from robot.watchdog import MOST_UNANSWERED, SILENCE_S, Watchdog, stop_all, watch

PATIENCE_S = 20.0


@pytest.fixture
def tree(tmp_path):
    """Two motors that run."""
    for number in range(2):
        (tmp_path / "tacho-motor" / ("motor" + str(number))).mkdir(parents=True)
    run(tmp_path)
    return tmp_path


def stopped(tree):
    """Whether every motor has been told to stop, with a stored duty of 0."""
    motors = list((tree / "tacho-motor").iterdir())
    return all((motor / "command").read_text() == "stop" and (motor / "duty_cycle_sp").read_text() == "0" for motor in motors)


def run(tree):
    """The motors run again."""
    for motor in (tree / "tacho-motor").iterdir():
        (motor / "command").write_text("")
        (motor / "duty_cycle_sp").write_text("9")


def fault(dog):
    """Feed the watchdog until that tells of a fault. Returns its words."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        try:
            dog.feed()
        except MotorFault as told:
            return str(told)
        time.sleep(0.001)
    return "nothing"


def eventually(condition):
    """Whether it comes true, given time enough for any machine."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.01)
    return False


_LOOP = """
import os, signal, sys, time
from robot.watchdog import Watchdog
dog = Watchdog(sys.argv[1])
print(dog.pid, flush=True)
end = sys.argv[2]
for beat in range(10**6):
    dog.feed()
    time.sleep(0.02)
    if beat == 20 and end != "live":
        if end == "segv":
            os.kill(os.getpid(), signal.SIGSEGV)
        if end == "leave":
            dog.close()
            sys.exit()
        if end == "raise":
            raise RuntimeError("the loop failed")
        time.sleep(3600)
"""


def loop_process(tree, end):
    """A process that feeds its watchdog until it comes to its end."""
    environment = dict(os.environ, PYTHONPATH=robot.__path__[0] + "/..")
    command = [sys.executable, "-c", _LOOP, str(tree), end]
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


@pytest.mark.parametrize("end", ["segv", "raise", "hang"])
def test_motors_stop_when_the_loop_comes_to_an_end(tree, end):
    with loop_process(tree, end) as process:
        assert eventually(lambda: stopped(tree))
        process.kill()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP, signal.SIGTERM])
def test_motors_stop_when_the_loop_is_killed_or_frozen(tree, number):
    with loop_process(tree, "live") as process:
        process.stdout.readline()
        time.sleep(0.3)
        assert not stopped(tree)
        process.send_signal(number)
        assert eventually(lambda: stopped(tree))
        process.kill()


def test_a_watchdog_that_was_killed_is_noticed_by_the_loop(tree):
    dog = Watchdog(str(tree))
    dog.feed()
    os.kill(dog.pid, signal.SIGKILL)
    with pytest.raises(MotorFault, match="watchdog"):
        for _ in range(MOST_UNANSWERED + 1):
            dog.feed()
    dog.close()


def test_a_watchdog_that_was_frozen_is_noticed_by_the_loop(tree):
    dog = Watchdog(str(tree))
    os.kill(dog.pid, signal.SIGSTOP)
    with pytest.raises(MotorFault, match="does not answer"):
        for _ in range(MOST_UNANSWERED + 1):
            dog.feed()
    os.kill(dog.pid, signal.SIGCONT)
    dog.close()


def test_a_loop_that_froze_and_came_back_finds_itself_stopped_and_can_go_on(tree):
    dog = Watchdog(str(tree))
    for _ in range(3):
        run(tree)
        dog.feed()
        assert eventually(lambda: stopped(tree))  # nobody feeds it any more
        assert "was silent for 0.2 s" in fault(dog)
        for _ in range(2 * MOST_UNANSWERED):
            dog.feed()
            time.sleep(0.001)
    dog.close()


def test_a_program_that_takes_long_to_start_is_not_taken_for_dead(tree):
    dog = Watchdog(str(tree))
    time.sleep(3 * SILENCE_S)
    for _ in range(3):
        dog.feed()
    assert not stopped(tree)
    dog.close()
    assert stopped(tree)


def test_the_watchdog_leaves_motors_alone_while_it_is_fed(tree):
    one, other = socket.socketpair()
    stops = []
    watching = threading.Thread(target=lambda: watch(other, stops.append, silence_s=PATIENCE_S))
    watching.start()
    for _ in range(100):
        one.send(b".")
        assert one.recv(1) == b"."
    assert stops == []
    one.close()
    watching.join(PATIENCE_S)
    assert stops == ["the loop's process has died"]


@pytest.mark.parametrize(("end", "words"), [("segv", "the loop's process has died; motors stopped"), ("leave", "")])
def test_the_watchdog_says_why_it_stopped_the_motors_unless_the_loop_took_leave(tree, end, words):
    with loop_process(tree, end) as process:
        said = process.communicate()[1].decode()
    assert stopped(tree)
    assert ("watchdog: " + words in said) if words else said == ""


def test_a_motor_that_cannot_be_stopped_does_not_spare_the_others(tree):
    broken = tree / "tacho-motor" / "motor0" / "command"
    broken.unlink()
    failed = stop_all(str(tree))
    assert len(failed) == 1
    assert "motor0/command" in failed[0]
    assert (tree / "tacho-motor" / "motor1" / "command").read_text() == "stop"
