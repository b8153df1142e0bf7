"""What was done on a robot is said on standard error if standard output does not take it."""

import errno
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from host.commands._streams import OUTPUT
from host.link.discovery import Found

REPRODUCED = ("reproduce", "report results/report.html")
DONE = {
    "kick --mode phase --seed 1": ("reversed the robot", "logs/"),
    "drive forward --seed 1": ("reached forward", "logs/"),
    "record 0.5 --seed 1": ("17 of 17 due ticks in logs/",),
    "start --seed 1": ("the robot runs from tick",),
    "params set k=2": ("the robot has set k = 2",),
    "log pull --seed 1": ("ticks", "logs/"),
    "theory hopf": ("results/theory/hopf-",),
    "body car --time 0.1": ("results/body-",),
}


class Unwritable:
    """A standard output that fails as the real one does."""

    encoding = "utf-8"

    def __init__(self, number):
        self.number = number

    def write(self, text):
        raise OSError(self.number, "it fails", OUTPUT)

    def flush(self):
        """Nothing is left to write."""

    def fileno(self):
        raise OSError


FAILURES = [(line, errno.ENOSPC) for line in DONE]
FAILURES += [("start --seed 1", number) for number in (errno.EPIPE, errno.EIO)]
FAILURES += [("kick --mode phase --seed 1", errno.EPIPE)]


@pytest.mark.parametrize("json_too", [(), ("--json",)], ids=["words", "json"])
@pytest.mark.parametrize(("line", "number"), FAILURES)
def test_what_was_done_is_said_where_it_can_be(kickctl, monkeypatch, line, number, json_too):
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", Unwritable(number))
        status, _, err = kickctl(*line.split(), *json_too)
    assert status == 1
    assert "standard output cannot be written" in err
    for words in DONE[line]:
        assert words in err


@pytest.mark.parametrize("json_too", [(), ("--json",)], ids=["words", "json"])
@pytest.mark.parametrize(
    ("line", "words"), [("discover --save", "anna is tcp://h:5425 from now on"), REPRODUCED]
)
def test_what_was_saved_is_said_too(kickctl, monkeypatch, line, words, json_too):
    found = [Found("anna", "robot", "tcp://h:5425", "h", ("192.0.2.1",))]
    page = Path("results/report.html")
    done = SimpleNamespace(claims=[], at_preset={}, skipped={}, page=page, origin={})
    with monkeypatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(kickctl.folder))
        patch.setattr("host.link.discovery.look_around", lambda seconds: found)
        patch.setattr("host.perform.reproduce.reproduce", lambda *_, **__: done)
        patch.setattr(sys, "stdout", Unwritable(errno.ENOSPC))
        status, _, err = kickctl(*line.split(), *json_too)
    assert status == 1
    assert words in err


@pytest.mark.parametrize("line", ["status", "params list", "log list", "plan --to forward"])
def test_a_reader_who_has_seen_enough_of_what_can_be_asked_again_hears_nothing(
    kickctl, monkeypatch, line
):
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", Unwritable(errno.EPIPE))
        status, _, err = kickctl(*line.split(), "--json")
    assert status == 1
    assert "cannot be written" not in err


def test_a_kick_that_did_not_reverse_says_both(kickctl, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", Unwritable(errno.ENOSPC))
        status, _, err = kickctl("kick", "--mode", "phase", "--ticks", "1", "--seed", "5", "--json")
    assert status == 1
    assert "logs/" in err
    assert "the robot did not reverse" in err


def test_other_broken_pipes_are_not_taken_for_a_reader_that_left(kickctl, monkeypatch):
    def fail(self):
        raise BrokenPipeError(errno.EPIPE, "Broken pipe")

    monkeypatch.setattr("host.client.robot.Robot.status", fail)
    status, out, err = kickctl("status", "--json")
    assert status == json.loads(out)["error"]["status"] == 1
    assert "Broken pipe" in err
    assert "standard output" not in err


@pytest.mark.parametrize("json_too", ["", " --json"])
@pytest.mark.parametrize("target", [">/dev/full", "| true"])
def test_a_process_says_it_too(shell, json_too, target):
    if "full" in target and not Path("/dev/full").exists():
        pytest.skip("needs /dev/full, which Linux has")
    _, _, err = shell(
        "{ kickctl record 0.5 --seed 1" + json_too + "; echo status $? >&2; } " + target
    )
    if target == "| true" and "status 0" in err:
        return  # the reader was there until the end
    assert "17 of 17 due ticks in logs/" in err
    assert "status 1" in err
