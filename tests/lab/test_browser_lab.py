"""The lab that a page runs by itself."""

import json
import struct
import subprocess
import sys

import pytest

from host.lab.browser_lab import MOST_S, BrowserLab
from robot.record import STRUCT, unpack
from tests.lint.sources import ROOT

# What a browser has not, or what takes it long to load.
MISSING = ("numpy", "numba", "scipy", "mcap", "aiohttp", "segno", "concurrent", "robot.server")
SCRIPT = f"""
import sys
sys.modules.update(dict.fromkeys({MISSING}))
from host.lab.browser_lab import BrowserLab
heard = []
lab = BrowserLab(1, 0.0, heard.append)
for step in range(100):
    lab.step(step / 50)
assert len(heard) > 50, heard
"""


class Visit:
    """A page that runs its lab: sends commands, lets time pass, and keeps what it hears."""

    def __init__(self, seed=1):
        self.now = 100.0
        self.heard, self.records = [], []
        self.lab = BrowserLab(seed, self.now, self.hear)
        self._size = STRUCT.size
        self._requests = 0

    def hear(self, message):
        if isinstance(message, str):
            self.heard.append(json.loads(message))
            return
        kind, robot, count, missed = struct.unpack_from("<BBHI", message)
        assert (kind, robot, missed) == (1, 0, 0)
        size = (len(message) - 8) // count
        for place in range(count):
            begin = 8 + place * size
            self.records += unpack(message[begin : begin + STRUCT.size])

    def say(self, **message):
        self._requests += 1
        message |= {"request": self._requests}
        self.tell(message)
        replies = [one for one in self.heard if one.get("request") == self._requests]
        return replies[-1]

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


@pytest.fixture
def visit():
    return Visit()


def test_a_kick_reverses_the_robot_and_the_page_hears_of_it(visit):
    visit.wait(3.0)
    assert visit.welcome["role"] == "drive"
    assert visit.do("kick", mode="phase", ticks=4, guess="reverses")["result"]["tick"] == 100
    visit.wait(3.0)
    outcome = visit.last("outcome")
    assert set(outcome["result"].values()) == {"reverses"}
    assert (outcome["right"], outcome["score"]["right"]) == (True, 1)
    ticks = [record.tick for record in visit.records]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    assert any(record.kick for record in visit.records)


def test_a_stop_stops_it_and_says_that_this_page_did(visit):
    visit.wait(1.0)
    visit.tell({"type": "stop", "robot": None})
    visit.wait(0.5)
    state = visit.last("state")
    assert (state["state"], state["stopped_by"]) == ("stopped", visit.welcome["page"])
    assert visit.records[-1].left_duty_pct == 0
    assert "result" in visit.do("start")
    visit.wait(0.5)
    assert visit.last("state")["state"] == "running"


def test_parameters_and_primitives_can_be_chosen(visit):
    visit.wait(1.0)
    assert "result" in visit.do("set", set={"k": 5.0})
    visit.wait(0.1)
    assert visit.last("state")["params"]["k"] == 5.0
    assert visit.do("primitive", name="spin-left")["result"]["reached"]
    # The seconds that it took are behind the robot, not before it.
    before = visit.records[-1].tick
    visit.wait(0.3)
    assert 9 <= visit.records[-1].tick - before <= 11


def test_it_does_not_catch_up_hours_in_which_the_page_slept(visit):
    visit.wait(0.5)
    before = visit.records[-1].tick
    visit.now += 3600.0
    visit.lab.step(visit.now)
    assert visit.records[-1].tick - before <= round(MOST_S / 0.03) + 1
    visit.wait(0.3)
    assert visit.records[-1].t_s < 2.0


def test_what_a_page_cannot_do_alone_is_refused_in_words(visit):
    visit.wait(0.5)
    assert visit.welcome["robots"][0]["alone"]
    assert "keeps no logs" in visit.do("record", on=True)["error"]["message"]
    robot = visit.welcome["robots"][0]["name"]
    answer = visit.say(type="predict", robot=robot, kick={"mode": "phase", "ticks": 4})
    assert "does not predict" in answer["error"]["message"]
    visit.tell({"type": "basins", "robot": robot})
    visit.wait(0.1)
    assert "does not compute" in visit.last("basins")["why"]


def test_the_same_seed_gives_the_same_robot_and_another_one_another():
    runs = []
    for seed in (1, 1, 2):
        visit = Visit(seed)
        visit.wait(1.0)
        runs.append(visit.records)
    assert runs[0] == runs[1] != runs[2]


def test_it_needs_nothing_that_a_browser_lacks():
    subprocess.run([sys.executable, "-c", SCRIPT], cwd=ROOT, check=True)
