"""`kickctl watch`: no tick and no event is missed. What it shows is tested without the drawing."""

import io
import json
import threading
from itertools import pairwise
from math import pi

import pytest
from rich.console import Console

from host.client.robot import Robot
from host.client.stop import Stopped
from host.commands._keys import KeyParser
from host.commands._watch_keys import FOOT, HELP_FOOT, KICKS, STALE_S, KeyActions
from host.commands._watch_table import OneRobot, SeveralRobots
from host.commands._watched import VISIBLE_S, Watched, event_words
from host.errors import LeaseLost, NoLink, RefusedByRobot
from robot.kick_requests import parse
from robot.kicks import DEFAULT_SHIFT_RAD
from robot.params import Params
from robot.record import KICK_NAMES, STATES, Record
from tests.link.machines import RigLink

TICK_S = 0.03
STATUS = {
    "reason": "started",
    "controller": "anna@lab",
    "controller_held_s": 240.0,
    "missed": 7,
    "overruns": 3,
}


def records(first, last, **values):
    nothing = dict.fromkeys(Record._fields, 0) | {"state": STATES.index("running")}
    return [
        Record(**(nothing | {"tick": tick, "t_s": TICK_S * tick} | values))
        for tick in range(first, last)
    ]


def kicked(tick, mode="membrane"):
    return records(tick, tick + 1, kick=KICK_NAMES.index(mode))


@pytest.fixture
def watched():
    watched = Watched()
    watched.take_records(records(0, 10))
    watched.take_status(STATUS)
    watched.line()
    return watched


# What happens


def test_a_kick_of_one_tick_between_two_lines_is_seen_for_a_second(watched):
    watched.take_records([*records(10, 12), *kicked(12), *records(13, 15)])
    line = watched.line()
    assert (line["kick"], line["kicks"], line["recent_kick"]) == ("", ["membrane"], "membrane")
    last = 12 + round(VISIBLE_S / TICK_S)
    watched.take_records(records(15, last + 1))
    line = watched.line()
    assert (line["kicks"], line["recent_kick"]) == ([], "membrane")
    watched.take_records(records(last + 1, last + 2))
    assert watched.line()["recent_kick"] == ""


def test_a_line_counts_all_ticks_since_the_one_before(watched):
    watched.take_records([*records(10, 12), *records(12, 13, late_s=0.02), *records(13, 17)])
    line = watched.line()
    assert (line["ticks"], line["late_s"]) == (7, 0.02)
    line = watched.line()
    assert (line["ticks"], line["late_s"], line["tick"]) == (0, 0.0, 16)


def test_a_stop_names_its_reason_before_the_robot_is_asked_again(watched):
    assert not watched.status_due
    watched.take_event({"event": "stop", "tick": 10, "number": 4, "reason": "'bert' stopped it"})
    assert watched.status_due
    line = watched.line()
    assert line["reason"] == "'bert' stopped it"
    assert [event["event"] for event in line["events"]] == ["stop"]
    assert watched.line()["events"] == []


def test_the_robot_is_asked_once_a_second(watched):
    watched.take_records(records(10, 42))
    assert not watched.status_due
    watched.take_records(records(42, 44))
    assert watched.status_due
    watched.take_status({**STATUS, "controller": None, "controller_held_s": None, "missed": 9})
    assert not watched.status_due
    line = watched.line()
    assert (line["controller"], line["missed"], line["overruns"]) == (None, 9, 3)


def test_lost_records_and_restarts_are_counted(watched):
    watched.take_event({"event": "lost", "from": 10, "tick": 25})
    watched.take_records(records(25, 27))
    elapsed_s = watched.elapsed_s
    watched.take_event({"event": "restart", "tick": 0, "boot": "x", "clock_zero_s": 0.0})
    assert watched.line() is None
    watched.take_records(records(0, 3))
    line = watched.line()
    assert (line["lost"], line["restarts"], line["tick"]) == (15, 1, 2)
    assert watched.elapsed_s == pytest.approx(elapsed_s + 2 * TICK_S)
    assert line["left"]["turns_per_s"] == 0.0


def test_speed_is_taken_over_the_last_ticks():
    watched = Watched()
    for tick in range(40):
        watched.take_records(records(tick, tick + 1, left_phi_rad=2 * pi * 1.5 * tick * TICK_S))
    assert watched.line()["left"]["turns_per_s"] == pytest.approx(1.5)


def test_older_robots_do_not_say_since_when_somebody_drives():
    watched = Watched()
    watched.take_records(records(0, 2))
    watched.take_status({"reason": "started", "controller": "anna", "missed": 0, "overruns": 0})
    assert watched.line()["controller_held_s"] is None


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            {"event": "kick", "tick": 5, "kick": {"mode": "phase", "ticks": 4, "wheels": ["left"]}},
            "tick 5: kick phase, 4 ticks, left wheel",
        ),
        (
            {
                "event": "kick",
                "tick": 5,
                "kick": {"mode": "membrane", "ticks": 1, "wheels": ["left", "right"]},
            },
            "tick 5: kick membrane, 1 tick",
        ),
        ({"event": "stop", "tick": 5, "reason": "'a\x1b[2J' did"}, "tick 5: stopped: 'a[2J' did"),
        ({"event": "params", "tick": 5, "set": {"k": 2.0}}, "tick 5: k = 2.0"),
        ({"event": "lost", "from": 3, "tick": 5}, "ticks 3 to 4: their records are lost"),
        ({"event": "something new", "tick": 5}, "tick 5: something new"),
    ],
)
def test_events_have_words(event, words):
    assert event_words(event) == words


# How it looks


def drawn(screen, width=100):
    console = Console(file=io.StringIO(), width=width, force_terminal=False)
    console.print(screen.render())
    return console.file.getvalue()


def test_the_table_says_it_all(watched):
    screen = OneRobot("tcp://brick", FOOT)
    watched.take_records([*kicked(10), *records(11, 13, late_s=0.0021, left_duty_pct=-85)])
    watched.take_event({"event": "stop", "tick": 13, "number": 9, "reason": "'bert' stopped it"})
    watched.lost = 4
    screen.take(watched.line())
    screen.add("kick phase +: the robot refuses")
    text = drawn(screen)
    for words in (
        "tcp://brick  tick 12  running   kick: membrane",
        "-85.00",
        "running: 'bert' stopped it",
        "driven by anna@lab, for 4 min",
        "7 deadlines missed and 3 ticks overrun so far; 4 records lost here",
        "2.1 ms late",
        "tick 13: stopped: 'bert' stopped it\nkick phase +: the robot refuses\n",
        "keys: space stop  1 membrane  2 position  3 phase +  4 phase -  5 rest  ? help  q quit",
    ):
        assert words in text
    assert len(text.splitlines()) <= 24


def test_nothing_of_an_address_or_a_robot_is_taken_for_markup(watched):
    uri = "tcp://[fe80::1%usb0]:5425"
    screen = OneRobot(uri, [])
    watched.take_status({**STATUS, "controller": "[red]x[/red]", "reason": "[bold]"})
    screen.take(watched.line())
    text = drawn(screen)
    assert uri in text
    assert "driven by [red]x[/red]" in text
    assert "running: [bold]" in text


def test_only_the_latest_happenings_stay(watched):
    screen = OneRobot("sim://", [])
    screen.take(watched.line())
    for number in range(50):
        screen.add(f"words {number}")
    text = drawn(screen)
    assert "words 49" in text
    assert "words 40" not in text


def test_before_the_first_record_it_says_so():
    assert "no record yet" in drawn(OneRobot("sim://", []))


def test_several_robots_have_a_row_each(watched):
    screen = SeveralRobots(["anna", "bert"], ["keys"])
    watched.take_records(kicked(10, "phase"))
    watched.take_event({"event": "stop", "tick": 11, "number": 9, "reason": "'bert' stopped it"})
    screen.take("anna", watched.line())
    screen.add("bert: no answer")
    text = drawn(screen)
    assert "anna  │ running       │ phase │ anna@lab" in text
    assert "bert  │ no record yet" in text
    assert "anna: tick 11: stopped: 'bert' stopped it\nbert: no answer\nkeys\n" in text


# Keys


@pytest.mark.parametrize(
    ("sent", "keys"),
    [
        (b"1 q?", "1 q?"),
        (b"\x1b[A\x1b[1~\x1b[1;5C\x1bOP2", "2"),  # up, Home, Ctrl-right, F1
        (b"\x1b1", ""),  # Alt-1
        (b"\x1b ", " "),  # a space stops, also behind Escape
        (b"\x1b[ ", " "),
        ("\u00e9\u20ac".encode(), "\u00c3\u00a9\u00e2\u0082\u00ac"),
    ],
)
def test_only_keys_are_keys_in_whatever_pieces_they_come(sent, keys):
    assert "".join(KeyParser().take(sent)) == keys
    parser = KeyParser()
    assert "".join(key for byte in sent for key in parser.take(bytes([byte]))) == keys


@pytest.mark.parametrize("key", KICKS)
def test_the_robot_takes_every_kick_of_the_keys(key):
    kick = parse({"id": "1", **KICKS[key].details}, (1, 1), Params(), 0)
    assert kick.ticks == {"1": 1, "2": 3, "3": 4, "4": 4, "5": 50}[key]
    if kick.mode == "phase":
        assert kick.values[0] == {"3": 1, "4": -1}[key] * DEFAULT_SHIFT_RAD


class FakeRobot:
    """Keeps what is asked of it; its answers are what a test sets."""

    def __init__(self):
        self.done = []
        self.refusal = None
        self.answers = threading.Event()
        self.answers.set()

    def kick(self, **details):
        self.done.append(details["mode"])
        if self.refusal:
            raise self.refusal

    def release(self):
        self.done.append("release")

    def stop_at_once(self):
        self.done.append("stop")
        self.answers.wait(30.0)
        if self.refusal:
            raise self.refusal
        return Stopped(7, "stopped", "")


class Rig:
    def __init__(self):
        self.robot, self.words, self.feet, self.now_s = FakeRobot(), [], [], 0.0
        self.actions = KeyActions(
            self.robot.stop_at_once, self.words.append, self.feet.append, clock=lambda: self.now_s
        )


@pytest.fixture
def keyed():
    rig = Rig()
    yield rig
    rig.robot.answers.set()
    rig.actions.close()


def test_a_kick_key_kicks_and_gives_control_back(keyed):
    keyed.actions.press("3")
    assert keyed.actions.waiting
    assert keyed.robot.done == []
    keyed.actions.kick(keyed.robot)
    assert keyed.robot.done == ["phase", "release"]
    assert not keyed.actions.waiting
    assert keyed.words == []


@pytest.mark.parametrize("kind", [LeaseLost, RefusedByRobot, NoLink])
def test_a_refused_kick_is_a_line_in_words(keyed, kind):
    keyed.robot.refusal = kind("'anna' controls the robot", "wait")
    keyed.actions.press("1")
    keyed.actions.kick(keyed.robot)
    assert keyed.words == ["kick membrane: 'anna' controls the robot; wait"]
    assert not keyed.actions.left


def test_a_kick_that_could_not_be_sent_is_not_sent_late(keyed):
    keyed.actions.press("1")
    keyed.now_s = STALE_S + 0.1
    keyed.actions.press("2")
    keyed.actions.kick(keyed.robot)
    assert keyed.robot.done == ["position", "release"]
    assert keyed.words == ["kick membrane: not sent, since the robot was out of reach"]


def test_a_stop_waits_for_nothing_and_nothing_waits_for_it(keyed):
    keyed.robot.answers.clear()
    keyed.actions.press("1")
    keyed.actions.press(" ")
    keyed.actions.press(" ")
    keyed.actions.press("?")
    keyed.actions.press("q")
    assert keyed.feet == [HELP_FOOT]
    assert keyed.actions.left
    keyed.robot.answers.set()
    keyed.actions.close()
    assert keyed.robot.done == ["stop"]  # the kick has not been asked for yet
    assert keyed.words == [
        "stop: sent; waiting for the robot's answer",
        "stop: motors stopped before tick 7; the robot is stopped",
    ]


def test_a_stop_that_nobody_confirms_is_no_success(keyed):
    keyed.robot.refusal = NoLink("the motors may still be running", "take out the battery")
    keyed.actions.press(" ")
    keyed.actions.close()
    assert keyed.words[-1] == "stop: the motors may still be running; take out the battery"


def test_other_keys_do_nothing(keyed):
    for key in "x06\x1c\n\t":
        keyed.actions.press(key)
    assert not keyed.actions.waiting
    assert (keyed.robot.done, keyed.words, keyed.feet) == ([], [], [])


def test_keys_drive_a_robot_that_is_watched():
    """The real robot's program in virtual time: who only watches keeps nobody out."""
    link = RigLink()
    with Robot(link, link.token) as robot:
        words = []
        actions = KeyActions(robot.stop_at_once, words.append, words.append)
        for key in "15":
            actions.press(key)
            actions.kick(robot)
            assert link.loop.lease.holder is None
            robot.wait(0.1)
        actions.press(" ")
        actions.close()
        assert STATES[link.loop.safety.state] == "stopped"
    kicks = [event["kick"]["mode"] for event in link.events() if event["event"] == "kick"]
    assert kicks == ["membrane", "pulse"]
    assert words[1].startswith("stop: motors stopped before tick")


# As a command


def test_json_lines_say_what_happened(kickctl):
    status, out, _ = kickctl("watch", "--seconds", "0.5", "--json", "--seed", "1")
    lines = [json.loads(line) for line in out.splitlines()]
    assert status == 0
    ticks = [line["tick"] for line in lines]
    assert ticks == sorted(ticks)
    assert [line["ticks"] for line in lines[1:]] == [late - soon for soon, late in pairwise(ticks)]
    assert lines[0]["reason"] == "started"
    assert {"controller", "missed", "overruns", "lost", "kicks", "events"} <= set(lines[0])


def test_without_a_terminal_there_are_no_keys_and_the_table_says_so(kickctl):
    status, out, _ = kickctl("watch", "--seconds", "0.3", "--seed", "1")
    assert status == 0
    assert "no keys: standard input and output are no terminal" in out
    assert "space stop" not in out


@pytest.mark.parametrize("seconds", ["0.001", "0.1"])
def test_a_short_watch_has_one_line_at_least(kickctl, seconds):
    status, out, _ = kickctl("watch", "--seconds", seconds, "--json")
    assert status == 0
    assert json.loads(out.splitlines()[0])["tick"] >= 0
