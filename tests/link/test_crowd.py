"""A host that finds no place at the robot, or whose links break soon, does not storm it."""

from itertools import pairwise

import pytest

from host.client.lasting_link import FIRST_PAUSE_S, GOOD_S, LONGEST_PAUSE_S
from host.client.robot import Robot
from host.errors import NotDone
from robot.server import RETRY_S


@pytest.fixture
def full(monkeypatch):
    """Call it, and robots have no place left."""

    def fill():
        monkeypatch.setattr("robot.server.PLACES", 0)
        monkeypatch.setattr("robot.server.SPARE_PLACES", 0)

    return fill


@pytest.fixture
def pauses(link, monkeypatch):
    """The host's pauses between two attempts (s), in which virtual time passes."""
    pauses = []

    def rest(robot, seconds):
        pauses.append(seconds)
        until = link.now() + seconds
        while link.now() < until:
            link.run_tick()

    monkeypatch.setattr(Robot, "_rest", rest)
    return pauses


@pytest.mark.parametrize("token", [True, False], ids=["with the token", "without it"])
def test_a_host_without_a_place_learns_when_to_come_again(link, full, token):
    full()
    with pytest.raises(NotDone, match=r"the robot refuses: all \d+ places .* are taken") as error:
        Robot(link, link.token if token else None)
    assert error.value.hint.startswith(f"try again in {RETRY_S} s")
    assert link.opened == 1


def test_who_finds_no_place_when_it_comes_back_stays_out(link, full, pauses):
    robot = Robot(link, None)
    robot.wait(1.0)
    full()
    link.cut()
    for _ in range(3):
        with pytest.raises(NotDone, match="are taken"):
            robot.wait(1.0)
    assert link.opened == 2


def test_links_that_break_soon_are_opened_again_ever_later(link, pauses):
    with Robot(link, None) as robot:
        for _ in range(20):
            robot.wait(0.5)
            link.cut()
        robot.wait(0.1)
        assert pauses[0] == FIRST_PAUSE_S
        assert all(late > soon for soon, late in pairwise(pauses[:5]))
        assert pauses[-1] == LONGEST_PAUSE_S
        assert link.opened == 21
        robot.wait(GOOD_S + 1.0)
        link.cut()
        robot.wait(0.1)
        assert pauses[-1] == 0.0
