"""Pages that want a robot's basins get them, coarse first, and never those of other parameters."""

import pytest

from host.errors import NotDone
from host.lab.basin_pictures import SIDES
from tests.lab.test_kicks import Steps


class Computer:
    """Stands in for the process that computes, and answers when a test says so."""

    def __init__(self):
        self.waiting = []

    def ask(self, work, question, done):
        self.waiting.append((question, done))

    def answer(self, error=None):
        """Answer the only question. Returns it."""
        ((question, done),) = self.waiting
        self.waiting.clear()
        first, last = question.rows
        assert question.radius == (0.3 if first else None)
        ends = question.side * "fb"[first > 0] * (last - first)
        done(error or {"ends": ends, "radius": 0.3, "phi_rad": 0.0, "fastest": 3.0})
        return question

    def finish(self):
        """Answer all questions of a picture. Returns the last one."""
        while (question := self.answer()).rows[1] < question.side:
            assert question.side * (question.rows[1] - question.rows[0]) <= 512
        return question


@pytest.fixture
def lab():
    lab = Steps()
    lab.station.basins = Computer()
    yield lab
    lab.station.close()


def sides(visit):
    """The sides of the pictures that a page has got, in their order."""
    visit.read()
    return [one["side"] for one in visit.got if one["type"] == "basins" and "side" in one]


def test_only_who_wants_basins_gets_them_coarse_first(lab):
    visit, other = lab.viewer(), lab.viewer()
    visit.send("basins", robot="anna")
    computer = lab.station.basins
    assert [computer.finish().side for _ in SIDES] == list(SIDES)
    assert computer.waiting == []
    assert sides(visit) == list(SIDES)
    assert visit.latest("basins")["ends"] == 8 * 64 * "f" + 56 * 64 * "b"
    assert visit.latest("basins")["counts"]["forward"] == 8 * 64
    assert sides(other) == []
    other.send("basins", robot="anna")  # no work for who comes later
    assert computer.waiting == []
    assert sides(other) == [SIDES[-1]]


def test_a_change_supersedes_what_is_under_way(lab):
    visit = lab.driver()
    visit.send("basins", robot="anna")
    computer = lab.station.basins

    def set_k(k):
        visit.send("do", request=1, robot="anna", command="set", arguments={"set": {"k": k}})
        lab.station.step(0.1)

    set_k(2.0)
    set_k(3.0)
    assert computer.finish().params["k"] == 8.0
    assert sides(visit) == []
    assert [computer.finish().params["k"] for _ in range(2)] == [3.0, 3.0]
    assert sides(visit) == list(SIDES[:2])
    assert visit.latest("basins")["params"]["k"] == 3.0
    assert computer.answer().side == SIDES[2]
    set_k(4.0)
    assert computer.answer().params["k"] == 3.0  # it was under way; the rest of it is not
    assert computer.finish().params["k"] == 4.0
    assert sides(visit) == [*SIDES[:2], SIDES[0]]
    computer.finish()
    computer.finish()
    # What decides nothing about where a wheel ends asks for nothing.
    visit.send("do", request=1, robot="anna", command="set", arguments={"set": {"link_loss_s": 2}})
    lab.station.step(0.1)
    assert computer.waiting == []


def test_who_wants_none_any_more_costs_nothing(lab):
    visit = lab.driver()
    for name in ("anna", None):
        visit.send("basins", robot=name)
    computer = lab.station.basins
    for _ in SIDES:
        computer.finish()
    visit.send("do", request=1, robot="anna", command="set", arguments={"set": {"k": 2.0}})
    lab.station.step(0.1)
    assert computer.waiting == []
    assert sides(visit) == []
    assert "no robot" in visit.ask("basins", robot="carl")["error"]["message"]


def test_a_failure_is_said_and_the_next_wish_tries_again(lab):
    visit = lab.viewer()
    visit.send("basins", robot="anna")
    computer = lab.station.basins
    computer.answer(NotDone("the process that computes basins has ended", "try again"))
    assert "has ended" in visit.latest("basins")["why"]
    assert computer.waiting == []
    visit.send("basins", robot="anna")
    computer.answer()
    assert sides(visit) == [SIDES[0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"_walls_m": 2.0}, "has walls"),
        ({"_hello": {"motor": "of my own"}}, "nobody here knows the motors"),
        ({"_known": False}, "not been found yet"),
        ({"basins": None}, "does not compute"),
    ],
)
def test_why_there_are_none_is_said_in_words(lab, change, words):
    vars(lab.station).update(change)
    visit = lab.viewer()
    visit.send("basins", robot="anna")
    assert words in visit.latest("basins")["why"]
