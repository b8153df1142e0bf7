"""A page that runs its lab by itself, without a browser."""

import json
import struct

from host.lab.browser_lab import BrowserLab
from robot.record import STRUCT, unpack

HEADER = struct.Struct("<BBHI")


def records_of(message):
    """The robot's records in a binary message for its page, with none missing."""
    kind, robot, count, missed = HEADER.unpack_from(message)
    assert (kind, robot, missed) == (1, 0, 0)
    size = (len(message) - HEADER.size) // count
    places = range(HEADER.size, len(message), size)
    return [record for at in places for record in unpack(message[at : at + STRUCT.size])]


class Visit:
    """A page that runs its lab: sends commands, lets time pass, and keeps what it hears."""

    def __init__(self, seed=1):
        self.now = 100.0
        self.heard, self.records = [], []
        self.lab = BrowserLab(seed, self.now, self.hear)
        self._requests = 0

    def hear(self, message):
        if isinstance(message, str):
            self.heard.append(json.loads(message))
            return
        self.records += records_of(message)

    def say(self, **message):
        self._requests += 1
        message |= {"request": self._requests}
        self.tell(message)
        return self.reply(self._requests)

    def reply(self, request):
        """What has been answered to a request, which are counted from 1; None before that."""
        return next((one for one in self.heard if one.get("request") == request), None)

    def tell(self, message):
        self.lab.receive(json.dumps(message, allow_nan=False), self.now)

    def do(self, command, **arguments):
        robot = self.welcome["robots"][0]["name"]
        return self.say(type="do", robot=robot, command=command, arguments=arguments)

    def wait(self, seconds):
        for _ in range(round(seconds / 0.02)):
            self.now += 0.02
            self.lab.step(self.now)

    def last(self, kind):
        return [one for one in self.heard if one["type"] == kind][-1]

    @property
    def welcome(self):
        return self.last("welcome")
