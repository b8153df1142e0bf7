"""The main results of a run, as a small table for people and as plain data."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import floor, log10
from typing import Any, NamedTuple

from host.util.intervals import standard_error, wilson

# Numbers are shown with this number of digits at most.
MOST_DIGITS = 9


class Answer(NamedTuple):
    """One result.

    Attributes:
        name: what it is.
        value: a number or a word; None if there is none.
        error: the standard error of a number; None if it is exact, or not known.
        unit: of value and error; empty without one.
    """

    name: str
    value: float | str | None
    error: float | None = None
    unit: str = ""

    def in_words(self) -> str:
        """The value with its error and unit."""
        if self.value is None:
            return "none"
        if isinstance(self.value, str):
            return self.value
        unit = f" {self.unit}" if self.unit else ""
        if not self.error:
            return f"{self.value:.{MOST_DIGITS}g}{unit}"
        digits = max(0, 1 - floor(log10(self.error)))
        if digits > MOST_DIGITS:
            return f"{self.value:.{MOST_DIGITS}g} ± {self.error:.1g}{unit}"
        rounded = round(self.value, digits)
        value = f"{rounded:.{digits}f}" if rounded else "0"
        return f"{value} ± {self.error:.{digits}f}{unit}"


def share(name: str, done: int, tried: int) -> Answer:
    """The share of tries that did something, %; none without tries."""
    if not tried:
        return Answer(name, None)
    low, high = wilson(done, tried)
    return Answer(name, 100 * done / tried, 100 * standard_error((low, high)), "%")


def as_data(answers: Iterable[Answer]) -> list[dict[str, Any]]:
    """The answers as plain data."""
    return [answer._asdict() for answer in answers]


def lines(answers: list[dict[str, Any]]) -> Iterator[str]:
    """The table, line by line, of answers as plain data."""
    own = [Answer(**answer) for answer in answers]
    width = max((len(answer.name) for answer in own), default=0)
    for answer in own:
        yield f"  {answer.name:<{width}}  {answer.in_words()}"
