"""A hand on simulated wheels, led through a pipe, in virtual time."""

import os
from math import pi

import pytest

from robot.loop import Loop
from sim_motor.brick import SimBrick
from sim_motor.hand import MOST_NM, SILENCE_S, Hand, pull
from sim_motor.scene import Scene


class Desk:
    """A robot with a hand on it, and the other end of the hand's pipe."""

    def __init__(self, scene=None, **params):
        self.brick = SimBrick(1, scene=scene)
        self.loop = Loop(self.brick.motors, self.brick.battery, self.brick.clock, 1)
        if params:
            self.loop.set_params(params)
        lines, self.pipe = os.pipe()
        self.said = []
        self.hand = Hand(self.brick, lines, self.said.append)
        self.ends = [lines, self.pipe]

    def write(self, text):
        os.write(self.pipe, text.encode())

    def run(self, seconds, line=""):
        """Let time pass, with a line before each tick."""
        until_s = self.loop.clock.now() + seconds
        while self.loop.clock.now() < until_s and not self.loop.done:
            if line:
                self.write(line + "\n")
            self.loop.clock.wait(self.loop.deadline, lambda timeout_s: self.hand.serve(self.loop))
            self.loop.tick()

    def phi(self, side=0):
        return self.brick.truth()[side].wheel_angle

    def loads(self):
        return [motor.drive()[2] for motor in self.brick.motors]

    def hang_up(self):
        os.close(self.ends.pop())


@pytest.fixture
def make_desk():
    desks = []

    def make(*arguments, **options):
        desks.append(Desk(*arguments, **options))
        return desks[-1]

    yield make
    for desk in desks:
        for end in desk.ends:
            os.close(end)


@pytest.mark.parametrize("scene", [None, Scene(walls=2.0)], ids=["alone", "between walls"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_it_turns_a_resting_wheel_to_the_angle_and_leaves_the_other(make_desk, side, scene):
    """On a body that is turned, the other wheel moves within the play of its motor."""
    desk = make_desk(scene)
    play = desk.brick.motors[0].constants.backlash
    index = ("left", "right").index(side)
    before, other = desk.phi(index), desk.phi(1 - index)
    desk.run(3.0, f"{side} {before + 2.0}")
    assert desk.phi(index) == pytest.approx(before + 2.0, abs=0.1)
    assert desk.phi(1 - index) == pytest.approx(other, abs=0.01 if scene is None else play)


@pytest.mark.parametrize("scene", [None, Scene(walls=2.0)], ids=["alone", "between walls"])
def test_it_holds_a_wheel_whose_motor_runs(make_desk, scene):
    desk = make_desk(scene)
    desk.loop.start()
    desk.run(2.0)
    held, free = desk.phi(0), desk.phi(1)
    desk.run(3.0, f"left {held}")
    assert abs(desk.phi(0) - held) < pi / 4
    assert abs(desk.phi(1) - free) > 4 * pi


def test_it_means_the_angle_as_the_robot_counts_it(make_desk):
    desk = make_desk(polarity_left=-1)
    goal = -desk.phi() + 1.0
    desk.run(3.0, f"left {goal}")
    assert -desk.phi() == pytest.approx(goal, abs=0.1)


def test_it_is_never_stronger_than_its_cap(make_desk):
    assert pull(100.0, 0.0) == MOST_NM == -pull(-100.0, 0.0)
    assert pull(0.1, 0.0) > 0.0 > pull(0.0, 1.0)
    desk = make_desk()
    desk.run(0.3, "left 1e300")
    assert desk.loads() == [MOST_NM, 0.0]


def test_it_lets_go_when_told_or_when_it_hears_nothing(make_desk):
    desk = make_desk()
    desk.run(0.3, "left 99")
    desk.run(SILENCE_S - 0.1)
    assert desk.loads()[0] > 0.0
    desk.run(0.2)
    assert desk.loads() == [0.0, 0.0]
    desk.run(0.3, "left 99")
    desk.run(0.1, "left -")
    assert desk.loads() == [0.0, 0.0]


def test_the_end_of_the_input_lets_go_and_ends_the_program(make_desk):
    desk = make_desk()
    desk.run(0.3, "left 99\nright -99")
    assert not desk.loop.done
    assert desk.loads()[0] > 0.0 > desk.loads()[1]
    desk.hang_up()
    desk.run(0.1)
    assert desk.loop.done
    assert desk.loads() == [0.0, 0.0]


def test_it_lets_go_when_the_program_closes_it(make_desk):
    desk = make_desk()
    desk.run(0.3, "left 99")
    desk.hand.close()
    assert desk.loads() == [0.0, 0.0]


@pytest.mark.parametrize(
    "line",
    [
        "",
        "left",
        "up 1.0",
        "left one",
        "left nan",
        "left inf",
        "left 1 2",
        "Left 1",
        "\x00\u1234",
        "x" * 3000,
    ],
)
def test_a_wrong_line_is_ignored_and_named_once(make_desk, line):
    desk = make_desk()
    desk.write(line + "\n" + line + "\n")
    desk.run(0.2)
    assert desk.loads() == [0.0, 0.0]
    assert len(desk.said) == 1
    assert "left 1.25" in desk.said[0]
    desk.run(0.3, "left 99")
    assert desk.loads()[0] > 0.0


def test_a_line_may_come_in_parts(make_desk):
    desk = make_desk()
    for part in ("le", "ft 9", "9", "\nri"):
        desk.write(part)
        desk.run(0.05)
    assert desk.loads()[0] > 0.0
    assert desk.said == []
