"""The Python end of a robot in a notebook: what its page gets, and what a stop waits for."""

import gc
import struct
import threading
from weakref import ref

import pytest

from host.client.robot import connect
from host.errors import NoLink
from host.lab.shown_robot import PATIENCE_S, ShownRobot
from robot.record import STRUCT

HEADER = struct.Struct("<BBHI")


class Page:
    """What has been sent to a widget's page."""

    def __init__(self):
        self.got = []
        self.records = b""
        self.missed = 0
        self.changed = threading.Condition()

    def take(self, message, buffers):
        with self.changed:
            self.got.append(message)
            for buffer in buffers or []:
                _, _, count, missed = HEADER.unpack_from(buffer)
                self.records += buffer[HEADER.size :]
                self.missed += missed
                assert (len(buffer) - HEADER.size) % count == 0
            self.changed.notify()

    def kinds(self):
        return [message["type"] for message in self.got]

    def await_kind(self, kind):
        """The first message of this kind, as soon as it has come."""
        with self.changed:
            assert self.changed.wait_for(lambda: kind in self.kinds(), 20.0), self.kinds()
        return next(message for message in self.got if message["type"] == kind)


@pytest.fixture
def robot():
    with connect("sim://", seed=1) as robot:
        yield robot


@pytest.fixture
def page():
    return Page()


@pytest.fixture
def shown(robot, page):
    """The robot as shown, without its thread: `tell` sends what is new."""
    return ShownRobot(robot, page.take, lambda: None)


def test_an_embedded_robot_whose_time_stands_still_is_not_lost(robot, shown, monkeypatch):
    robot.wait(1)
    later = shown.clock() + 10.0
    monkeypatch.setattr(shown, "clock", lambda: later)
    assert shown.state()["link"] == "up"


def test_who_joins_gets_what_was_and_then_what_comes_with_the_robots_own_bits(robot, shown, page):
    robot.wait(1)
    shown.tell()
    assert page.got == []  # nobody looks yet
    shown.take({"type": "join"})
    shown.tell()
    robot.kick("phase", ticks=4)
    robot.wait(1)
    shown.tell()
    assert page.kinds() == ["welcome", "records", "state", "event", "records"]
    welcome, _, state, event, _ = page.got
    assert (welcome["embedded"], welcome["robot"]["name"]) == (True, "sim://")
    assert event["event"]["kick"]["mode"] == "phase"
    assert (state["state"], state["link"]) == ("running", "up")
    size = len(page.records) // shown.ring.end
    packed = [page.records[at : at + STRUCT.size] for at in range(0, len(page.records), size)]
    assert packed == [STRUCT.pack(*record) for record in robot.recent()[-shown.ring.end :]]
    assert page.missed == 0


def test_who_is_away_gets_nothing_and_afterwards_all_that_matters(robot, shown, page, monkeypatch):
    shown.take({"type": "join"})
    shown.tell()
    page.got.clear()
    now = shown.clock() + PATIENCE_S + 1
    monkeypatch.setattr(shown, "clock", lambda: now)
    robot.kick("membrane")
    robot.wait(40)  # more than the ring holds
    shown.tell()
    assert page.got == []
    shown.take({"type": "here"})
    shown.tell()
    assert page.kinds()[0] == "welcome"
    assert page.got[0]["robot"]["events"][-2]["event"] == "kick"
    assert "event" not in page.kinds()


def test_a_page_that_is_too_slow_is_told_what_it_has_missed(robot, shown, page):
    shown.take({"type": "join"})
    shown.tell()
    robot.wait(40)
    shown.tell()
    assert page.missed > 0
    shown.take({"type": "here"})  # it was never away
    shown.tell()
    assert page.kinds().count("welcome") == 1


def test_a_stop_is_confirmed_by_what_the_robot_says(robot, shown, page):
    robot.wait(1)
    shown.take({"type": "stop"})
    said = page.await_kind("stopped")["said"]
    assert said.startswith("motors stopped before tick")
    assert robot.status()["state"] == "stopped"


@pytest.mark.parametrize("gone", [False, True])
def test_a_stop_reaches_a_robot_whose_connection_is_closed_or_gone(page, gone):
    robot = connect("sim://", seed=1)
    loop = robot.link.loop
    shown = ShownRobot(robot, page.take, lambda: None)
    shown.take({"type": "join"})
    if gone:
        del robot
        gc.collect()
    else:
        robot.close()
    shown.tell()
    assert page.got[-1]["link"] == "lost"
    assert "is closed" in page.got[-1]["closed"]
    shown.take({"type": "stop"})
    page.await_kind("stopped")
    assert loop.safety.state == 3


def test_a_stop_that_nobody_confirms_says_so(robot, shown, page, monkeypatch):
    def fail():
        raise NoLink("the stop was sent, but no answer has come", "try again")

    monkeypatch.setattr(robot, "stop_at_once", fail)
    shown.take({"type": "stop"})
    assert page.await_kind("unconfirmed")["hint"] == "try again"
    assert "stopped" not in page.kinds()


def test_it_keeps_no_connection_alive(page):
    robot = connect("sim://", seed=1)
    alive = ref(robot)
    shown = ShownRobot(robot, page.take, lambda: None)
    shown.take({"type": "join"})
    shown.tell()
    del robot
    gc.collect()
    assert alive() is None
    assert shown.state()["link"] == "lost"


def test_it_ends_when_nobody_looks_any_more(robot, page):
    forgotten = threading.Event()
    shown = ShownRobot(robot, page.take, forgotten.set)
    shown.begin()
    shown.take({"type": "join"})
    page.await_kind("welcome")
    shown.take({"type": "leave"})
    assert forgotten.wait(20.0)
    end = shown.ring.end
    robot.wait(1)
    assert shown.ring.end == end
