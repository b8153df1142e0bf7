"""robot.health asks the robot's program on this machine.

Here the program runs in a thread of the test.
"""

import os
import socket
import subprocess
import sys
import threading
from contextlib import contextmanager

import pytest

from robot import health, wire
from robot.health import Unwell, examine, main
from robot.loop import Loop
from robot.motors import MonotonicClock
from robot.server import Server
from robot.sources import of_robot
from tests.rig import TOKEN, Motor

HOST = "127.0.0.1"
# Where `python -m robot` finds the robot.
ROOT = health.__file__.rpartition("robot")[0]


@contextmanager
def robot(ticks=True):
    """(port, loop) of a robot that answers, and ticks or not."""
    loop = Loop((Motor(), Motor()), None, MonotonicClock(), 1)
    server = Server(loop, TOKEN)
    port = server.listen("127.0.0.1", 0)

    def answer():
        while not loop.done:
            server.serve(0.2)  # one turn may take that long on a busy machine

    thread = threading.Thread(target=(lambda: loop.run(server.serve)) if ticks else answer)
    thread.start()
    try:
        yield port, loop
    finally:
        loop.done = True
        thread.join()
        server.close()


def listening():
    """A socket on this machine that takes connections."""
    listener = socket.socket()
    listener.bind(("127.0.0.1", 0))
    listener.listen(1)
    return listener


@contextmanager
def program(answers):
    """The port of a program that sends these bytes to whoever connects, and hangs up."""
    with listening() as listener:

        def serve():
            link = listener.accept()[0]
            link.recv(4096)
            link.sendall(answers)
            link.close()

        thread = threading.Thread(target=serve)
        thread.start()
        yield listener.getsockname()[1]
        thread.join()


def hello(**changes):
    answer = {
        "software": health.__version__,
        "sources": of_robot(),
        "nonce": "00" * wire.NONCE_BYTES,
        "boot": "1",
    }
    return wire.encode_json(wire.HELLO, {**answer, **changes})


def test_a_robot_that_ticks_is_well():
    with robot() as (port, _):
        assert examine(HOST, port, TOKEN)["state"] == "idle"


def test_a_robot_on_which_watchers_have_taken_all_places_is_well(monkeypatch):
    monkeypatch.setattr("robot.server.PLACES", 0)
    with robot() as (port, _):
        assert examine(HOST, port, TOKEN)["state"] == "idle"


def test_a_robot_in_fault_has_a_program_that_is_well(capsys, monkeypatch, tmp_path):
    (tmp_path / "token").write_text(TOKEN.hex(), encoding="ascii")
    (tmp_path / "token").chmod(0o600)
    with robot() as (port, loop):
        loop.safety.fault("the cable is out")
        monkeypatch.setattr(
            "sys.argv", ["health", "--port", str(port), "--token", str(tmp_path / "token")]
        )
        assert main() == health.IN_FAULT
    assert (
        capsys.readouterr().out
        == "fault (the cable is out); mend that, then `kickctl clear` and `kickctl start`\n"
    )


def test_a_program_that_takes_connections_and_says_nothing_hangs(monkeypatch):
    monkeypatch.setattr(health, "PATIENCE_S", 0.1)
    words = r"it hangs: it has not answered for 0\.1 s"
    with listening() as listener, pytest.raises(Unwell, match=words):
        examine(HOST, listener.getsockname()[1], TOKEN)


def test_one_that_does_not_tick_is_not(monkeypatch):
    monkeypatch.setattr(health, "LONGEST_TICK_S", 0.1)
    with robot(ticks=False) as (port, _), pytest.raises(Unwell, match="does not tick"):
        examine(HOST, port, TOKEN)


def test_one_with_another_token_is_not():
    with robot() as (port, _), pytest.raises(Unwell, match="the token of another robot"):
        examine(HOST, port, bytes(wire.TOKEN_BYTES))


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        (b"", "hangs up"),
        (b"HTTP/1.1 400 Bad Request\r\n\r\n", "hangs up"),
        (hello(software="9.9.9"), "release 9.9.9"),
        (hello(sources="0123456789abcdef"), "sources 0123456789abcdef"),
        (hello(sources=None), "sources None"),
        (hello() + wire.encode_json(wire.AUTH, {"proof": "00" * 32}), "does not have the token"),
    ],
)
def test_what_is_no_robot_of_this_release_is_not(answers, words):
    with program(answers) as port, pytest.raises(Unwell, match=words):
        examine(HOST, port, TOKEN)


@pytest.mark.parametrize(
    "answers",
    [
        wire.encode(wire.HELLO, b"[]"),
        wire.encode(wire.HELLO, b"{}"),
        wire.encode(wire.HELLO, b'{"error": "no"}'),
        hello(nonce="x"),
        hello(nonce=1),
        hello() + wire.encode_json(wire.AUTH, {"proof": None}),
        b"",
    ],
)
def test_any_trouble_is_a_line_and_a_status(capsys, monkeypatch, tmp_path, answers):
    (tmp_path / "token").write_text(TOKEN.hex(), encoding="ascii")
    (tmp_path / "token").chmod(0o600)
    with program(answers) as port:
        monkeypatch.setattr(
            "sys.argv", ["health", "--port", str(port), "--token", str(tmp_path / "token")]
        )
        assert main() == 1
    out = capsys.readouterr().out
    assert out.startswith("the robot's program at port " + str(port) + " is not well: ")
    assert out.count("\n") == 1


def test_nobody_there(capsys, monkeypatch, tmp_path):
    with listening() as listener:
        port = listener.getsockname()[1]
    monkeypatch.setattr(
        "sys.argv", ["health", "--port", str(port), "--token", str(tmp_path / "none")]
    )
    assert main() == 1
    assert "token" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("host", "asked"),
    [("0.0.0.0", "127.0.0.1"), ("::", "::1"), ("192.168.0.7", "192.168.0.7")],  # noqa: S104
)
def test_a_robot_is_asked_where_it_listens(capsys, monkeypatch, tmp_path, host, asked):
    def connect(address, timeout):
        raise OSError("asked at {} {}".format(*address))

    (tmp_path / "token").write_text(TOKEN.hex(), encoding="ascii")
    (tmp_path / "token").chmod(0o600)
    monkeypatch.setattr(socket, "create_connection", connect)
    monkeypatch.setattr("sys.argv", ["health", "--host", host, "--port", "7"])
    assert main() == health.UNWELL
    assert "asked at " + asked + " 7" in capsys.readouterr().out


def test_a_reason_with_letters_that_the_terminal_does_not_know(tmp_path):
    (tmp_path / "token").write_text(TOKEN.hex(), encoding="ascii")
    (tmp_path / "token").chmod(0o600)
    with robot() as (port, loop):
        loop.stop("'Zo\u00eb' stopped it")
        done = subprocess.run(
            [sys.executable, "-m", "robot.health", "--port", str(port)],
            cwd=ROOT,
            env=dict(os.environ, PYTHONIOENCODING="ascii", KICK_TOKEN=str(tmp_path / "token")),
            stdout=subprocess.PIPE,
            check=False,
        )
    assert (done.returncode, done.stdout) == (
        health.WELL,
        b"stopped ('Zo\\xeb' stopped it)\n",
    )
