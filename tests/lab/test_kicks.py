"""What pages hear of a kick: what was expected, what came of it, and who guessed right."""

import pytest

from host.lab.kicks import stall
from host.lab.session import Session
from host.lab.stepped_station import SteppedStation
from robot.params import Params
from tests.lab.conftest import QuietLab

EXPECTED = {side: {"reverses": 40, "continues": 8, "stops": 0} for side in ("left", "right")}


class Oracle:
    """Stands in for the process that predicts, and keeps what it is asked."""

    def __init__(self):
        self.questions = []

    def ask(self, question, done):
        self.questions.append(question)
        done({"shares": EXPECTED, "of": 48})


class Steps(QuietLab):
    """A session with an embedded robot that rolls."""

    def __init__(self):
        super().__init__()
        self.station = SteppedStation("sim://?seed=1", "anna")
        self.session = Session(self.keys, [self.station])
        self.station.pages = self
        self.station.forecasts = Oracle()
        self.station.step(3.0)

    def hear(self, message):
        self.session.hear(message)

    def wake(self):
        self.session.look()

    def call(self, function):
        function()


@pytest.fixture
def lab():
    lab = Steps()
    yield lab
    lab.station.close()


def kick(visit, **arguments):
    """The id of a kick that a page has done."""
    reply = visit.ask("do", robot="anna", command="kick", arguments=arguments)
    return reply["result"]["kick_id"]


def test_a_kick_is_predicted_from_the_records_before_it(lab):
    visit, other = lab.driver(), lab.viewer()
    identity = kick(visit, mode="membrane", guess="reverses")
    prediction = other.latest("prediction")
    assert prediction["kick_id"] == identity
    assert prediction["of"] == 48
    (question,) = lab.station.forecasts.questions
    lab.station.step(0.1)
    events = [one["event"] for one in other.got if one["type"] == "event"]
    begin = next(one["tick"] for one in events if one["event"] == "kick")
    assert question.records[-1].tick < begin
    assert question.records[-1].t_s - question.records[0].t_s > 1.0
    assert question.params["k"] == 8.0
    assert question.motor.torque_constant > 0.0


def test_the_outcome_says_who_has_guessed_right(lab):
    visit, other = lab.driver(), lab.driver()
    identity = kick(visit, mode="membrane", wheel="left", guess="reverses")
    lab.station.step(5.0)
    outcome = visit.latest("outcome")
    assert outcome["kick_id"] == identity
    assert outcome["result"] == {"left": "reverses"}
    assert outcome["reversed"]
    assert outcome["guess"] == other.latest("outcome")["guess"] == "reverses"
    assert outcome["score"] == {"guesses": 1, "right": 1, "predicted": 1, "simulation": 1}
    assert set(other.latest("outcome")["score"].values()) == {0}
    lab.station.forecasts = None
    kick(visit, mode="membrane", guess="continues")
    lab.station.step(5.0)
    visit.leave()
    again = lab.driver(resume=1)
    kick(again, mode="membrane", guess=None)
    lab.station.step(5.0)
    score = again.latest("outcome")["score"]
    assert score == {"guesses": 2, "right": 1, "predicted": 1, "simulation": 1}


def test_the_simulation_can_be_wrong_where_a_guess_is_right(lab, monkeypatch):
    monkeypatch.setitem(EXPECTED["right"], "continues", 48)
    visit = lab.driver()
    kick(visit, mode="membrane", guess="reverses")
    lab.station.step(5.0)
    score = visit.latest("outcome")["score"]
    assert score == {"guesses": 1, "right": 1, "predicted": 1, "simulation": 0}


def test_a_stop_leaves_no_outcome(lab):
    visit = lab.driver()
    kick(visit, mode="membrane", guess="reverses")
    lab.station.step(0.2)
    visit.send("stop", robot="anna")
    lab.station.step(10.0)
    outcome = visit.latest("outcome")
    assert (outcome["result"], outcome["right"], outcome["score"]["guesses"]) == ({}, None, 0)
    assert "stopped before its wheels had settled" in outcome["why"]
    assert visit.latest("state")["state"] == "stopped"


def test_anyone_may_ask_what_a_kick_would_do(lab):
    visit = lab.viewer()
    reply = visit.ask("predict", robot="anna", kick={"mode": "phase", "ticks": 4})
    assert reply["result"] == {"shares": EXPECTED, "of": 48}
    assert "error" in visit.ask("predict", robot="anna", kick=7)
    lab.station.forecasts = None
    error = visit.ask("predict", robot="anna", kick={"mode": "phase"})["error"]
    assert "does not predict" in error["message"]


def test_a_preset_and_a_primitive_are_done_by_name(lab):
    visit = lab.driver()
    welcome = visit.latest("welcome")
    names = [preset["name"] for preset in welcome["presets"]]
    assert names == ["rest", "gentle", "locomotion", "chaos"]
    visit.send("do", request=1, robot="anna", command="preset", arguments={"name": "gentle"})
    lab.station.step(1.0)
    assert visit.latest("state")["params"]["k"] == 2.0
    primitive = {"robot": "anna", "command": "primitive", "arguments": {"name": "spin-left"}}
    reply = visit.ask("do", **primitive)
    assert reply["result"]["after"] == {"left": "backward", "right": "forward"}


def test_the_stall_band_is_that_of_the_paper_and_unknown_for_an_unknown_motor(lab):
    in_force = Params().values()
    assert lab.driver().latest("welcome")["robots"][0]["stall"] == pytest.approx(0.1)
    assert stall({}, in_force) == pytest.approx(0.1)
    assert stall({"motor": ""}, in_force) is None
    assert stall({"motor": "of my own"}, in_force) is None
    assert stall({}, {**in_force, "max_duty_pct": 0.0}) == 1.0


def test_a_page_that_came_before_its_robot_is_welcomed_again(lab):
    visit = lab.driver()
    visit.got.clear()
    lab.station._known = False
    lab.station.take_event(lab.station._follower.snapshot(lab.station._tick))
    welcome = visit.latest("welcome")
    assert welcome["page"] == 1
    assert welcome["robots"][0]["motor"] == "pybricks"
    assert visit.latest("baton")["driver"] is None
    assert visit.page.places["anna"] < lab.station.ring.end


def test_a_refused_kick_is_not_predicted(lab):
    visit = lab.driver()
    reply = visit.ask("do", robot="anna", command="kick", arguments={"mode": "fly"})
    assert "refuses" in reply["error"]["message"]
    assert lab.station.forecasts.questions == []
