"""A STOP that has not reached a robot, because that was lost."""

from contextlib import contextmanager

import pytest

from host.client.robot import connect
from host.errors import NoLink
from host.lab.stopper import LAB
from tests.lab.live import Answers, Beating, started, state, station_at
from tests.live import Relay, wait_until


@contextmanager
def lost_while_it_runs(desk):
    """A station on a robot that another host drives, and the relay that has cut it off."""
    relay = Relay(int(desk.uri.rpartition(":")[2]))
    try:
        with (
            connect(desk.uri, token=desk.token) as other,
            station_at(relay.uri, desk.token) as station,
        ):
            other.start()
            relay.cut(3600.0)
            yield station, relay
    finally:
        relay.close()


def said(station, words):
    return any(words in one.get("message", "") for one in station.pages.heard)


def test_a_stop_reaches_a_robot_that_was_lost_as_soon_as_it_is_back(desk, observer):
    with lost_while_it_runs(desk) as (station, relay):
        station.note_asker(3)
        station.stop()
        wait_until(
            lambda: said(station, "still be running"), "it says that nobody has confirmed it"
        )
        assert state(observer) == "running"
        relay.refuses_until = 0.0
        wait_until(lambda: state(observer) == "stopped", "the robot stops")
        wait_until(lambda: said(station, "STOP was pressed"), "it says why")
        wait_until(lambda: station.state()["stopped_by"] == 3, "it is that page's stop")
        with Beating(station):
            started(station)
            before = station._status
            wait_until(lambda: station._status is not before, "it has looked again")
            assert state(observer) == "running"  # once is enough


@pytest.mark.parametrize("asker", [3, LAB])
def test_a_stop_that_nobody_wants_any_more_does_not(desk, observer, asker):
    with lost_while_it_runs(desk) as (station, relay):
        station.note_asker(asker)
        station.stop()
        wait_until(
            lambda: said(station, "still be running"), "it says that nobody has confirmed it"
        )
        if asker != LAB:
            answers = Answers()
            station.do("start", {}, answers)
            assert isinstance(answers.next(), NoLink)
        before = station._status
        relay.refuses_until = 0.0
        wait_until(lambda: station._status is not before, "it has looked again")
        before = station._status
        wait_until(lambda: station._status is not before, "and once more")
        assert state(observer) == "running"
