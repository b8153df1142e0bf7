"""kickctl help."""

from __future__ import annotations

import argparse
import re
import textwrap
from collections.abc import Iterator
from difflib import get_close_matches
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import host
import robot
from host.commands._help_notes import note_on
from host.commands._terminal import print_result, show
from host.errors import NotDone
from host.experiments.registry import TABLE as EXPERIMENTS
from host.runs.claim_sentences import SENTENCES
from host.runs.registry import Option
from host.theory.studies.registry import TABLE as STUDIES
from robot.params import TABLE as PARAMS
from robot.record import CHANNELS

HELP = (
    "explain a word, and find words among verbs and their options, experiments, studies of the"
    " model, the robot's parameters, the columns of logs, faults, and the paper's claims; without a"
    " word: list the verbs"
)
USES = ()
# The verbs whose parts are runs, and those.
RUNS = {"experiment": EXPERIMENTS, "theory": STUDIES}
# More places than these are named without what they are.
MOST = 12
_WIDTH = 100
_FAULT = re.compile(r"^\| (?!what you see)(.+?) \| (.+) \|$", re.MULTILINE)
_FAULTS = "## When it does not move"
_WORD = re.compile(r"^\| (.+?) \| (.+) \| `kickctl (.+)` \|$", re.MULTILINE)
_EXPLAINED = "word: "


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
        """Whether one of its words begins with this one, or is it, if this is a single letter."""
        return any(own == word or (len(word) > 1 and own.startswith(word)) for own in self.words())

    def is_called(self, words: list[str]) -> bool:
        """Whether these words are its name, which that of an option is not.

        What is explained is also called by the first words of its name, as Hopf.
        """
        if self.before == _EXPLAINED and len(words[0]) > 1:
            return any(_words(name)[: len(words)] == words for name in self.name.split(","))
        return self.name[0] != "-" and _words(self.name.partition("=")[0]) == words

    def __str__(self) -> str:
        """As it is printed."""
        return f"{self.before}{self.name}\n    {self.text}"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what to look for."""
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="a word or its beginning, such as chaos, tau or R5; all of several must be found",
    )


def run(options: argparse.Namespace) -> int:
    """Print each place in which all of the words are found, those with the word as name first.

    Without a word it prints what `kickctl --help` prints.

    Raises:
        NotDone: There is none.
    """
    parser: argparse.ArgumentParser = options.whole_parser()
    if not options.words:
        _print(options, {"text": parser.format_help()}, parser.format_help().rstrip())
        return 0
    wanted = [word for text in options.words for word in _words(text)]
    places = list(_places(parser))
    found = [place for place in places if all(place.has(word) for word in wanted)]
    if not found or not wanted:
        known = sorted({word for place in places for word in place.words()})
        close = [near for word in wanted for near in get_close_matches(word, known, 1)]
        guess = f"did you mean {' '.join(close)}? " if close not in ([], wanted) else ""
        raise NotDone(
            f"there is nothing about '{' '.join(options.words)}'",
            guess + "fewer words or a shorter beginning find more; kickctl --help lists all verbs",
        )
    found.sort(
        key=lambda place: (
            not place.is_called(wanted),
            not any(word in _words(place.name) for word in wanted),
        )
    )
    result = {
        "places": [{"name": place.before + place.name, "text": place.text} for place in found]
    }
    _print(options, result, "\n".join(_lines(found, wanted)))
    return 0


def _print(options: argparse.Namespace, result: dict[str, Any], text: str) -> None:
    """Answer. Who does not read all of it can ask again, so that nothing is said of it."""
    if options.json:
        show(result)
    else:
        print_result(text)


def _lines(found: list[Place], wanted: list[str]) -> Iterator[str]:
    """The first places with what they are, the names of the others."""
    named = sum(place.is_called(wanted) for place in found)
    full = len(found) if len(found) <= MOST else max(named, MOST // 2)
    yield from map(str, found[:full])
    if full == len(found):
        return
    yield f"\n{len(found) - full} more; one more word finds fewer:"
    rest = sorted(found[full:], key=_kind)
    for kind, places in groupby(rest, key=_kind):
        names = ", ".join((place.before + place.name)[len(kind) :].lstrip(": ") for place in places)
        yield textwrap.fill(
            f"{kind}: {names}", _WIDTH, subsequent_indent="    ", break_on_hyphens=False
        )


def _kind(place: Place) -> str:
    """What the line of a place in a list of names begins with."""
    before, colon, _ = place.before.partition(":")
    return before if colon else " ".join(before.split()[:2])


def _words(text: str) -> list[str]:
    return re.findall(r"[^\W_]+", text.lower())


def _places(parser: argparse.ArgumentParser) -> Iterator[Place]:
    glossary = Path(host.__file__).with_name("GLOSSARY.md").read_text(encoding="utf-8")
    for word, meaning, command in _WORD.findall(glossary):
        note = note_on(command)
        assert note is not None  # each command of the glossary has one
        text = meaning.replace("\\|", "|")
        yield Place(_EXPLAINED, word, f"{text}; see kickctl {command}, and {note.page}")
    yield from _of_options(parser, frozenset())
    common = frozenset(parser._option_string_actions)  # noqa: SLF001 - argparse lists them nowhere
    for verb, own in _inner(parser):
        yield Place("kickctl ", verb, str(own.description))
        yield from _of_options(own, common)
        if verb in RUNS:
            yield from _shared_options(verb, own, common)
            continue
        for part, inner in _inner(own):
            yield Place(f"kickctl {verb} ", part, str(inner.description))
            yield from _of_options(inner, common)
    for verb, entries in RUNS.items():
        for name, entry in entries.items():
            yield Place(f"kickctl {verb} ", name, entry.help)
            for option in entry.options:
                yield Place(f"kickctl {verb} {name} ", _flag(option), _of_option(option))
            for claim in entry.claims:
                text = f"{SENTENCES[claim]}; measured by kickctl {verb} {name}"
                yield Place("claim ", claim, text)
    for param in PARAMS.values():
        allowed = (
            " or ".join(str(choice) for choice in param.choices)
            if param.choices
            else f"{param.minimum:g} to {param.maximum:g} {param.unit.removeprefix('1')}".strip()
        )
        yield Place(
            "kickctl params set ", f"{param.name}=VALUE", f"{param.doc}; {allowed}; docs/model.md"
        )
    for channel in CHANNELS:
        unit = f", {channel.unit}" if channel.unit != "1" else ""
        yield Place("column of logs: ", channel.name, f"{channel.doc}{unit}")
    page = Path(robot.__file__).with_name("README.md").read_text(encoding="utf-8")
    for seen, remedy in _FAULT.findall(page.partition(_FAULTS)[2]):
        yield Place("what you see: ", seen, remedy)


def _inner(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """The verbs of a parser, or the parts of a verb, by name."""
    for action in parser._actions:  # noqa: SLF001 - argparse lists them nowhere
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            yield from action.choices.items()


def _of_options(parser: argparse.ArgumentParser, known: frozenset[str]) -> Iterator[Place]:
    """The options of a verb, without those that every verb has."""
    for action in parser._actions:  # noqa: SLF001 - argparse lists them nowhere
        if action.help not in (None, argparse.SUPPRESS) and not known & {*action.option_strings}:
            text = str(action.help) % {**vars(action), "prog": parser.prog}
            if action.choices and not isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
                text += f"; {', '.join(map(str, action.choices))}"
            for flag in action.option_strings[-1:]:
                yield Place(f"{parser.prog} ", flag, text)


def _shared_options(
    verb: str, parser: argparse.ArgumentParser, known: frozenset[str]
) -> Iterator[Place]:
    """The options that experiments, or studies, have beside their own, once each."""
    seen: set[str] = set()
    for name, run in _inner(parser):
        own = {_flag(option) for option in RUNS[verb][name].options}
        for place in _of_options(run, known | own):
            if place.name not in seen:
                seen.add(place.name)
                yield place._replace(before=f"kickctl {verb} NAME ")


def _flag(option: Option) -> str:
    return "--" + option.name.replace("_", "-")


def _of_option(option: Option) -> str:
    if option.choices:
        return f"{option.doc}; {' or '.join(option.choices)}"
    default = "" if option.default is None else f"; {option.default} if left out"
    return f"{option.doc}; {option.least:g} to {option.most:g}{default}"
