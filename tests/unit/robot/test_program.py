"""The robot's program: what it prints, and what becomes of an error in it."""

import os
import subprocess
import sys

import pytest

import robot
from robot import program
from tests.rig import Rig

ROOT = robot.__file__.rpartition("robot")[0]


def said(*arguments, **environment):
    """The exit status of the program, and what it wrote to both streams."""
    done = subprocess.Popen(
        [sys.executable, "-m", "robot", *arguments],
        cwd=ROOT,
        env=dict(os.environ, **environment),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    out, err = done.communicate()
    return done.returncode, out, err


@pytest.mark.parametrize("locale", [{"LC_ALL": "C"}, {"PYTHONIOENCODING": "ascii"}])
def test_help_is_printed_in_every_locale_although_a_path_in_it_is_foreign(locale):
    status, out, err = said("--help", HOME="/home/Zo\u00eb", KICK_TOKEN="", **locale)
    assert (status, err) == (0, b"")
    assert b"--token" in out


def test_a_wrong_argument_is_told_in_every_locale():
    status, out, err = said(
        "--motors", "Zo\u00eb", "--idle", "--port", "0", PYTHONIOENCODING="ascii", LC_ALL="C"
    )
    assert (status, out) == (2, b"")
    assert b"names no factory" in err
    assert b"Traceback" not in err


class Server:
    """Counts how often the hosts could hear the robot."""

    def __init__(self):
        self.served = 0

    def serve(self, timeout_s):
        self.served += 1


@pytest.mark.parametrize("error", [TypeError, SystemExit])
@pytest.mark.parametrize("where", ["read", "stop", "serve"])
def test_a_programming_error_stops_the_motors_and_names_itself(where, error):
    """Also one in what stops a motor, or in what serves the hosts."""
    rig, server = Rig(), Server()
    rig.loop.start()

    def broken(*arguments):
        raise error("the dog ate it")

    if where == "read":
        rig.motors[0].angle_rad = broken
    elif where == "stop":
        rig.motors[0].angle_rad = rig.motors[0].stop = broken
    with pytest.raises(error, match="the dog ate it"):
        program._run(rig.loop, server, broken if where == "serve" else server.serve)
    assert "the dog ate it" in rig.loop.safety.reason
    assert rig.motors[1].done[-1] == "stop"
    assert server.served == {"read": 2, "stop": 2, "serve": 1}[where]
