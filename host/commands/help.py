"""kickctl help."""

from __future__ import annotations

import argparse
import importlib
import re
from collections.abc import Iterator
from difflib import get_close_matches
from pkgutil import iter_modules
from typing import NamedTuple

import host.commands
from host.commands._terminal import answer
from host.errors import NotDone
from host.experiments.registry import TABLE as EXPERIMENTS
from host.runs.registry import Option
from host.theory.studies.registry import TABLE as STUDIES
from robot.params import TABLE as PARAMS
from robot.record import CHANNELS

HELP = (
    "find words among verbs, experiments, studies of the model, the robot's parameters, the columns"
    " of logs, and the paper's claims"
)
USES = ()


class Place(NamedTuple):
    """Where words are found.

    Attributes:
        before: What stands before the name: a command. It is not searched.
        name: The name of a verb, an option, a parameter, a column or a claim.
        text: What that is.
    """

    before: str
    name: str
    text: str

    def words(self) -> list[str]:
        """What is searched, in small letters."""
        return _words(f"{self.name} {self.text}")

    def has(self, word: str) -> bool:
        """Whether one of its words begins with this one."""
        return any(own.startswith(word) for own in self.words())

    def __str__(self) -> str:
        """As it is printed."""
        return f"{self.before}{self.name}\n    {self.text}"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what to look for."""
    parser.add_argument(
        "words",
        nargs="+",
        metavar="WORD",
        help="a word or its beginning, such as chaos, tau or R5; all of several must be found",
    )


def run(options: argparse.Namespace) -> int:
    """Print each place in which all of the words are found, those with the word as name first.

    Raises:
        NotDone: There is none.
    """
    wanted = [word for text in options.words for word in _words(text)]
    places = list(_places())
    found = [place for place in places if all(place.has(word) for word in wanted)]
    if not found or not wanted:
        known = sorted({word for place in places for word in place.words()})
        close = [near for word in wanted for near in get_close_matches(word, known, 1)]
        guess = f"did you mean {' '.join(close)}? " if close not in ([], wanted) else ""
        raise NotDone(
            f"there is nothing about '{' '.join(options.words)}'",
            guess + "fewer words or a shorter beginning find more; kickctl --help lists all verbs",
        )
    found.sort(key=lambda place: not any(word in _words(place.name) for word in wanted))
    result = {
        "places": [{"name": place.before + place.name, "text": place.text} for place in found]
    }
    answer(options, result, "\n".join(map(str, found)))
    return 0


def _words(text: str) -> list[str]:
    return re.findall(r"[^\W_]+", text.lower())


def _places() -> Iterator[Place]:
    for found in iter_modules(host.commands.__path__):
        if not found.name.startswith("_"):
            module = importlib.import_module(f"host.commands.{found.name}")
            yield Place("kickctl ", found.name, module.HELP)
    for verb, entries in (("experiment", EXPERIMENTS), ("theory", STUDIES)):
        for name, entry in entries.items():
            yield Place(f"kickctl {verb} ", name, entry.help)
            for option in entry.options:
                flag = "--" + option.name.replace("_", "-")
                yield Place(f"kickctl {verb} {name} ", flag, _of_option(option))
            for claim in entry.claims:
                yield Place("claim ", claim, f"measured by kickctl {verb} {name}")
    for param in PARAMS.values():
        allowed = (
            " or ".join(str(choice) for choice in param.choices)
            if param.choices
            else f"{param.minimum:g} to {param.maximum:g} {param.unit.removeprefix('1')}".strip()
        )
        yield Place("kickctl params set ", f"{param.name}=VALUE", f"{param.doc}; {allowed}")
    for channel in CHANNELS:
        unit = f", {channel.unit}" if channel.unit != "1" else ""
        yield Place("column of logs: ", channel.name, f"{channel.doc}{unit}")


def _of_option(option: Option) -> str:
    if option.choices:
        return f"{option.doc}; {' or '.join(option.choices)}"
    default = "" if option.default is None else f"; {option.default} if left out"
    return f"{option.doc}; {option.least:g} to {option.most:g}{default}"
