"""The watchdog process over a tree of plain files.

Whatever ends or stops the loop's process, the motors are told to stop.
"""

import os
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import suppress

import pytest

import robot
from robot import watchdog as watchdog_module
from robot.motors import MotorFault
from robot.record import STATES
from robot.watchdog import MOST_UNANSWERED, SILENCE_S, Watchdog, stop_all, watch
from tests.rig import Rig

PATIENCE_S = 20.0


@pytest.fixture
def tree(tmp_path):
    """Two motors that run."""
    for number in range(2):
        (tmp_path / "tacho-motor" / ("motor" + str(number))).mkdir(parents=True)
    run(tmp_path)
    return tmp_path


def stopped(tree):
    """Whether every motor has been reasons to stop, with a stored duty of 0."""
    motors = list((tree / "tacho-motor").iterdir())
    return all(
        (motor / "command").read_text() == "stop" and (motor / "duty_cycle_sp").read_text() == "0"
        for motor in motors
    )


def run(tree):
    """The motors run again."""
    for motor in (tree / "tacho-motor").iterdir():
        (motor / "command").write_text("")
        (motor / "duty_cycle_sp").write_text("9")


def eventually(condition):
    """Whether it comes true, given time enough for any machine."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.01)
    return False


def alive(pid):
    """Whether there is such a process, other than one that waits to be buried."""
    try:
        # As Python 3.5 has it.
        with open("/proc/{}/stat".format(pid)) as file:  # noqa: PTH123, UP032
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


_LOOP = """
import os, signal, sys, time
from robot.record import STATES
from robot.watchdog import Watchdog, stop_all
dog = Watchdog(lambda: stop_all(sys.argv[1]), lambda: None)
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
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


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
    dog = Watchdog(lambda: stop_all(str(tree)), lambda: None)
    dog.feed()
    os.kill(dog.pid, signal.SIGKILL)
    with pytest.raises(MotorFault, match="watchdog"):
        for _ in range(MOST_UNANSWERED + 1):
            dog.feed()
    dog.close()


def test_a_watchdog_that_was_frozen_is_noticed_by_the_loop(tree):
    dog = Watchdog(lambda: stop_all(str(tree)), lambda: None)
    os.kill(dog.pid, signal.SIGSTOP)
    with pytest.raises(MotorFault, match="does not answer"):
        for _ in range(MOST_UNANSWERED + 1):
            dog.feed()
    os.kill(dog.pid, signal.SIGCONT)
    dog.close()


def test_a_loop_that_froze_and_came_back_finds_itself_stopped_and_can_go_on(tree):
    dog = Watchdog(lambda: stop_all(str(tree)), lambda: None)
    for _ in range(3):
        run(tree)
        dog.feed()
        assert eventually(lambda: stopped(tree))  # nobody feeds it any more
        assert eventually(dog.feed)
        for _ in range(2 * MOST_UNANSWERED):
            dog.feed()
            assert select.select([dog._link], (), (), PATIENCE_S)[0]  # a busy machine needs time
    dog.close()


def test_a_stop_under_way_when_the_loop_wakes_is_no_other_silence(tree):
    """Who clears the fault and starts the robot at once would find it in fault again."""
    dog = Watchdog(lambda: stop_all(str(tree)), lambda: None)
    dog._link.close()
    dog._link, end = socket.socketpair()
    dog._link.setblocking(False)
    end.send(b"!")

    def stop_and_listen():
        beat = end.recv(64)  # the loop is awake
        end.send(b"!")
        end.send(beat)

    with end:
        watchdog = threading.Thread(target=stop_and_listen)
        watchdog.start()
        assert dog.feed()
        watchdog.join()
        assert not dog.feed()
    dog.close()


def test_the_alarm_is_given_each_time_and_the_loop_learns_of_it_although_it_stands(tree):
    """Its lights are red then, and nobody else would make them show its state again."""
    reader, writer = os.pipe()
    woken = []
    dog = Watchdog(
        lambda: stop_all(str(tree)), lambda: os.write(writer, b"!"), lambda: woken.append("woken")
    )
    loop = Rig().loop

    def noticed():
        loop.tick()
        dog.serve(loop)
        return bool(woken)

    for _ in range(2):
        noticed()
        assert os.read(reader, 1) == b"!"
        assert eventually(noticed)
        woken.clear()
    assert STATES[loop.safety.state] == "idle"
    dog.close()
    os.close(reader)
    os.close(writer)


def test_a_program_that_takes_long_to_start_is_not_taken_for_dead(tree):
    dog = Watchdog(lambda: stop_all(str(tree)), lambda: None)
    time.sleep(3 * SILENCE_S)
    for _ in range(3):
        dog.feed()
    assert not stopped(tree)
    dog.close()
    assert stopped(tree)


def test_the_watchdog_leaves_motors_alone_while_it_is_fed(tree):
    one, other = socket.socketpair()
    stops = []
    watching = threading.Thread(
        target=lambda: watch(
            other, lambda reason: stops.append(reason) or True, silence_s=PATIENCE_S
        )
    )
    watching.start()
    for _ in range(100):
        one.send(b".")
        assert one.recv(1) == b"."
    assert stops == []
    one.close()
    watching.join(PATIENCE_S)
    assert stops == ["the loop's process has died"]


@pytest.mark.parametrize(
    ("end", "words"), [("segv", "the loop's process has died; motors stopped"), ("leave", "")]
)
def test_the_watchdog_says_why_it_stopped_the_motors_unless_the_loop_took_leave(tree, end, words):
    with loop_process(tree, end) as process:
        said = process.communicate()[1].decode()
    assert stopped(tree)
    assert ("watchdog: " + words in said) if words else said == ""


def test_a_motor_that_cannot_be_stopped_does_not_spare_the_others(tree):
    broken = tree / "tacho-motor" / "motor0" / "command"
    broken.unlink()
    broken.mkdir()
    assert stop_all(str(tree)) == ["motor0: Is a directory"]
    assert (tree / "tacho-motor" / "motor1" / "command").read_text() == "stop"


def test_a_motor_that_runs_on_is_told(tree):
    (tree / "tacho-motor" / "motor1" / "duty_cycle").write_text("9")
    assert stop_all(str(tree)) == ["motor1: it runs on"]


def test_a_motor_that_is_gone_is_no_trouble(tree):
    (tree / "tacho-motor" / "motor0" / "duty_cycle_sp").unlink()
    (tree / "tacho-motor" / "motor0").chmod(0o500)  # nor could anybody make it anew
    (tree / "tacho-motor" / "motor2").symlink_to(tree / "nowhere")
    assert stop_all(str(tree)) == []


SILENT, DEAD = "the loop was silent for 0.05 s", "the loop's process has died"


def watching(stop, silence_s=0.05):
    """(the loop's end of a link after one answered beat, the thread that watches the other)."""
    one, other = socket.socketpair()
    thread = threading.Thread(target=lambda: watch(other, stop, silence_s=silence_s), daemon=True)
    thread.start()
    one.send(b".")
    assert one.recv(1) == b"."
    return one, thread


def test_motors_that_do_not_obey_while_the_loop_is_silent_are_told_again_until_they_do():
    reasons = []
    link, thread = watching(lambda reason: reasons.append(reason) or len(reasons) >= 3)
    # One for each time, for the loop may have driven the motors in between.
    assert [link.recv(1) for _ in range(3)] == [b"!"] * 3
    link.close()
    thread.join(PATIENCE_S)
    assert reasons[:3] == [SILENT] * 3
    assert set(reasons[3:-1]) <= {""}
    assert reasons[-1] == DEAD


def test_a_loop_that_wakes_and_hangs_again_before_a_beat_is_stopped_again():
    """It may have driven the motors in between. The reason is given only for the first stop."""
    reasons = []
    link, thread = watching(lambda reason: reasons.append(reason) or True)
    assert eventually(lambda: len(reasons) >= 3)
    assert [*reasons[:3]] == [SILENT, "", ""]
    link.send(b".")
    assert eventually(lambda: SILENT in reasons[3:])
    link.close()
    thread.join(PATIENCE_S)
    assert reasons[-1] == DEAD


def test_a_loop_that_reads_nothing_does_not_keep_the_watchdog_from_stopping_the_motors(monkeypatch):
    monkeypatch.setattr(watchdog_module, "AGAIN_S", 1e-5)
    reasons = []
    link, thread = watching(lambda reason: reasons.append(reason) or reason == DEAD)
    assert eventually(lambda: len(reasons) > 5000)  # more than the link can hold
    link.close()
    thread.join(PATIENCE_S)
    assert reasons[-1] == DEAD


def test_motors_that_do_not_obey_when_the_loop_is_dead_are_told_again_until_they_do():
    reasons = []
    link, thread = watching(
        lambda reason: reasons.append(reason) or len(reasons) >= 3, silence_s=PATIENCE_S
    )
    link.close()
    thread.join(PATIENCE_S)
    assert reasons == [DEAD] * 3


def test_a_loop_that_lives_again_is_watched_again_though_the_motors_did_not_obey():
    reasons = []
    link, thread = watching(lambda reason: reasons.append(reason) or reason == DEAD)
    assert link.recv(1) == b"!"
    link.send(b".")
    assert link.recv(1) == b"."
    assert link.recv(1) == b"!"
    link.close()
    thread.join(PATIENCE_S)
    assert reasons[-1] == DEAD
    assert set(reasons[:-1]) == {SILENT}


@pytest.mark.parametrize("where", ["full", "blocked"])
def test_words_that_nobody_takes_do_not_keep_the_watchdog_from_its_work(tree, where):
    """Standard error on a full disk, or a terminal that was stopped."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with suppress(BlockingIOError):
        while True:
            os.write(writer, b"." * 4096)
    os.set_blocking(writer, True)
    error = os.open("/dev/full", os.O_WRONLY) if where == "full" else os.dup(writer)
    command = [sys.executable, "-c", _LOOP, str(tree), "live"]
    environment = dict(os.environ, PYTHONPATH=robot.__path__[0] + "/..")
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=error
    ) as process:
        try:
            watchdog = int(process.stdout.readline())
            time.sleep(0.3)
            process.send_signal(signal.SIGSTOP)
            assert eventually(lambda: stopped(tree))
            os.kill(watchdog, 0)
            run(tree)
        finally:
            process.kill()
        assert eventually(lambda: stopped(tree))
        process.wait()
        assert eventually(lambda: not alive(watchdog))
    for descriptor in (reader, writer, error):
        os.close(descriptor)


def test_a_watchdog_tries_on_when_the_program_ends_although_the_motors_do_not_obey(tree, capfd):
    """As after SIGTERM, while a motor answers with errors for some seconds."""
    deaf = tree / "deaf"
    deaf.touch()

    def stop():
        return ["motor0: Input/output error"] if deaf.exists() else stop_all(str(tree))

    dog = Watchdog(stop, lambda: None)
    dog.feed()
    ending = threading.Thread(target=dog.close)
    ending.start()
    ending.join(1.5 * watchdog_module.FAREWELL_S)
    assert ending.is_alive()
    deaf.unlink()
    ending.join(PATIENCE_S)
    assert stopped(tree)
    assert not alive(dog.pid)
    assert capfd.readouterr().err.splitlines() == [
        "watchdog: not stopped: motor0: Input/output error",
        "watchdog: motors stopped",
    ]


def test_a_watchdog_that_is_stuck_does_not_keep_the_program_from_ending(tree, monkeypatch):
    monkeypatch.setattr(watchdog_module, "FAREWELL_S", 0.1)
    monkeypatch.setattr(watchdog_module, "LONGEST_S", 0.0)
    dog = Watchdog(lambda: stop_all(str(tree)), lambda: None)
    dog.feed()
    monkeypatch.setattr(watchdog_module.signal, "SIGCONT", 0)  # so that nothing wakes it
    os.kill(dog.pid, signal.SIGSTOP)
    dog.close()
    assert not alive(dog.pid)
