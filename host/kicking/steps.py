"""Actions that wait in between, done in one go or a little at a time.

They are a generator, which yields each Wait and gets whether its condition has ended it. So the
same actions run in a program that may block, and in a page's worker, which must not.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Generic, NamedTuple, TypeVar

from host.client.watching import Watcher

Result = TypeVar("Result")


class Wait(NamedTuple):
    """A wait for the robot, as `Watcher.wait` takes it."""

    seconds: float
    until: Callable[[], bool] | None = None


Steps = Generator[Wait, bool, Result]


def play(robot: Watcher, steps: Steps[Result]) -> Result:
    """Do all steps, and return what comes of them. Raises what they and their waits raise."""
    try:
        wait = next(steps)
        while True:
            try:
                ended = robot.wait(*wait)
            except BaseException as error:  # noqa: BLE001 - the steps tidy up, and raise it
                wait = steps.throw(error)
            else:
                wait = steps.send(ended)
    except StopIteration as end:
        result: Result = end.value
        return result


class Slices(Generic[Result]):
    """Steps that go on while somebody else lets the robot's time pass.

    Args:
        robot: The robot, which sends its records.
        steps: What is to be done. Its result is not None.
    """

    def __init__(self, robot: Watcher, steps: Steps[Result]) -> None:
        self._robot = robot
        self._steps = steps
        self._wait: Wait | None = None
        self._since_s = 0.0

    def go_on(self, break_off: BaseException | None = None) -> Result | None:
        """Do what is due, and return.

        Args:
            break_off: Makes the steps tidy up, and raise this.

        Returns:
            What has come of the steps; None if they still wait.

        Raises:
            BaseException: What the steps raise.
        """
        try:
            if break_off is not None:
                self._wait_from_now(self._steps.throw(break_off))
            elif self._wait is None:
                self._wait_from_now(next(self._steps))
            while (ended := self._ended()) is not None:
                self._wait_from_now(self._steps.send(ended))
        except StopIteration as end:
            result: Result = end.value
            return result
        return None

    def _wait_from_now(self, wait: Wait) -> None:
        self._wait = wait
        self._since_s = self._now_s()

    def _now_s(self) -> float:
        """The robot's time, as its records count it (s)."""
        newest = self._robot.newest
        return 0.0 if newest is None else newest.t_s

    def _ended(self) -> bool | None:
        """Whether the condition has ended the present wait; None if the wait goes on."""
        assert self._wait is not None
        seconds, until = self._wait
        if until is not None and until():
            return True
        return False if self._now_s() - self._since_s >= seconds else None
