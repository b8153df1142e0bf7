"""`kickctl record`: ticks against those that were due, and why some are not there."""

import json
from pathlib import Path

import pytest

from host.client.robot import Robot
from host.commands.record import Tally
from host.logs.log import Log
from host.logs.tap import Span
from robot.record import Record
from tests.link.machines import RigLink

TICK_S = 0.03


def record(tick, deadline, missed=0, late_s=0.0):
    nothing = dict.fromkeys(Record._fields, 0)
    t_s = TICK_S * deadline + late_s
    return Record(**(nothing | {"tick": tick, "t_s": t_s, "missed": missed, "late_s": late_s}))


def tallied(seconds, records):
    """A tally of records, as `record` feeds it."""
    tally = Tally(seconds)
    tally.take_event({"event": "snapshot", "tick": 0, "params": {"tick_s": TICK_S}, "kick": None})
    span = Span(seconds, tally)
    for one in records:
        span.take_records([one])
    tally.end(records)
    return tally


def test_a_punctual_robot_has_all_that_was_due():
    tally = tallied(3.0, [record(tick, tick) for tick in range(7, 120)])
    assert (tally.ticks, tally.due, tally.missed) == (100, 100, 0)


def test_missed_deadlines_count_those_within_the_time():
    first = [record(0, 10, missed=5)]  # due before
    gap = [record(1, 11), record(2, 15, missed=3)]
    rest = [record(tick, 13 + tick) for tick in range(3, 40)]
    tally = tallied(0.9, first + gap + rest)
    assert (tally.ticks, tally.due, tally.missed) == (27, 30, 3)


@pytest.mark.parametrize("late_s", [0.0, 0.0001, 0.02])
def test_a_robot_that_hangs_over_the_end_misses_only_what_was_due_before_it(late_s):
    before = [record(tick, 10 + tick) for tick in range(20)]
    behind = record(20, 70, missed=40, late_s=late_s)
    tally = tallied(0.9, [*before, behind])
    assert (tally.ticks, tally.due, tally.missed) == (20, 30, 10)


def test_a_changed_control_period_changes_what_is_due():
    tally = Tally(0.9)
    tally.take_records([record(0, 10)])
    tally.take_event({"event": "params", "tick": 1, "number": 1, "set": {"tick_s": 0.01}})
    behind = record(1, 70, missed=179)  # at 2.1 s; the time ends at 1.2 s
    tally.end([behind])
    assert tally.missed == 89


def test_lost_records_and_a_restart_count_as_before():
    tally = Tally(1.0)
    tally.take_records([record(5, 5)])
    tally.take_event({"event": "lost", "from": 6, "tick": 9})
    tally.take_records([record(9, 9)])
    tally.take_event({"event": "restart", "tick": 0, "boot": "x", "clock_zero_s": 0.0})
    tally.take_records([record(0, 0, missed=2), record(1, 1)])
    assert (tally.ticks, tally.missing, tally.missed, tally.due) == (4, 3, 0, 7)
    assert tally.restarts == 1


@pytest.fixture
def late_robot(monkeypatch):
    """A robot that has missed some deadlines at known ticks, embedded in the command."""
    link = RigLink()
    link.loop.clock.lates.extend([0.0] * 10 + [0.1] + [0.0] * 20 + [0.07])
    monkeypatch.setattr("host.client.robot.connect", lambda *_, **__: Robot(link, link.token))
    return link


def test_the_command_says_what_was_due_and_what_was_missed(kickctl, late_robot):
    status, out, _ = kickctl("record", "2.99", "--json")
    result = json.loads(out)
    assert status == 0
    assert (result["missed"], result["missing"]) == (5, 0)
    assert late_robot.loop.missed == 5
    assert result["due"] == result["ticks"] + 5 == 100
    log = Log.load(result["log"])
    assert len(log) == result["ticks"]
    assert int(log.column("missed")[1:].sum()) == 5


def test_the_words_say_the_same(kickctl, late_robot):
    status, out, _ = kickctl("record", "2.99")
    assert status == 0
    assert out.startswith("95 of 100 due ticks in logs/")
    assert out.endswith(": the robot missed 5 deadlines, 0 records missing\n")


@pytest.mark.parametrize(
    ("line", "ending"),
    [
        (("kick", "--mode", "membrane", "--wheel", "left"), "-sim-kick-membrane-1-tick-left.mcap"),
        (("record", "0.1"), "-sim-record.mcap"),
        (("log", "pull"), "-sim-pull.mcap"),
        (("drive", "forward"), "-sim-drive-forward.mcap"),
    ],
)
def test_a_logs_name_says_what_was_done(kickctl, line, ending):
    name = Path(json.loads(kickctl(*line, "--seed", "1", "--json")[1])["log"]).name
    assert name[15:] == ending
    assert name[:8].isdecimal()
