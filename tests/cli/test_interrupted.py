"""What an interrupt leaves: the answer, and whether the robot was commanded."""

import json
import pkgutil
import signal
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from host.client.robot import Robot
from host.commands import _terminal
from host.errors import NoLink

KICK = ("kick", "--mode", "phase", "--seed", "1", "--json")


def interrupted(*_, **__):
    raise KeyboardInterrupt


def end_of(kickctl, *arguments, status=130):
    """The hint of the error with which a command ends, which is said in words too."""
    done, out, err = kickctl(*arguments)
    error = json.loads(out)["error"]
    assert done == error["status"] == status
    assert error["message"] in err
    return error["hint"]


@pytest.mark.parametrize("verb", [KICK, ("drive", "forward", "--seed", "1", "--json")])
def test_while_the_figure_is_drawn_the_answer_says_so(kickctl, monkeypatch, verb):
    whole = json.loads(kickctl(*verb)[1])
    assert "interrupted" not in whole
    monkeypatch.setattr(Figure, "savefig", interrupted)
    status, out, err = kickctl(*verb)
    answer = json.loads(out)
    assert status == answer["error"]["status"] == 130
    assert answer["interrupted"] is True
    assert answer["figure"] is None
    assert set(whole) < set(answer)
    assert "interrupted" in err


@pytest.mark.parametrize("line", ["theory hopf", "experiment starts --starts 2"])
def test_while_the_figure_of_a_run_is_drawn_its_results_are_answered(kickctl, monkeypatch, line):
    monkeypatch.setattr(Figure, "savefig", interrupted)
    status, out, err = kickctl(*line.split(), "--seed", "1", "--json")
    answer = json.loads(out)
    assert status == answer["error"]["status"] == 130
    assert answer["interrupted"] is True
    assert "interrupted while it was drawn" in answer["unwritten"]["figure"]
    assert answer["figures"] == []
    assert all(Path(path).exists() for path in answer["tables"])
    assert json.loads(Path(answer["summary"]).read_text())["claims"] == answer["claims"]
    assert answer["error"]["kept"] in err
    words = kickctl(*line.split(), "--seed", "1")
    assert words[0] == 130
    assert f"numbers {answer['summary']}" in words[1]


def after_one(function):
    """The function, interrupted when it is called the second time."""
    calls = iter([function])

    def call(*values):
        return next(calls, interrupted)(*values)

    return call


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ("body car --time 5", "host.bodies.keeping.Keeper.note"),
        ("theory hopf", "host.runs.folder.Study.keep"),
        ("kick --mode phase", "host.client.robot.Robot.kick"),
    ],
)
def test_the_place_of_what_is_kept_is_in_the_error(kickctl, monkeypatch, line, place):
    owner, name = place.rsplit(".", 1)
    function = getattr(pkgutil.resolve_name(owner), name)
    monkeypatch.setattr(place, interrupted if "kick" in name else after_one(function))
    status, out, err = kickctl(*line.split(), "--seed", "1", "--json")
    error = json.loads(out)["error"]
    assert status == error["status"] == 130
    assert Path(error["kept"]).exists()
    assert error["kept"] in err


@pytest.mark.parametrize("line", ["theory hopf", "experiment starts --starts 2"])
def test_that_a_run_can_be_resumed_is_in_the_error(kickctl, monkeypatch, line):
    monkeypatch.setattr("host.runs.folder.Study.keep", interrupted)
    hint = end_of(kickctl, *line.split(), "--seed", "1", "--json")
    assert "cells complete in results" in hint
    assert "the same command resumes the run" in hint
    status, out, err = kickctl(*line.split(), "--seed", "1")
    assert (status, out) == (130, "")
    assert err.endswith(f"kickctl: interrupted\n  {hint}\n")


@pytest.mark.parametrize("method", ["info", "wait", "status"])
def test_before_the_kick_it_is_said_that_none_was_sent(kickctl, monkeypatch, method):
    monkeypatch.setattr(Robot, method, interrupted)
    assert "no kick was sent" in end_of(kickctl, *KICK)


def test_while_connecting_it_is_said_too(kickctl, monkeypatch):
    monkeypatch.setattr("host.client.robot.connect", interrupted)
    assert "no kick was sent" in end_of(kickctl, *KICK)


def test_while_the_kick_is_answered_nobody_knows(kickctl, monkeypatch):
    request = Robot.request

    def cut(self, command, arguments=None, *, sealed=False):
        if command == "kick":
            raise KeyboardInterrupt
        return request(self, command, arguments, sealed=sealed)

    monkeypatch.setattr(Robot, "request", cut)
    hint = end_of(kickctl, *KICK)
    assert "the kick was sent, and no answer came" in hint
    assert "logs/" in hint


@pytest.mark.parametrize("verb", [KICK, ("rods", "--seed", "1", "--json")])
def test_after_the_kick_it_is_said_that_nobody_watched(kickctl, monkeypatch, verb):
    wait = Robot.wait

    def cut(self, seconds, until=None):
        if self.confirmed["kick"]:
            raise KeyboardInterrupt
        return wait(self, seconds, until)

    monkeypatch.setattr(Robot, "wait", cut)
    assert "the kick was sent, its outcome was not watched" in end_of(kickctl, *verb)


def test_several_kicks_are_counted(kickctl, monkeypatch):
    wait = Robot.wait

    def cut(self, seconds, until=None):
        if self.confirmed["kick"] > 2:
            raise KeyboardInterrupt
        return wait(self, seconds, until)

    monkeypatch.setattr(Robot, "wait", cut)
    assert "3 kicks were sent" in end_of(kickctl, "demo", "--seed", "1", "--json")


@pytest.mark.parametrize(
    ("verb", "words"),
    [
        (("start",), "command to start"),
        (("clear",), "command to clear the fault"),
        (("params", "set", "k=2"), "change of parameters"),
    ],
)
@pytest.mark.parametrize("sent", [False, True])
def test_every_command_is_accounted_for(kickctl, monkeypatch, verb, words, sent):
    def cut(self, command, arguments=None, *, sealed=False):
        if command == "lease" and sent:
            return {}
        raise KeyboardInterrupt

    monkeypatch.setattr(Robot, "status", lambda self: {"state": "stopped", "reason": ""})
    monkeypatch.setattr(Robot, "describe", lambda self, table: [{"name": "k", "unit": "1"}])
    monkeypatch.setattr(Robot, "request", cut)
    hint = end_of(kickctl, *verb, "--json")
    assert (f"the {words} was sent, and no answer came" if sent else f"no {words} was sent") in hint


def test_a_refusal_is_an_answer(kickctl):
    status, out, err = kickctl("params", "set", "k=1000", "--json")
    assert status == 2
    assert "was sent" not in out + err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_five_signals_at_once_are_one_interrupt(kickctl, monkeypatch, number):
    def status(self):
        try:
            signal.raise_signal(number)
        finally:
            for _ in range(4):
                signal.raise_signal(number)

    print_answer = _terminal.print_answer

    def disturbed(failure):
        signal.raise_signal(number)
        print_answer(failure)

    monkeypatch.setattr(Robot, "status", status)
    monkeypatch.setattr(_terminal, "print_answer", disturbed)
    before = signal.getsignal(number)
    done, out, err = kickctl("status", "--json", "--brick", "sim://")
    assert done == json.loads(out)["error"]["status"] == 130
    assert err.endswith("kickctl: interrupted\n")
    assert signal.getsignal(number) is before


@pytest.mark.parametrize(
    ("error", "status"),
    [(RuntimeError("of __set_name__"), 130), (ImportError("failed"), 130), (NoLink("lost"), 3)],
)
def test_an_interrupt_of_which_a_library_makes_an_error_is_one(kickctl, monkeypatch, error, status):
    """As Python's dataclasses do while a module is loaded; our own errors say more."""

    def fail(*_, **__):
        raise error from KeyboardInterrupt()

    monkeypatch.setattr(Robot, "kick", fail)
    done, out, err = kickctl(*KICK)
    assert done == json.loads(out)["error"]["status"] == status
    assert ("interrupted" in err) == (status == 130)
