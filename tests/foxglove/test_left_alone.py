"""A robot that is driven by viewers stops, or is given back, when none of them watches it."""

import json
from types import SimpleNamespace

import pytest

from host.foxglove.control import ALONE_S, Control
from host.logs.messages import EVENTS, TICKS
from tests.foxglove.stations import FakeStation


class Rig:
    """The control of one robot, two viewers, and virtual time."""

    def __init__(self):
        self.station = FakeStation()
        self.now = 0.0
        self.control = Control({"": self.station}, clock=lambda: self.now)

    def unlock(self, client):
        (service,) = [one for one in self.control.services() if one.name == "/unlock"]
        payload = json.dumps({"key": self.control.key}).encode()
        service.handler(SimpleNamespace(client_id=client, payload=payload))

    def watch(self, client, topic=TICKS):
        self.control.on_subscribe(SimpleNamespace(id=client), SimpleNamespace(topic=topic))

    def leave(self, client, topic=TICKS):
        self.control.on_unsubscribe(SimpleNamespace(id=client), SimpleNamespace(topic=topic))

    def look(self, after_s=0.1):
        self.now += after_s
        self.station.asked.clear()
        self.control.look()
        return self.station.asked


@pytest.fixture
def rig():
    return Rig()


def test_who_watches_and_may_drive_is_there(rig):
    rig.watch(1)
    assert rig.look() == []
    rig.unlock(1)
    assert rig.look(5.0) == ["attend"]
    assert rig.look(5.0) == ["attend"]


def test_nobody_is_left_after_a_second(rig):
    rig.unlock(1)
    rig.watch(1)
    rig.watch(2)
    rig.look()
    rig.leave(1)
    assert rig.look(0.9 * ALONE_S) == ["attend"]  # such as while a page is loaded again
    assert rig.look(0.2 * ALONE_S) == ["abandon"]
    assert rig.look() == []


def test_another_driver_stays(rig):
    for client in (1, 2):
        rig.unlock(client)
        rig.watch(client)
    rig.look()
    rig.leave(1)
    assert rig.look(2.0) == ["attend"]


def test_who_sees_events_only_does_not_watch(rig):
    rig.unlock(1)
    rig.watch(1, EVENTS)
    assert rig.look() == []
