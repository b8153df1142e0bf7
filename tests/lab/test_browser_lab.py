"""The lab that a page runs by itself."""

import subprocess
import sys

import pytest

from host.lab.browser_lab import MOST_S
from tests.lab.own_lab import Visit
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


# What a page gets at most after 0.04 s of a primitive: to ask the robot something takes it a tick.
MOST_TICKS = 8


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


def test_parameters_can_be_chosen(visit):
    visit.wait(1.0)
    assert "result" in visit.do("set", set={"k": 5.0})
    visit.wait(0.1)
    assert visit.last("state")["params"]["k"] == 5.0


def test_a_primitive_goes_on_with_the_page(visit):
    visit.wait(1.0)
    assert visit.do("primitive", name="spin-left") is None
    began = tick = visit.records[-1].tick
    while visit.reply(1) is None:
        visit.wait(0.04)
        assert 0 < visit.records[-1].tick - tick <= MOST_TICKS
        tick = visit.records[-1].tick
    assert visit.reply(1)["result"]["reached"]
    assert tick - began > 50  # it has taken its time
    assert "into a primitive" not in str(visit.do("kick", mode="membrane"))


def test_a_stop_ends_a_primitive_in_the_next_tick(visit):
    visit.wait(1.0)
    visit.do("primitive", name="spin-left")
    visit.wait(0.3)
    assert "into a primitive" in visit.do("kick", mode="membrane")["error"]["message"]
    assert visit.reply(1) is None
    last = visit.records[-1].tick
    visit.tell({"type": "stop", "robot": None})
    assert "stopped meanwhile" in visit.reply(1)["error"]["message"]
    visit.wait(0.5)
    stopped = [record for record in visit.records if record.tick > last + 1]
    assert {record.left_duty_pct for record in stopped} == {0}
    assert "result" in visit.do("start")
    visit.wait(0.5)
    assert visit.last("state")["state"] == "running"


def test_a_hand_turns_a_wheel_of_a_robot_at_rest_and_lets_go(visit):
    visit.wait(0.5)
    visit.tell({"type": "stop", "robot": None})
    visit.say(type="take")
    visit.wait(0.5)
    begin_rad = visit.records[-1].left_phi_rad
    for _ in range(20):
        pulled = {"robot": "simulated", "wheel": "left", "angle_rad": begin_rad + 0.5}
        visit.tell({"type": "hand", **pulled})
        visit.wait(0.1)
    held_rad = visit.records[-1].left_phi_rad
    assert held_rad == pytest.approx(begin_rad + 0.5, abs=0.1)
    visit.tell({"type": "hand", "robot": "simulated", "wheel": "left", "angle_rad": None})
    visit.wait(1.0)
    assert visit.records[-1].left_phi_rad == pytest.approx(held_rad, abs=0.02)
    assert visit.welcome["robots"][0]["hand"]


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
