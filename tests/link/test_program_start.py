"""How the robot's program starts, and what it survives that has nothing to do with the robot."""

import os
import pty
import select
import signal
import socket
import subprocess
import sys
import time
import tty
from pathlib import Path

import pytest

from robot import token

ROOT = Path(__file__).resolve().parents[2]
PATIENCE_S = 20.0


def robot(*arguments, **options):
    """A simulated robot's program, which is the robot's own but for its motors."""
    return subprocess.Popen(
        [sys.executable, "-m", "sim_motor", "--port", "0", *arguments],
        cwd=ROOT,
        text=True,
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--serial", "/dev/nosuch"), "/dev/nosuch cannot be opened: No such file"),
        (("--serial", "/dev/null"), "not a serial line"),
        (("--serial", "/dev/nosuch@fast"), "names no serial line"),
        (("--serial", ""), "names no serial line"),
        (("--host", "a..b"), "cannot listen on a..b"),
        (("--host", "a" * 70), "cannot listen on aaaa"),
        (("--host", "\u00fc" * 60 + ".local"), "cannot listen on"),
    ],
)
def test_what_cannot_work_is_refused_before_the_robot_is_ready(arguments, words):
    with robot(*arguments) as process:
        out, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


def line_of(stream):
    """The next line that a process prints."""
    assert select.select([stream], (), (), PATIENCE_S)[0]
    return stream.readline()


def test_a_line_that_vanishes_is_said_and_the_robot_runs_on(tmp_path):
    token.load_or_make(str(tmp_path / "token"))
    far, near = pty.openpty()
    tty.setraw(far)
    # A name of its own: the kernel may give the number of the terminal that ends to the next one.
    cable = tmp_path / "ttyUSB0"
    cable.symlink_to(os.ttyname(near))
    with robot("--serial", str(cable)) as process:
        try:
            assert line_of(process.stdout).startswith("READY tcp://127.0.0.1:")
            cable.unlink()
            os.close(far)
            os.close(near)
            assert "broke" in line_of(process.stderr)
            assert process.poll() is None
        finally:
            process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE_S) == 0


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_a_full_card_does_not_keep_the_robot_from_starting(host):
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with (
        Path("/dev/full").open("w") as full,
        robot("--host", host, "--port", str(port), stdout=full, stderr=full) as process,
    ):
        try:
            until = time.monotonic() + PATIENCE_S
            while True:
                assert process.poll() is None
                try:
                    socket.create_connection(("127.0.0.1", port), 1.0).close()
                    break
                except ConnectionRefusedError:
                    assert time.monotonic() < until
                    time.sleep(0.05)
        finally:
            process.kill()
