"""A log has the ticks of the time that was asked for, in whatever portions they arrive."""

from types import SimpleNamespace

import pytest

from host.client.robot import connect
from host.logs.tap import Span


class Kept:
    """A tap that keeps everything in order."""

    def __init__(self):
        self.items = []

    def take_records(self, records):
        self.items += [record.tick for record in records]

    def take_event(self, event):
        self.items.append(event["event"])


def records(first, last, zero_s=7.0):
    return [SimpleNamespace(tick=tick, t_s=zero_s + 0.03 * tick) for tick in range(first, last)]


@pytest.mark.parametrize("portion", [1, 3, 7, 100])
def test_portions_change_nothing(portion):
    kept = Kept()
    span = Span(1.0, kept)
    for first in range(0, 100, portion):
        span.take_records(records(first, min(100, first + portion)))
    assert span.complete
    assert kept.items == list(range(34))


def test_it_is_complete_only_when_a_record_lies_behind_the_end():
    span = Span(1.0, Kept())
    span.take_records(records(0, 34))
    assert not span.complete
    span.take_records(records(34, 35))
    assert span.complete


def test_events_come_until_the_end_and_to_every_tap():
    taps = Kept(), Kept()
    span = Span(0.1, *taps)
    span.take_event({"event": "snapshot"})
    span.take_records(records(0, 2))
    span.take_event({"event": "kick"})
    span.take_records(records(2, 9))
    span.take_event({"event": "stop"})
    assert [tap.items for tap in taps] == [["snapshot", 0, 1, "kick", 2, 3]] * 2


def test_a_robot_that_starts_again_is_recorded_for_the_whole_time():
    kept = Kept()
    span = Span(0.1, kept)
    span.take_records(records(500, 503))
    span.take_event({"event": "restart"})
    span.take_records(records(0, 9, zero_s=0.0))
    assert kept.items == [500, 501, 502, "restart", 0, 1, 2, 3]


@pytest.mark.parametrize("seconds", [0.3, 1.0, 2.0])
def test_a_recording_has_the_ticks_of_its_time(seconds):
    with connect("sim://", seed=1) as robot:
        robot.wait(0.5)
        log = robot.record(seconds)
        again = robot.record(seconds)
    for one in (log, again):
        assert abs(len(one) - seconds / 0.03) <= 1
        assert one.missing() == []
