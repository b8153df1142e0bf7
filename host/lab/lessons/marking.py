"""Checks guided exercises for pages, in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from host.errors import KickctlError, NotDone, WrongUse, quotable
from host.lab.lessons.texts import lessons
from host.lab.page_end import Page
from host.lab.recording import find_log
from host.lab.requests import RELOAD, text_of
from host.lab.station import Station

if TYPE_CHECKING:
    from host.lab.worker import Answer, Worker

# A pupil who checks more often than this has to begin again.
_MOST_LOGS = 50


class _Question(NamedTuple):
    lesson: str
    paths: tuple[str, ...]


class Marking:
    """Has a worker check exercises.

    Args:
        stations: The robots, by name.

    Attributes:
        worker: Where that happens; None if nowhere.
    """

    def __init__(self, stations: Mapping[str, Station]) -> None:
        self._stations = stations
        self.worker: Worker | None = None

    def take(self, page: Page, message: dict[str, Any], request: int | None) -> None:
        """Check what a page asks for with a `check` message, and answer it later.

        Raises:
            WrongUse: There is no exercise or log of this name.
            NotDone: This lab checks nothing.
        """
        name, names = text_of(message, "lesson"), message.get("logs")
        if name not in [lesson["name"] for lesson in lessons()]:
            raise WrongUse(f"there is no exercise '{quotable(name)}'", RELOAD)
        if not isinstance(names, list) or not 0 < len(names) <= _MOST_LOGS:
            raise WrongUse(f"a check needs 1 to {_MOST_LOGS} logs", "begin the exercise again")
        stations = self._stations.values()
        paths = [find_log(stations, one) if isinstance(one, str) else None for one in names]
        found = tuple(str(path) for path in paths if path is not None)
        if len(found) < len(names):
            raise WrongUse("this lab has recorded no log of this name", "begin the exercise again")
        pages = next(iter(stations)).pages
        if self.worker is None or pages is None:
            raise NotDone("this lab checks no exercises", "look at the robot yourself")

        def answered(result: Answer) -> None:
            pages.call(lambda: page.answer(request, result))

        self.worker.ask(_mark, _Question(name, found), answered)


def _mark(question: _Question) -> Answer:
    # Imported where it is used: only the worker's process needs it.
    from host.lab.lessons.checks import check
    from host.logs.log import Log

    try:
        logs = [Log.load(path) for path in question.paths]
    except KickctlError as error:
        return NotDone(error.message, error.hint)
    whole = Log(logs[0].info)
    for log in logs:
        log.play(whole)
    findings = check(question.lesson, whole)
    done = all(finding.ok for finding in findings)
    return {"done": done, "findings": [finding._asdict() for finding in findings]}
