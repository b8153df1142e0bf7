"""Byte code with the equations in it computes what the sources say, and Python takes it."""

import os
import shutil
import subprocess
import sys
from inspect import getsource
from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

import robot.controller
import robot.wheel
from robot.compile import FOLDER, inline
from robot.kicks import MEMBRANE, PULSE, PULSE_A, WHEELS, Kick
from robot.params import Params
from robot.wheel import Wheel

KICKS = (
    None,
    Kick("k", MEMBRANE, WHEELS, 1),
    Kick("k", PULSE, ("left",), 4, smooth=True, pulse=PULSE_A, values=(9.0, 9.0)),
)
SHOW = "from robot.wheel import Wheel; print(*Wheel.step.__code__.co_names)"


@pytest.fixture(scope="module")
def inlined():
    """The class Wheel with the equations in the place of their calls."""
    names = {"__name__": "inlined"}
    module = inline(getsource(robot.controller), getsource(robot.wheel))
    exec(compile(module, "wheel.py", "exec"), names)  # noqa: S102
    return names["Wheel"]


def test_no_call_of_an_equation_is_left(inlined):
    calls = set(inlined.step.__code__.co_names)
    assert {"cos", "exp", "tanh"} < calls
    assert not calls & {"actual_positions", "lagging_angle", "step_wheel", "target_position"}


@given(
    st.floats(-1e3, 1e3),
    st.none() | st.floats(-1e3, 1e3),
    st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    st.floats(0.003, 0.09),
    st.floats(0.0, 0.02),
    st.sampled_from((1, 2)),
    st.sampled_from(KICKS),
)
def test_the_numbers_are_the_same_to_the_last_bit(inlined, phi, before, x, dt_s, lag, rods, kick):
    params = Params()
    params.rod_lag_s, params.rods = lag, rods
    results = []
    for kind in (Wheel, inlined):
        wheel = kind("left")
        wheel.phi, wheel.phi_before, wheel.x1, wheel.x2 = phi, before, x[0], x[1]
        returned = wheel.step(0, dt_s, params, kick)
        results.append(pack("5d", wheel.x1, wheel.x2, wheel.force, wheel.torque, returned))
    assert results[0] == results[1]


def test_what_is_called_twice_in_a_value_is_computed_once():
    module = inline(
        "'''.'''\ndef square(x):\n    '''.'''\n    return x * x\n",
        "'''.'''\ndef twice(f):\n    return square(f()) + 1\n",
    )
    names, calls = {"square": lambda x: x * x}, []
    exec(compile(module, "made", "exec"), names)  # noqa: S102
    assert names["twice"](lambda: calls.append(1) or 3) == 10
    assert calls == [1]


def test_python_takes_what_was_compiled_until_a_source_changes(tmp_path):
    shutil.copytree(FOLDER, str(tmp_path / "robot"), ignore=shutil.ignore_patterns("__py*"))
    environment = dict(os.environ, PYTHONDONTWRITEBYTECODE="1")

    def run(*arguments):
        process = subprocess.run(
            [sys.executable, *arguments],
            cwd=str(tmp_path),
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            check=False,
        )
        return process.returncode, process.stdout.decode("utf-8")

    def edit(name):
        source = tmp_path / "robot" / name
        source.write_bytes(source.read_bytes() + b"\n")

    assert "step_wheel" in run("-c", SHOW)[1].split()
    assert run("-m", "robot.compile") == (0, "")
    assert "step_wheel" not in run("-c", SHOW)[1].split()
    edit("wheel.py")
    assert "step_wheel" in run("-c", SHOW)[1].split()
    assert run("-m", "robot.compile") == (0, "")
    edit("controller.py")
    status, words = run("-c", SHOW)
    assert status == 1
    assert "python3 -m robot.compile" in words
