"""The basins of a robot for its pages: coarse at once, then finer, of its present parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from host.errors import KickctlError, NotDone
from host.lab.basin_question import Question
from host.lab.station import Station
from host.lab.worker import Answer

# How many starts there are along each axis, one picture after the other.
SIDES = (16, 32, 64)

Message = dict[str, Any]


class BasinPictures:
    """Follows the parameters of a robot for as long as `follow` is called on its events.

    All of it runs where the session lives. At most one question is with the worker: other robots
    have their turn, and of questions that wait only the newest one counts.

    Args:
        station: The robot.
        tell: Gets `basins` messages for the pages that want them.

    Attributes:
        latest: The newest `basins` message; None before the first.
    """

    def __init__(self, station: Station, tell: Callable[[Message], None]) -> None:
        self.latest: Message | None = None
        self._station = station
        self._tell = tell
        self._shown: Question | None = None
        self._asked: Question | None = None

    def follow(self) -> None:
        """Have the next picture computed, if there is a better one and none is under way."""
        if self._asked is not None:
            return
        worker, pages = self._station.basins, self._station.pages
        try:
            question = self._station.basin_question(SIDES[0])
            if worker is None or pages is None:
                raise NotDone("this lab does not compute basins", "")
        except NotDone as error:
            self._show({"why": error.message, "hint": error.hint})
            return
        if self._shown is not None and _same(self._shown, question):
            if self._shown.side == SIDES[-1]:
                return
            question = question._replace(side=SIDES[SIDES.index(self._shown.side) + 1])
        self._asked = question
        worker.ask(_answer, question, lambda found: pages.call(lambda: self._take(question, found)))

    def _take(self, question: Question, found: Message | KickctlError) -> None:
        self._asked = self._shown = None
        if isinstance(found, KickctlError):
            self._show({"why": found.message, "hint": found.hint})
            return
        try:
            present = self._station.basin_question(question.side)
        except NotDone:
            present = None
        if present is not None and _same(question, present):
            self._shown = question
            self._show(found)
        self.follow()

    def _show(self, news: Message) -> None:
        message = {"type": "basins", "robot": self._station.name, **news}
        if message != self.latest:
            self.latest = message
            self._tell(message)


def _answer(question: Question) -> Answer:
    from host.lab.basins import compute  # which loads what only the worker's process needs

    return compute(question)


def _same(one: Question, other: Question) -> bool:
    """Whether two questions are about the same robot with the same parameters."""
    return (one.params, one.motor) == (other.params, other.motor)
