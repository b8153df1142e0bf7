"""`kickctl watch` on a real terminal: its keys drive a desk robot, and the terminal comes back."""

import os
import pty
import re
import select
import signal
import sys
import termios
import time
from contextlib import contextmanager

import pytest

from host.client.robot import connect
from host.commands._keys import keys
from host.commands._watch_keys import KeyActions
from tests.cli.test_desk import desk_robot
from tests.lint.sources import ROOT

PATIENCE_S = 60.0  # nothing here takes so long; it only ends what would hang
FOOT = b"? help  q quit"


class Terminal:
    """A terminal, and the program that runs on it."""

    def __init__(self, folder, command, **environment):
        environment = {
            **os.environ,
            "KICK_TOKEN": str(folder / "token"),
            "PYTHONPATH": str(ROOT),
            "TERM": "xterm",
            "COLUMNS": "100",
            "LINES": "40",
            **environment,
        }
        self.pid, self.end = pty.fork()
        if self.pid == 0:
            os.execvpe(command[0], command, environment)  # noqa: S606 - the child of a fork
        self.before = termios.tcgetattr(self.end)
        self.seen = b""
        self.status = None

    def type(self, text):
        os.write(self.end, text)

    def read(self):
        """Take in what is there, or wait a moment for it. False at the end of the output."""
        if select.select([self.end], [], [], 0.1)[0]:
            try:
                self.seen += os.read(self.end, 65536)
            except OSError:
                return False
        return True

    def wait_for(self, words, since=0):
        """Read until the words appear after the place `since`; returns the place behind them."""
        until = time.monotonic() + PATIENCE_S
        while (place := self.seen.find(words, since)) < 0:
            assert time.monotonic() < until, f"no {words!r} before {self.seen[-900:]!r}"
            assert self.read(), f"no {words!r} before the end: {self.seen[-900:]!r}"
        return place + len(words)

    def wait(self):
        """The program's exit status."""
        until = time.monotonic() + PATIENCE_S
        while self.status is None:
            assert time.monotonic() < until, self.seen[-900:]
            self.read()
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.status = os.waitstatus_to_exitcode(status)
        while select.select([self.end], [], [], 0)[0] and self.read_rest():
            pass
        return self.status

    def read_rest(self):
        before = len(self.seen)
        return self.read() and len(self.seen) > before

    @property
    def gives_keys(self):
        return not termios.tcgetattr(self.end)[3] & (termios.ICANON | termios.ECHO)

    @property
    def shows_cursor(self):
        return self.seen.rfind(b"\x1b[?25h") > self.seen.rfind(b"\x1b[?25l")

    def close(self):
        if self.status is None:
            os.kill(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)
        os.close(self.end)


def watching(uri):
    return [sys.executable, "-m", "host", "--brick", uri, "watch"]


@contextmanager
def terminal(folder, command, **environment):
    """A Terminal with the command on it."""
    terminal = Terminal(folder, command, **environment)
    try:
        yield terminal
    finally:
        terminal.close()


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("desk")
    with desk_robot(folder) as (uri, _):
        yield folder, uri


def restarted(folder, uri):
    """Have the desk robot run; returns a host that drives it while it is open."""
    robot = connect(uri, token=str(folder / "token"), name="teacher")
    if robot.status()["state"] != "running":
        robot.start()
    return robot


def test_keys_kick_and_stop_a_robot_and_q_leaves(desk):
    folder, uri = desk
    with restarted(folder, uri):
        pass
    with terminal(folder, watching(uri)) as screen:
        screen.wait_for(FOOT)
        assert screen.gives_keys
        screen.type(b"1")
        place = screen.wait_for(b"kick membrane, 1 tick")
        screen.wait_for(b"kick: membrane", place - 1000)  # also shown a second later
        screen.type(b"\x1b[1~?")  # Home is no kick
        place = screen.wait_for(b"membrane inversion: both neurons change sign", place)
        screen.type(b"?")
        place = screen.wait_for(FOOT, place)
        screen.type(b" ")
        place = screen.wait_for(b"stop: motors stopped before tick", place)
        screen.wait_for(b"stopped: ", place)
        screen.type(b"2")
        screen.wait_for(b"kick position: the robot refuses: the robot does not run", place)
        screen.type(b"q")
        assert screen.wait() == 0
        assert termios.tcgetattr(screen.end) == screen.before
        assert screen.shows_cursor
        assert len(set(re.findall(rb"tick \d+: kick membrane", screen.seen))) == 1


def test_who_may_not_kick_reads_why_and_goes_on_watching(desk):
    folder, uri = desk
    with restarted(folder, uri) as teacher:
        teacher.lease()
        with terminal(folder, watching(uri)) as screen:
            screen.wait_for(b"driven by teacher")
            screen.type(b"1")
            screen.wait_for(b"kick membrane: the robot refuses: ")
            screen.type(b"q")
            assert screen.wait() == 0
        with terminal(folder, watching(uri), KICK_TOKEN=str(folder / "none")) as screen:
            screen.wait_for(FOOT)
            screen.type(b"1")
            place = screen.wait_for(b"kick membrane: this computer does not have the robot's token")
            screen.type(b" ")
            screen.wait_for(b"stop: motors stopped before tick", place)
            screen.type(b"q")
            assert screen.wait() == 0
        assert teacher.status()["state"] == "stopped"


def test_a_stop_waits_for_no_thread_that_looks_for_the_robot(desk):
    """Whoever reconnects holds the connection's lock for up to ten seconds."""
    folder, uri = desk
    words = []
    with restarted(folder, uri) as robot:
        actions = KeyActions(robot.stop_at_once, words.append, words.append)
        with robot._lock:
            actions.press(" ")
            actions.close()
        assert words[-1].startswith("stop: motors stopped before tick")


def test_words_and_keys_go_on_while_a_robot_that_is_gone_is_looked_for(tmp_path):
    with desk_robot(tmp_path) as (uri, process), terminal(tmp_path, watching(uri)) as screen:
        screen.wait_for(FOOT)
        process.kill()
        place = screen.wait_for(b"looking for the robot for")
        screen.type(b" ")
        screen.wait_for(b"stop: ", place)
        screen.type(b"?")
        screen.wait_for(b"membrane inversion", place)
        assert b"Traceback" not in screen.seen


@pytest.mark.parametrize(
    "end", [b"\x03", signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=["^C", "INT", "TERM", "HUP"]
)
def test_the_terminal_is_restored_when_a_signal_ends_it(desk, end):
    folder, uri = desk
    with terminal(folder, watching(uri)) as screen:
        screen.wait_for(FOOT)
        assert screen.gives_keys
        if isinstance(end, bytes):
            screen.type(end)
        else:
            os.kill(screen.pid, end)
        assert screen.wait() == 0
        assert termios.tcgetattr(screen.end) == screen.before
        assert screen.shows_cursor
        assert b"Traceback" not in screen.seen


def test_a_key_that_would_end_it_without_restoring_the_terminal_is_off(desk):
    folder, uri = desk
    with terminal(folder, watching(uri)) as screen:
        place = screen.wait_for(FOOT)
        screen.type(b"\x1c?")
        screen.wait_for(b"membrane inversion", place)
        screen.type(b"q")
        assert screen.wait() == 0


def test_a_suspended_watch_gives_the_terminal_back_and_takes_it_again(desk):
    """A shell with jobs runs it: ^Z, a command of the shell, and fg."""
    folder, uri = desk
    line = " ".join(watching(uri))
    with terminal(folder, ["sh", "-i"], ENV="/dev/null", PS1="ready> ") as screen:
        screen.wait_for(b"ready> ")
        screen.type(f"set -m; {line}\n".encode())
        place = screen.wait_for(FOOT)
        assert screen.gives_keys
        screen.type(b"\x1a")
        place = screen.wait_for(b"ready> ", place)
        assert screen.shows_cursor
        screen.type(b"stty -a | tr ';' '\\n' | tr ' ' '\\n' | grep -x -e icanon -e echo\n")
        screen.wait_for(b"icanon\r\necho\r\n", place)
        screen.type(b"fg\n")
        place = screen.wait_for(FOOT, len(screen.seen))
        until = time.monotonic() + PATIENCE_S
        while not screen.gives_keys:
            assert time.monotonic() < until
            screen.read()
        screen.type(b"?")
        place = screen.wait_for(b"membrane inversion", place)
        screen.type(b"q")
        screen.wait_for(b"ready> ", place)
        assert not screen.gives_keys
        screen.type(b"exit\n")
        assert screen.wait() == 0


def test_an_error_restores_the_terminal(monkeypatch):
    near, far = pty.openpty()
    before = termios.tcgetattr(far)
    pressed = []
    with os.fdopen(far, "rb", buffering=0) as stdin, monkeypatch.context() as patch:
        patch.setattr(sys, "stdin", stdin)
        handler = signal.getsignal(signal.SIGTSTP)
        with pytest.raises(ValueError, match="odd"), keys(pressed.append, list, list):
            until = time.monotonic() + PATIENCE_S
            os.write(near, b"1")
            while not pressed:
                assert time.monotonic() < until
                time.sleep(0.001)
            raise ValueError("odd")
        assert termios.tcgetattr(stdin) == before
        assert signal.getsignal(signal.SIGTSTP) == handler
    os.close(near)
    assert pressed == ["1"]
