"""The watchdog stops the motors of a loop that never sleeps, where there is one processor only."""

import os
import signal
import subprocess
import sys

import pytest

from robot import schedule
from tests.sysfs.plain import plain_motor

ROOT = schedule.__file__.rpartition("robot")[0]
# The robot's program, on one processor. At a signal its loop burns a quarter of a second of that
# processor's time without a break, and says which command the motors have had by then.
PROGRAM = """
import os, signal, sys, time
os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
from robot import __main__

command = sys.argv.pop(1)

def burn(number, frame):
    until = time.process_time() + 0.25
    while time.process_time() < until:
        pass
    with open(command) as file:
        os.write(1, "{}\\n".format(file.read(4)).encode())

signal.signal(signal.SIGUSR1, burn)
sys.exit(__main__.main())
"""


def may_have_priority():
    """Whether this user may have real-time priority, tried out in a process of its own."""
    words = "from robot import schedule as s; print(s.take_priority(s.WATCHDOG_PRIORITY))"
    return subprocess.check_output([sys.executable, "-c", words], cwd=ROOT) == b"True\n"


@pytest.mark.skipif(
    not may_have_priority(),
    reason="this user may have no real-time priority: run the tests as root, or raise `ulimit -r`",
)
def test_a_loop_that_never_sleeps_is_stopped_on_one_processor(tmp_path):
    motors = [
        plain_motor(tmp_path / "class", 0, "outB"),
        plain_motor(tmp_path / "class", 1, "outC"),
    ]
    command = str(motors[1] / "command")
    arguments = ["--sysfs", str(tmp_path / "class"), "--host", "127.0.0.1", "--port", "0"]
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, command, *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    try:
        assert process.stdout.readline().startswith(b"READY")
        while not (motors[1] / "command").read_text().startswith("run-"):
            assert process.poll() is None
        assert os.sched_getscheduler(process.pid) == os.SCHED_FIFO
        process.send_signal(signal.SIGUSR1)
        assert process.stdout.readline() == b"stop\n"
        process.terminate()
        assert b"the loop was silent" in process.communicate()[1]
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()
