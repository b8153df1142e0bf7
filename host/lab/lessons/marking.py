"""Checks guided exercises for pages, and runs their model wheel, in a process of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

from host.errors import KickctlError, NotDone, WrongUse, quotable
from host.lab.lessons.texts import lessons
from host.lab.page_end import Page
from host.lab.recording import find_log
from host.lab.requests import RELOAD, text_of
from host.lab.station import Station

if TYPE_CHECKING:
    from host.lab.worker import Answer, Worker

# A pupil who checks, or lets the model go, more often than this has to begin again.
_MOST = 50
_AGAIN = "begin the exercise again"
# How many numbers a page shows of a run.
_MOST_SEEN = 2


class _Logs(NamedTuple):
    lesson: str
    paths: tuple[str, ...]


class _Choice(NamedTuple):
    lesson: str
    value: float


class _Runs(NamedTuple):
    lesson: str
    runs: tuple[tuple[float, list[float | None]], ...]
    own: float | None


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
        self._waiting: set[Page] = set()

    def take(self, page: Page, message: dict[str, Any], request: int | None) -> None:
        """Do what a page asks for with a `check` or a `model` message, and answer it later.

        Raises:
            WrongUse: There is no exercise or log of this name, or a number is wrong.
            NotDone: This lab checks nothing, or the page waits for an answer already.
        """
        name = text_of(message, "lesson")
        model = _model_of(name)
        if message["type"] == "model":
            if model is None:
                raise WrongUse(f"the exercise '{name}' has no model wheel", RELOAD)
            self._ask(_run, _Choice(name, _value(message.get("value"), model)), page, request)
        elif model is None:
            self._ask(_mark, _Logs(name, self._paths(message.get("logs"))), page, request)
        else:
            runs, own = _runs(message.get("runs"), model), message.get("own")
            if own is not None:
                own = _number(own)
            self._ask(_mark_model, _Runs(name, runs, own), page, request)

    def _paths(self, names: object) -> tuple[str, ...]:
        if not isinstance(names, list) or not 0 < len(names) <= _MOST:
            raise WrongUse(f"a check needs 1 to {_MOST} logs", _AGAIN)
        stations = self._stations.values()
        paths = [find_log(stations, one) if isinstance(one, str) else None for one in names]
        found = tuple(str(path) for path in paths if path is not None)
        if len(found) < len(names):
            raise WrongUse("this lab has recorded no log of this name", _AGAIN)
        return found

    def _ask(
        self, work: Callable[[Any], Answer], question: object, page: Page, request: int | None
    ) -> None:
        pages = next(iter(self._stations.values())).pages
        if self.worker is None or pages is None:
            raise NotDone("this lab checks no exercises", "look at the robot yourself")
        if page in self._waiting:
            raise NotDone("this page waits for an answer already", "wait a moment")
        self._waiting.add(page)

        def told(result: Answer) -> None:
            self._waiting.discard(page)
            page.answer(request, result)

        self.worker.ask(work, question, lambda result: pages.call(lambda: told(result)))


def _model_of(name: str) -> dict[str, Any] | None:
    """The model wheel of an exercise, as lessons.toml has it. Raises WrongUse."""
    for lesson in lessons():
        if lesson["name"] == name:
            model: dict[str, Any] | None = lesson.get("model")
            return model
    raise WrongUse(f"there is no exercise '{quotable(name)}'", RELOAD)


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise WrongUse("this is no number", "type one with a point, as in 1.5")
    return float(value)


def _value(value: object, model: Mapping[str, Any]) -> float:
    least, most = model["least"], model["most"]
    number = _number(value)
    if not least <= number <= most:
        raise WrongUse(f"{number:g} is not possible here", f"choose from {least:g} to {most:g}")
    return number


def _runs(runs: object, model: Mapping[str, Any]) -> tuple[tuple[float, list[float | None]], ...]:
    if not isinstance(runs, list) or len(runs) > _MOST:
        raise WrongUse(f"a check takes up to {_MOST} runs", _AGAIN)
    found = []
    for run in runs:
        seen = run.get("seen") if isinstance(run, dict) else None
        if not isinstance(seen, list) or len(seen) != _MOST_SEEN:
            raise WrongUse("a run is not as the model gave it", _AGAIN)
        numbers = [None if one is None else _number(one) for one in seen]
        found.append((_value(run.get("value"), model), numbers))
    return tuple(found)


# What follows happens in the worker's process, which alone needs the imports.


def _mark(question: _Logs) -> Answer:
    from host.lab.lessons.checks import check
    from host.logs.log import Log

    try:
        logs = [Log.load(path) for path in question.paths]
    except KickctlError as error:
        return NotDone(error.message, error.hint)
    whole = Log(logs[0].info)
    for log in logs:
        log.play(whole)
    return _judged(check(question.lesson, whole))


def _mark_model(question: _Runs) -> Answer:
    from host.lab.lessons.model_checks import Shown, check

    runs = [Shown(*run) for run in question.runs]
    return _judged(check(question.lesson, runs, question.own))


def _judged(findings: list[Any]) -> Answer:
    done = all(finding.ok for finding in findings)
    return {"done": done, "findings": [finding._asdict() for finding in findings]}


def _run(question: _Choice) -> Answer:
    from host.lab.lessons.model import RUNS

    return RUNS[question.lesson](question.value)._asdict()
