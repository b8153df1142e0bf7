"""--json is one JSON object on standard output, whatever happens; piped tables are whole."""

import json

import pytest

from host.client.robot import Robot
from host.commands import status as status_verb


@pytest.mark.parametrize(
    "arguments",
    [
        ("fly", "--json"),
        ("--json",),
        ("kick", "--json"),
        ("kick", "--json", "--mode", "sideways"),
        ("record", "ten", "--js"),
        ("record", "nan", "--json"),
        ("--seed", "x", "status", "--json"),
        ("log", "--json"),
        ("log", "replay", "nowhere", "--json"),
        ("deploy", "--json"),
        ("experiment", "nothing", "--json"),
        ("status", "--brick", "nowhere", "--json"),
    ],
)
def test_wrong_use_is_one_object(kickctl, arguments):
    status, out, err = kickctl(*arguments)
    error = json.loads(out)["error"]
    assert status == error["status"] == 2
    assert error["message"] in err
    assert len(out.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        (("log", "list"), "logs"),
        (("params", "list"), "params"),
        (("--version",), "text"),
        (("kick", "--help"), "text"),
    ],
)
def test_lists_and_texts_are_one_object(kickctl, arguments, key):
    status, out, _ = kickctl(*arguments, "--json")
    assert status == 0
    assert key in json.loads(out)


@pytest.mark.parametrize(
    ("raised", "status"),
    [
        (KeyboardInterrupt(), 130),
        (PermissionError(13, "Permission denied", "file"), 1),
        (MemoryError(), 1),
        (UnicodeEncodeError("ascii", "\u00b0", 0, 1, "ordinal not in range"), 2),
        (ModuleNotFoundError("No module named 'zeroconf'"), 1),
    ],
)
def test_whatever_ends_a_verb_is_one_object(kickctl, monkeypatch, raised, status):
    def fail(self):
        raise raised

    monkeypatch.setattr(Robot, "status", fail)
    done, out, err = kickctl("status", "--json")
    assert done == json.loads(out)["error"]["status"] == status
    assert json.loads(out)["error"]["message"] in err


def test_a_mistake_in_the_program_is_no_error_in_words(kickctl, monkeypatch):
    def fail(self):
        raise TypeError

    monkeypatch.setattr(Robot, "status", fail)
    with pytest.raises(TypeError):
        kickctl("status", "--json")


def test_an_interrupt_after_the_answer_is_no_second_answer(kickctl, monkeypatch):
    show = status_verb.show

    def interrupted(result):
        show(result)
        raise KeyboardInterrupt

    monkeypatch.setattr(status_verb, "show", interrupted)
    status, out, err = kickctl("status", "--json")
    assert status == 130
    assert json.loads(out)["state"] == "running"
    assert "interrupted" in err


@pytest.mark.parametrize(
    ("number", "asks"), [(28, True), (122, True), (13, False), (2, False), (20, False)]
)
def test_only_a_full_disk_is_asked_about(kickctl, monkeypatch, number, asks):
    def fail(self):
        raise OSError(number, "some reason", "file")

    monkeypatch.setattr(Robot, "status", fail)
    status, _, err = kickctl("status")
    assert status == 1
    assert "file cannot be written or read: some reason" in err
    assert ("is the disk full?" in err) is asks


def test_a_record_that_is_interrupted_says_so(kickctl, monkeypatch):
    wait = Robot.wait

    def interrupted(self, seconds, until=None):
        wait(self, 1.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(Robot, "wait", interrupted)
    status, out, err = kickctl("record", "60", "--seed", "1", "--json")
    facts = json.loads(out)
    assert status == 130
    assert facts["interrupted"] is True
    assert facts["ticks"] > 30
    assert "interrupted" in err
    assert [row["note"] for row in json.loads(kickctl("log", "list", "--json")[1])["logs"]] == [""]


def test_an_interrupt_while_connecting_names_no_log(kickctl, monkeypatch):
    def interrupted(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(Robot, "info", interrupted)
    status, out, err = kickctl("record", "60", "--json")
    assert status == json.loads(out)["error"]["status"] == 130
    assert "logs/" not in out + err
    assert not (kickctl.folder / "logs").exists()


def test_an_interrupted_kick_names_its_log(kickctl, monkeypatch):
    wait = Robot.wait

    def interrupted(self, seconds, until=None):
        wait(self, 0.5)
        raise KeyboardInterrupt

    monkeypatch.setattr(Robot, "wait", interrupted)
    status, out, err = kickctl("kick", "--mode", "membrane", "--json")
    assert status == 130
    (log,) = (kickctl.folder / "logs").iterdir()
    assert f"logs/{log.name}" in json.loads(out)["error"]["hint"]
    assert "motors stopped" in err


def test_watch_is_a_stream_that_may_end_with_an_error(kickctl, monkeypatch):
    assert "JSON lines" in " ".join(kickctl("watch", "--help")[1].split())
    wait = Robot.wait
    calls = []

    def fail(self, seconds, until=None):
        calls.append(seconds)
        if len(calls) > 2:
            raise OSError(5, "Input/output error", "link")
        return wait(self, seconds, until)

    monkeypatch.setattr(Robot, "wait", fail)
    status, out, _ = kickctl("watch", "--json")
    *items, last = [json.loads(line) for line in out.splitlines()]
    assert status == last["error"]["status"] == 1
    assert [set(item) >= {"tick", "left", "right"} for item in items] == [True]


def test_piped_tables_are_whole(kickctl, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    out = kickctl("params", "list")[1]
    rows = json.loads(kickctl("params", "list", "--json")[1])["params"]
    assert len(out.splitlines()) == len(rows) + 1
    for row in rows:
        (line,) = [line for line in out.splitlines() if line.startswith(row["name"] + " ")]
        assert row["doc"] in line
    assert "\u2026" not in out
