"""Actions that wait in between: in one go, and a little at a time."""

from types import SimpleNamespace

import pytest

from host.errors import NotDone
from host.kicking.steps import Slices, Wait, play


class Robot:
    """A robot whose time passes as the test says, or in a wait up to the given moments."""

    def __init__(self):
        self.t_s = 10.0
        self.done = []

    @property
    def newest(self):
        return SimpleNamespace(t_s=self.t_s)

    def wait(self, seconds, until=None):
        for _ in range(round(seconds)):
            if until is not None and until():
                return True
            self.t_s += 1.0
            if self.t_s > 100.0:
                raise NotDone("the robot was stopped meanwhile")
        return False


def steps(robot, longest_s=5.0):
    """Wait for a time, then for a moment, then tidy up."""
    try:
        robot.done.append((yield Wait(3.0)))
        robot.done.append((yield Wait(longest_s, lambda: robot.t_s >= 17.0)))
        return robot.t_s
    finally:
        robot.done.append("tidy")


def test_in_one_go_and_in_slices_the_same_is_done():
    blocked, sliced = Robot(), Robot()
    assert play(blocked, steps(blocked)) == 17.0
    slices = Slices(sliced, steps(sliced))
    found = []
    while not found or found[-1] is None:
        found.append(slices.go_on())
        sliced.t_s += 0.5
    assert found == 14 * [None] + [17.0]  # it has never gone on by itself
    assert blocked.done == sliced.done == [False, True, "tidy"]


def test_a_moment_that_does_not_come_ends_the_wait_in_both_ways():
    blocked, sliced = Robot(), Robot()
    play(blocked, steps(blocked, longest_s=2.0))
    slices = Slices(sliced, steps(sliced, longest_s=2.0))
    while slices.go_on() is None:
        sliced.t_s += 1.0
    assert blocked.done == sliced.done == [False, False, "tidy"]


def test_who_is_stopped_tidies_up_before_the_error_is_heard():
    blocked, sliced = Robot(), Robot()
    blocked.t_s = 99.0
    with pytest.raises(NotDone, match="meanwhile") as error:
        play(blocked, steps(blocked))
    slices = Slices(sliced, steps(sliced))
    assert slices.go_on() is None
    with pytest.raises(NotDone, match="meanwhile"):
        slices.go_on(error.value)
    assert blocked.done == sliced.done == ["tidy"]
