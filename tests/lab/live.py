"""Stations on robots in real time, and who drives them."""

import threading
from contextlib import contextmanager

from host.lab.live_station import LiveStation
from host.lab.station import STOP
from host.link.robots_file import Known


class Ears:
    """Hears what a station tells pages."""

    def __init__(self):
        self.heard = []

    def hear(self, message):
        self.heard.append(message)

    def wake(self):
        pass

    def call(self, function):
        function()


class Answers:
    """Answers to commands, in the order in which they come."""

    def __init__(self):
        self._come = []
        self._one = threading.Semaphore(0)

    def __call__(self, result):
        self._come.append(result)
        self._one.release()

    def next(self):
        assert self._one.acquire(timeout=100.0), "no answer has come"
        return self._come.pop(0)


def state(observer):
    return observer.status()["state"]


def controller(observer):
    return observer.status()["controller"]


@contextmanager
def station_at(uri, token, rule=STOP):
    station = LiveStation(Known("anna", uri, token), rule, "simulated")
    station.pages = Ears()
    station.start()
    try:
        assert station.met.wait(20.0)
        yield station
    finally:
        station.end()


class Beating:
    """Somebody who drives and is there, until `cease`."""

    def __init__(self, *stations):
        self._ceased = threading.Event()
        self._stations = stations
        self._thread = threading.Thread(target=self._beat, daemon=True)

    def _beat(self):
        while not self._ceased.wait(0.05):
            for station in self._stations:
                station.attend()

    def cease(self):
        self._ceased.set()
        self._thread.join()

    def __enter__(self):
        for station in self._stations:
            station.attend()
        self._thread.start()
        return self

    def __exit__(self, *_):
        self.cease()


def started(station):
    """Start the robot through its station."""
    answers = Answers()
    station.do("start", {}, answers)
    assert "tick" in answers.next()
