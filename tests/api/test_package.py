"""What `import kickctl` promises, and what it loads."""

import inspect
import subprocess
import sys

import pytest

import kickctl
from host.errors import NotDone
from host.kicking.outcome import Outcome
from tests.lint.sources import ROOT

HEAVY = {
    "anywidget",
    "IPython",
    "matplotlib",
    "mcap",
    "numba",
    "numpy",
    "rich",
    "scipy",
    "serial",
    "sympy",
    "zeroconf",
}


def loaded_by(code):
    """The top-level modules that are loaded after some code in a fresh interpreter."""
    command = [sys.executable, "-c", code + "\nimport sys; print(*sys.modules)"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in done.stdout.split()}


def test_importing_it_loads_nothing_but_itself():
    assert not loaded_by("import kickctl") & {*HEAVY, "robot", "host", "sim_motor"}


def test_errors_are_loaded_without_anything_heavy():
    assert not loaded_by("from kickctl import KickctlError, NoLink, Log") & HEAVY


@pytest.mark.parametrize("name", kickctl.__all__)
def test_everything_that_it_promises_is_there(name):
    value = getattr(kickctl, name)
    assert name in dir(kickctl)
    assert inspect.getdoc(value)
    if isinstance(value, type):
        assert value.__name__ == name


def test_the_names_of_the_issue_are_among_them():
    from kickctl import KickctlError, Log, Robot, connect, run_experiment

    assert issubclass(kickctl.NoLink, KickctlError)
    with connect("sim://") as robot:
        assert type(robot) is Robot
    assert Log() is not None
    assert run_experiment.__module__ == "host.perform.run"


def test_what_is_not_there_is_named():
    with pytest.raises(AttributeError, match=r"no attribute 'kick'.*connect"):
        _ = kickctl.kick


PROMISED = [
    f"{name}.{method}"
    for name in ("Robot", "Log", "Listener", "Records")
    for method, value in inspect.getmembers(getattr(kickctl, name))
    if not method.startswith("_") and inspect.isroutine(value)
]


@pytest.mark.parametrize("place", [*PROMISED, "connect", "run_experiment"])
def test_a_public_function_documents_its_arguments_and_its_result(place):
    value = kickctl
    for name in place.split("."):
        value = getattr(value, name)
    signature, words = inspect.signature(value), inspect.getdoc(value)
    own = [name for name in signature.parameters if name not in ("self", "cls")]
    if own:
        assert "\nArgs:" in words
        for name in own:
            assert f"\n    {name}: " in words, f"{name} is not explained"
    if signature.return_annotation not in ("None", "Self", None):
        assert "\nReturns:" in words or "\nYields:" in words


def test_it_carries_types():
    assert (ROOT / "kickctl" / "py.typed").is_file()


def test_an_experiment_runs_by_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    summary = kickctl.run_experiment("timeline", trials=1, seed=3)
    assert summary["claims"]


# kick_and_watch


def test_a_watched_kick_answers_as_the_command_does(monkeypatch, tmp_path, capsys):
    import json

    from host.cli import main

    monkeypatch.chdir(tmp_path)
    assert main(["kick", "--mode", "phase", "--ticks", "4", "--json", "--seed", "5"]) == 0
    answer = json.loads(capsys.readouterr().out)
    with kickctl.connect("sim://", seed=5) as robot:
        outcome = robot.kick_and_watch("phase", ticks=4)
    assert dict(outcome) == {name: answer[name] for name in answer if name not in ("log", "figure")}
    assert outcome["reversed"] is outcome.reversed is True
    assert isinstance(outcome, Outcome)
    assert str(outcome).startswith("The kick reversed the robot: a phase kick of 4 ticks")


def test_slow_wheels_are_watched_until_it_is_known_when_they_had_settled():
    with kickctl.connect("sim://?k=1.2", seed=1) as robot:
        outcome = robot.kick_and_watch("phase", ticks=5)
    assert outcome.reversed
    assert 0.9 < outcome.settling_s < 1.8


def test_a_kick_that_does_not_reverse_says_what_helps():
    with kickctl.connect("sim://", seed=5) as robot:
        outcome = robot.kick_and_watch("phase", ticks=1)
    assert not outcome.reversed
    assert "too short or too long" in str(outcome)
    assert "settled after" not in str(outcome)  # it did nothing


def test_now_kicks_at_once():
    with kickctl.connect("sim://", seed=5) as robot:
        early = robot.kick_and_watch("membrane", now=True)
    with kickctl.connect("sim://", seed=5) as robot:
        patient = robot.kick_and_watch("membrane")
    assert early.applied_tick < patient.applied_tick


def test_a_robot_that_does_not_run_is_not_kicked():
    with kickctl.connect("sim://?idle=1") as robot, pytest.raises(NotDone, match="does not run"):
        robot.kick_and_watch("phase")


# Parameters of the embedded robot


def test_the_address_gives_the_embedded_robot_its_parameters():
    with kickctl.connect("sim://?k=2&tau_s=1&seed=4&link_loss=hold") as robot:
        params = robot.status()["params"]
        assert (params["k"], params["tau_s"], params["link_loss"]) == (2.0, 1.0, "hold")
        assert robot.hello["seed"] == 4
        assert robot.status()["state"] == "running"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("k=-1", "k cannot be -1"),
        ("k=nan", "k cannot be nan"),
        ("k=fast", "k cannot be 'fast'"),
        ("tau_s=0.05", "shorter than 3 ticks"),
        ("mass=1", "no option 'mass'"),
    ],
)
def test_the_robot_checks_them(options, words):
    with pytest.raises(kickctl.WrongUse, match=words):
        kickctl.connect(f"sim://?{options}")


# What a notebook shows


def test_a_robots_repr_says_what_it_does_without_asking_it():
    with kickctl.connect("sim://", seed=5) as robot:
        assert repr(robot) == (
            "<Robot sim://: simulated, seed 5; no record taken in yet; may be driven>"
        )
        robot.wait(1)
        newest = robot.newest
        assert f"running at tick {newest.tick}, {newest.t_s:.2f} s" in repr(robot)
        robot.lease()
        assert "driven from here" in repr(robot)
    assert "has been closed" in repr(robot)
    with kickctl.connect("sim://", observe=True) as robot:
        assert "observed" in repr(robot)
