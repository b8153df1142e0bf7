"""docs/lesson.md: what it says of a robot in a process of its own, typed as it is written.

The port must be free and is another one, and kickctl runs in this process.
"""

import io
import re
import shlex
from contextlib import redirect_stderr, redirect_stdout

import pytest

from host.cli import main
from host.client.robot import connect
from host.logs.log import Log
from robot.kicks import WHEELS
from tests.cli.conftest import empty_figures
from tests.cli.test_desk import desk_robot
from tests.cli.test_lesson import DESK, commands, shown

START, *STEP_4 = commands(DESK[0])
REAL = commands(DESK[1])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("lesson")


def answer(line):
    """What a command prints."""
    program, *words = shlex.split(line, comments=True)
    assert program == "kickctl", line
    with io.StringIO() as printed:
        with redirect_stdout(printed), redirect_stderr(printed):
            status = main(words)
        assert status == 0, line + printed.getvalue()
        return printed.getvalue()


@pytest.fixture(scope="module")
def answers(folder):
    """What each command prints, those of step 4 first and then those for a real robot."""
    python, dash_m, program, port, number, *arguments = START.split()
    assert (python, dash_m, program, port) == ("python", "-m", "sim_motor", "--port")
    assert STEP_4[0] == f"export KICK_BRICK=tcp://127.0.0.1:{number}"
    assert STEP_4[-1] == "unset KICK_BRICK"
    with (
        desk_robot(folder, *arguments) as (uri, _),
        empty_figures(),
        pytest.MonkeyPatch.context() as patch,
    ):
        # A person goes to the other terminal; by then the neurons have settled.
        with connect(uri, observe=True) as robot:
            robot.wait(3.0)
        patch.chdir(folder)
        patch.setenv("KICK_BRICK", uri)
        patch.setenv("KICK_TOKEN", str(folder / "token"))
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
