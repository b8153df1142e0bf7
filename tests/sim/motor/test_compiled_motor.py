"""A motor moves with the same bits in plain Python and compiled, and a few kicks load no numba."""

import subprocess
import sys

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import sim_motor.wheel_motor
from sim_motor import compiled_motor, motor
from sim_motor.arrays import scalars, tables
from sim_motor.brick import SimBrick
from sim_motor.constants import Steps
from sim_motor.exact_step import COAST
from tests.lint.sources import ROOT
from tests.sim.motor.motions import ROBOTS, at_rest

STEPS = {name: Steps(constants) for name, constants in ROBOTS.items()}
SCRIPT = """
import sys
from host.cli import main
assert main(["record", "60", "--seed", "1"]) == 0
print("numba" in sys.modules, file=sys.stderr)
"""


@given(
    robot=st.sampled_from(sorted(ROBOTS)),
    turns=st.lists(
        st.tuples(
            st.integers(0, 60), st.integers(-100, COAST), st.floats(4.0, 9.0), st.floats(-0.3, 0.3)
        ),
        max_size=40,
    ),
)
def test_every_motion_is_the_same_in_plain_python(robot, turns):
    constants = ROBOTS[robot]
    (table,), (numbers,), steps = tables([constants]), scalars([constants]), STEPS[robot]
    state, plain = at_rest(), at_rest()
    for turn in turns:
        compiled_motor.advance_in_place(state, *turn, table, numbers)
        plain[:] = motor.advance(*turn, *plain.tolist(), steps, constants.scalars())
        assert plain.tolist() == state.tolist()


@given(
    time_s=st.floats(0.0, 1e5),
    angle=st.floats(-1e4, 1e4),
    step=st.floats(0.0, 0.1),
    dither=st.floats(0.0, 1.0),
    seed=st.integers(0, 2**33),
)
def test_every_reading_is_the_same_in_plain_python(time_s, angle, step, dither, seed):
    substep = motor.substep_at(time_s)
    assert substep == compiled_motor.substep_at(time_s)
    assert motor.substep_from(time_s) == compiled_motor.substep_from(time_s)
    arguments = substep, angle, angle - step, 720.0, dither, seed
    assert motor.encoder(*arguments) == compiled_motor.encoder(*arguments)


def test_a_change_to_compiled_code_on_the_way_changes_nothing(monkeypatch):
    def drive(plain_substeps):
        monkeypatch.setattr(sim_motor.wheel_motor, "COMPILED", "never loaded")
        monkeypatch.setattr(sim_motor.wheel_motor, "PLAIN_SUBSTEPS", plain_substeps)
        brick = SimBrick(1)
        for duty in (60, -60, 0, 100):
            for wheel in brick.motors:
                wheel.write_duty(duty)
            brick.clock.wait(brick.clock.now() + 0.7, lambda timeout_s: None)
            brick.truth()
        return np.array(brick.truth()).tolist()

    assert drive(0) == drive(1000) == drive(1_000_000)


def test_a_short_simulation_loads_no_numba(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr.splitlines()[-1] == "False"
