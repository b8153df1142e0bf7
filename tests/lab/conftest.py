"""A lab without sockets: a session, stations that only note what they are told, and pages."""

import json

import pytest

from host.lab.keys import Keys
from host.lab.session import Session
from host.lab.station import CONTINUE, STOP, Station


class NotingStation(Station):
    """A station that notes what it is told, and answers when a test says so."""

    hand_possible = True

    def __init__(self, name, rule=STOP):
        self.now = 0.0
        super().__init__(name, "tcp://nowhere", rule, "simulated")
        self.told = []
        self.answers = []
        self.attended_at = None

    def clock(self):
        return self.now

    def do(self, command, arguments, answer):
        self.told.append((command, arguments))
        self.answers.append(answer)

    def stop(self):
        self.told.append(("stop",))

    def abandon(self):
        self.told.append(("abandon",))

    def attend(self):
        self.attended_at = self.now

    def hand(self, wheel, angle_rad):
        self.told.append(("hand", wheel, angle_rad))

    def take(self):
        told, self.told = self.told, []
        return told


class Visit:
    """A page's end of a connection to a session."""

    def __init__(self, lab, key=None, *, local=True, resume=None):
        self.lab = lab
        self.page = lab.session.arrive(lab.now, local=local)
        self.got = []
        if key is not None:
            self.send("join", key=key, resume=resume)

    def send(self, kind, **fields):
        self.send_text(json.dumps({"type": kind, **fields}))

    def send_text(self, text):
        self.lab.session.receive(self.page, text, self.lab.now)
        self.read()

    def read(self):
        """Take what waits for the page."""
        self.got += self.page.waiting
        self.page.waiting.clear()

    def latest(self, kind):
        """The latest message of a type that the page has got; None if there is none."""
        self.read()
        return next((one for one in reversed(self.got) if one["type"] == kind), None)

    def ask(self, kind, **fields):
        """The reply to a request."""
        self.send(kind, request=len(self.got), **fields)
        return self.latest("reply")

    def leave(self):
        self.lab.session.leave(self.page)

    @property
    def drives(self):
        return self.latest("baton")["you"]


class QuietLab:
    """A session in virtual time with two robots: one that is to stop, one that may go on."""

    def __init__(self):
        self.now = 100.0
        self.keys = Keys()
        self.anna = NotingStation("anna", STOP)
        self.bert = NotingStation("bert", CONTINUE)
        self.session = Session(self.keys, [self.anna, self.bert])

    def driver(self, **options):
        return Visit(self, self.keys.drive, **options)

    def viewer(self, **options):
        return Visit(self, self.keys.view, **options)

    def stranger(self, key=None, **options):
        return Visit(self, key, **options)

    def wait(self, seconds, *awake):
        """Let time pass, while some pages beat."""
        for _ in range(round(seconds / 0.1)):
            self.now += 0.1
            for station in (self.anna, self.bert):
                station.now = self.now
            for visit in awake:
                visit.send("beat")
            self.session.tick(self.now)


@pytest.fixture
def lab():
    return QuietLab()
