"""kickctl.theory: docs/notebook.md runs, and wrong arguments are refused in words."""

import functools
import inspect
import re

import pytest
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from kickctl import theory
from kickctl.theory import (
    Wheel,
    basins,
    branch,
    kicks,
    lyapunov,
    phase_diagram,
    trajectory,
)
from tests.lint.sources import ROOT
from tests.paper.theory import independent

FUNCTIONS = [name for name in theory.__all__ if name[0].islower()]


@pytest.mark.parametrize("name", theory.__all__)
def test_everything_is_documented_with_units(name):
    value = getattr(theory, name)
    words = inspect.getdoc(value)
    fields = getattr(value, "__dataclass_fields__", None) or getattr(value, "_fields", ())
    for field in fields:
        assert f"\n    {field}: " in words, field
    if name in FUNCTIONS:
        for argument in inspect.signature(value).parameters:
            assert f"\n    {argument}: " in words, argument
        assert "\nReturns:" in words
        assert "\nRaises:" in words


def test_a_trajectory_is_that_of_another_integrator_at_the_times_that_were_asked_for():
    wheel, start, times = Wheel(k=3, tau=0.37, f=0.62), (0.3, -0.2, 0.5, 4.0), [0.0, 0.7, 2.9]
    found = trajectory(wheel, t=times, start=start)
    assert found.t.tolist() == times
    for time_s, *state in zip(found.t, found.x1, found.x2, found.phi, found.omega, strict=True):
        other = solve_ivp(
            lambda _, y: independent.rates(y, wheel),
            (0.0, time_s),
            start,
            "DOP853",
            rtol=1e-11,
            atol=1e-11,
        )
        assert state == pytest.approx(other.y[:, -1], abs=1e-8)


@pytest.mark.parametrize(
    ("seconds", "times"),
    [
        (0.0, [0.0]),
        (0.009, [0.0, 0.009]),
        (0.049, [0.0, 0.02, 0.04, 0.049]),
        (0.051, [0.0, 0.02, 0.04, 0.051]),
        (0.06, [0.0, 0.02, 0.04, 0.06]),
    ],
)
def test_a_trajectory_ends_when_it_was_asked_to(seconds, times):
    assert trajectory(Wheel(), t=seconds).t.tolist() == times


def test_multiples_of_the_time_between_samples_have_no_sample_twice():
    for count in (7, 29, 57, 58, 113, 407):  # some of the products are rounded
        assert len(trajectory(Wheel(), t=count / 50).t) == count + 1


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: trajectory(8.0), "wheel cannot be 8.0"),
        (lambda: trajectory(Wheel(k="x")), "k cannot be 'x'"),
        (lambda: theory.hopf(Wheel(k="8")), "k cannot be '8'"),
        (lambda: theory.fixpoints(Wheel(bounded=None)), "bounded cannot be None"),
        (lambda: trajectory(Wheel(), t=1e9), "t cannot be 1000000000.0"),
        (lambda: trajectory(Wheel(tau=0.0)), "tau cannot be 0.0"),
        (lambda: trajectory(Wheel(), t=-1), "t cannot be -1"),
        (lambda: trajectory(Wheel(), t=[1, 1]), "t cannot be"),
        (lambda: trajectory(Wheel(), start=(0, 1)), "start cannot be"),
        (lambda: trajectory(Wheel(), start="here"), "start cannot be 'here'"),
        (lambda: theory.hopf(Wheel(f=0.0)), "no Hopf bifurcation"),
        (lambda: branch(Wheel(), along="q"), "along cannot be 'q'"),
        (lambda: branch(Wheel(), to=-1.0), "to cannot be -1.0"),
        (lambda: branch(Wheel(), to=[2.0, 3.0]), "to cannot be"),
        *[
            (functools.partial(refusing, Wheel(dry_friction=0.1)), "dry friction")
            for refusing in (theory.fixpoints, theory.hopf, branch, lyapunov, kicks)
        ],
        *[
            (functools.partial(refusing, Wheel(f=0.0)), "without friction a wheel can roll faster")
            for refusing in (
                functools.partial(phase_diagram, k=[1], tau=[0.25], start="roll"),
                lyapunov,
                basins,
                kicks,
            )
        ],
        (lambda: phase_diagram(Wheel(), k=[], tau=[1]), "k cannot be"),
        (lambda: phase_diagram(Wheel(), k=[1], tau=[0]), "tau cannot be"),
        (lambda: phase_diagram(Wheel(), k=[1], tau=[1], start="up"), "start cannot be 'up'"),
        (lambda: lyapunov(Wheel(), seconds=1), "seconds cannot be 1"),
        (lambda: lyapunov(Wheel(), seed=-1), "seed cannot be -1"),
        (lambda: phase_diagram(Wheel(), k=range(2000), tau=range(1, 2000)), "too many points"),
        (lambda: basins(Wheel(), points=3), "points cannot be 3"),
        (lambda: basins(Wheel(), points=10**6), "points cannot be 1000000"),
        (lambda: kicks(Wheel(), phases=10**9), "phases cannot be 1000000000"),
        (lambda: kicks(Wheel(), "frozen"), "mode cannot be 'frozen'"),
        (lambda: kicks(Wheel(), "position", 1), "sign cannot be 1"),
        (lambda: kicks(Wheel(), length=[0.1]), "length cannot be"),
    ],
)
def test_wrong_arguments_are_refused_in_words(call, words):
    with pytest.raises(WrongUse, match=words) as caught:
        call()
    assert caught.value.hint


def test_a_name_that_is_not_there_is_told_with_the_one_that_is_meant():
    with pytest.raises(AttributeError, match="did you mean 'lyapunov'"):
        _ = theory.lyapunow
    assert dir(theory) == sorted(theory.__all__)


def test_the_pages_blocks_run_as_they_are_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "notebook.md").read_text(encoding="utf-8")
    names = {}
    for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
        exec(compile(block, "docs/notebook.md", "exec"), names)  # noqa: S102 - this is what it is for
    assert (tmp_path / "rolling.png").exists()
