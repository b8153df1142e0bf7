"""docs/lesson.md: what it says of a robot in a process of its own, typed as it is written.

The port must be free and is another one, and `python` is this one.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from host.client.robot import connect
from host.logs.log import Log
from robot.kicks import WHEELS
from tests.cli.test_desk import desk_robot
from tests.cli.test_lesson import DESK, commands, shown

START, *STEP_4 = commands(DESK[0])
REAL = commands(DESK[1])
PATIENCE_S = 100.0
# Eighteen programs begin one after the other, beside twenty seconds of recording.
pytestmark = pytest.mark.timeout(400)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("lesson")


@pytest.fixture(scope="module")
def answers(folder):
    """What each command prints, those of step 4 first and then those for a real robot."""
    python, dash_m, program, port, number, *arguments = START.split()
    assert (python, dash_m, program, port) == ("python", "-m", "sim_motor", "--port")
    assert STEP_4[0] == f"export KICK_BRICK=tcp://127.0.0.1:{number}"
    assert STEP_4[-1] == "unset KICK_BRICK"
    with desk_robot(folder, *arguments) as (uri, _):
        # A person goes to the other terminal; by then the neurons have settled.
        with connect(uri, observe=True) as robot:
            robot.wait(3.0)
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        environment = {
            **os.environ,
            "PATH": path,
            "KICK_BRICK": uri,
            "KICK_TOKEN": str(folder / "token"),
        }

        def answer(line):
            done = subprocess.run(
                ["sh", "-c", line],
                env=environment,
                cwd=folder,
                capture_output=True,
                text=True,
                timeout=PATIENCE_S,
                check=False,
            )
            assert done.returncode == 0, line + done.stdout + done.stderr
            return done.stdout + done.stderr

        return {
            title: [(line, answer(line)) for line in lines]
            for title, lines in zip(DESK, (STEP_4[1:-1], ["kickctl start", *REAL]), strict=True)
        }


def test_a_rest_that_stays(answers):
    before, raised, driven, after, _ = (answer for _, answer in answers[DESK[0]])
    assert "the left wheel rests, with a torque of |M| = 0.00" in before
    assert "k = 0 is too small for wheels that roll" in before
    assert "the left wheel rests" not in raised
    assert [line for line in shown(DESK[0]) if line not in raised] == []
    assert "The robot reached forward" in driven
    assert "rests" not in after


def test_the_steps_on_a_real_robot(answers, folder):
    said = {line.partition("#")[0].strip(): answer for line, answer in answers[DESK[1]]}
    assert said["kickctl kick --mode phase --ticks 4"].startswith("The kick reversed the robot")
    assert re.search(r"^k = 8\.0$", said["kickctl params reset"], re.MULTILINE)
    assert said["kickctl stop"].startswith("motors stopped")
    rest, roll, wall = (Log.load(folder / f"{name}.mcap") for name in ("rest", "roll", "wall"))
    for side in WHEELS:
        angles = side + "_phi_rad"
        assert len(set(rest.column(angles)[-33:])) == 1
        assert roll.column(angles)[-1] - roll.column(angles)[0] > 40.0
        assert wall.column(angles)[-1] - wall.column(angles)[0] > 20.0
    chaos = Log.load(folder / "chaos.mcap")
    assert chaos.info["params"]["k"] == 15.0
