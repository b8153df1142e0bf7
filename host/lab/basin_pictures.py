"""The basins of a robot for its pages: coarse at once, then finer, of its present parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from host.errors import KickctlError, NotDone
from host.lab.basin_question import ENDS, Question
from host.lab.station import Station

if TYPE_CHECKING:
    from host.lab.worker import Answer

# How many starts there are along each axis, one picture after the other.
SIDES = (16, 32, 64)
# How many starts a question has at most, so that a change of parameters soon has its turn.
_STARTS = 512

Message = dict[str, Any]


class BasinPictures:
    """Follows the parameters of a robot for as long as `follow` is called on its events.

    All of it runs where the session lives. At most one question is with the worker: other robots
    have their turn, and after a change of parameters the next question is about the new ones.

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
        self._ends = ""

    def follow(self) -> None:
        """Have the next picture computed, if there is a better one and none is under way."""
        if self._asked is not None:
            return
        try:
            question = self._station.basin_question(SIDES[0])
            if self._station.basins is None:
                raise NotDone(
                    "this page does not compute basins", "`kickctl lab` on a computer does"
                )
        except NotDone as error:
            self._show({"why": error.message, "hint": error.hint})
            return
        if self._shown is not None and _same(self._shown, question):
            if self._shown.side == SIDES[-1]:
                return
            question = question._replace(side=SIDES[SIDES.index(self._shown.side) + 1])
        self._ends = ""
        self._ask(question, 0)

    def _ask(self, question: Question, row: int) -> None:
        """Ask for the rows from this one on, as many as a question may have."""
        worker, pages = self._station.basins, self._station.pages
        if worker is None or pages is None:  # the lab ends
            return
        rows = row, min(row + _STARTS // question.side, question.side)
        asked = self._asked = question._replace(rows=rows)
        worker.ask(_answer, asked, lambda found: pages.call(lambda: self._take(asked, found)))

    def _take(self, question: Question, found: Message | KickctlError) -> None:
        self._asked = None
        if isinstance(found, KickctlError):
            self._shown = None
            self._show({"why": found.message, "hint": found.hint})
            return
        try:
            present = self._station.basin_question(question.side)
        except NotDone:
            present = None
        if present is not None and _same(question, present):
            self._ends += found["ends"]
            if question.rows[1] < question.side:
                self._ask(question._replace(radius=found["radius"]), question.rows[1])
                return
            self._shown = question
            counts = {end: self._ends.count(end[0]) for end in ENDS}
            params, side = dict(question.params), question.side
            picture = {"params": params, "side": side, "ends": self._ends, "counts": counts}
            self._show(found | picture)
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
