"""Derivatives that are kept as text: the same numbers without sympy, and never of other sources."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from host.theory.analysis.hopf import hopf
from host.theory.model import symbolic
from host.theory.model.symbolic import derivatives, jacobian_at, jacobian_by_differences
from host.theory.model.wheel import Wheel

ROOT = Path(__file__).parents[3]
STATE = (0.3, -0.4, 0.5, 2.0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of kept derivatives, this test's own, as a new process has it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    derivatives.cache_clear()
    yield tmp_path / "kickctl" / "compiled" / "derivatives"
    derivatives.cache_clear()


def jacobian_in_another_process():
    script = (
        "import sys; from host.theory.model.symbolic import jacobian_at;"
        "from host.theory.model.wheel import Wheel;"
        f"print(jacobian_at({STATE}, Wheel()).tobytes().hex(), 'sympy' in sys.modules)"
    )
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    return done.stdout.split()


def test_a_second_process_has_the_same_bits_without_sympy(folder):
    assert not folder.exists()
    first, second = jacobian_at(STATE, Wheel()), jacobian_in_another_process()
    assert second == [first.tobytes().hex(), "False"]


def test_the_jacobian_is_that_of_differences(folder):
    for wheel in (Wheel(), Wheel(k=8.0, tau=0.1)):
        own, check = jacobian_at(STATE, wheel), jacobian_by_differences(STATE, wheel)
        assert np.allclose(own, check, rtol=1e-6, atol=1e-6)


def test_other_sources_have_derivatives_of_their_own(folder, monkeypatch):
    jacobian_at(STATE, Wheel())
    derivatives.cache_clear()
    monkeypatch.setattr(symbolic, "version", lambda name: "another")
    jacobian_at(STATE, Wheel())
    assert len(list(folder.iterdir())) == 2


def test_a_hopf_line_needs_neither_numba_nor_sympy(folder):
    script = (
        "import sys; from host.theory.analysis.hopf import hopf;"
        "from host.theory.model.wheel import Wheel; hopf(Wheel());"
        "print([name for name in ('numba', 'sympy') if name in sys.modules])"
    )
    hopf(Wheel())  # keeps the derivatives
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.strip() == "[]"
