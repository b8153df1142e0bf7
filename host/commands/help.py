"""kickctl help."""

from __future__ import annotations

import argparse
import re
import textwrap
from collections.abc import Iterator
from difflib import get_close_matches
from itertools import groupby
from math import log
from typing import Any

from host.commands import _help_tables as tables
from host.commands._help_places import Place, places_of, split_words
from host.commands._terminal import print_result, say, show
from host.errors import NotDone

HELP = (
    "explain a word, and find words among verbs and their options, experiments, studies of the"
    " model, the robot's parameters, the settings of sim://, the columns of logs, what the robot"
    " says in a fault, and the paper's claims; without a word: list the verbs"
)
USES = ()
# More places than these are named without what they are.
MOST = 12
_WIDTH = 100
# What a robot's message has beside its words: brackets, numbers with units, and ports.
_DETAILS = re.compile(r"\([^)]*\)|\bout[A-D]\b|\b[0-9][0-9.]*(?: ?(?:V|s|ms|min|%))?(?!\w)")
# A message of at least as many words is also found by most of them.
_MESSAGE = 3
# A word is guessed only if it is as like as this to what was typed, from 0 to 1.
_CLOSE = 0.75


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what to look for."""
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help=(
            "a word or its beginning, such as chaos, tau or R5; all of several must be found, but"
            " of a robot's message most words do"
        ),
    )


def run(options: argparse.Namespace) -> int:
    """Print each place in which all of the words are found, those with the word as name first.

    Of a message without numbers, brackets and ports, and then of most of its words, it prints the
    best place; else the pages of the docs that are about the words. Without a word it prints what
    `kickctl --help` prints.

    Raises:
        NotDone: There is none.
    """
    parser: argparse.ArgumentParser = options.whole_parser()
    if not options.words:
        _print(options, {"text": parser.format_help()}, parser.format_help().rstrip())
        return 0
    text = " ".join(options.words)
    wanted, bare = split_words(text), split_words(_DETAILS.sub(" ", text))
    places = list(places_of(parser))
    found = _with_all(places, wanted) or _with_all(places, bare) or _pages_about(bare or wanted)
    if not found:
        found = _with_most(places, bare)
        if found:
            say("nothing has all of these words; most of them are here:")
    if not found:
        raise _nothing(options.words, wanted, places)
    found.sort(
        key=lambda place: (
            not place.is_called(wanted),
            place.likeness(options.words),
            not any(word in split_words(place.name) for word in wanted),
            place.rank(),
        )
    )
    result = {
        "places": [{"name": place.before + place.name, "text": place.text} for place in found]
    }
    _print(options, result, "\n".join(_lines(found, wanted)))
    return 0


def _with_all(places: list[Place], wanted: list[str]) -> list[Place]:
    """The places that have all words; none without a word."""
    return [place for place in places if wanted and all(place.has(word) for word in wanted)]


def _with_most(places: list[Place], wanted: list[str]) -> list[Place]:
    """The places that have most of a message. Words that are in few places count more.

    A single letter, as in 'how do I', means nothing in a message.
    """
    wanted = [word for word in wanted if len(word) > 1]
    if len(wanted) < _MESSAGE:
        return []
    known = {word: [place for place in places if place.has(word)] for word in wanted}
    weights = {word: log((1 + len(places)) / (1 + len(known[word]))) for word in known}
    scores = {
        place: sum(weights[word] for word in known if place in known[word])
        for place in {place for those in known.values() for place in those}
    }
    best = max(scores.values(), default=0.0)
    if best < sum(weights.values()) / 2:
        return []
    return [place for place in places if scores.get(place) == best]


def _pages_about(wanted: list[str]) -> list[Place]:
    """The pages of the docs with all words in their titles or among those they are sought by."""
    return [
        Place("page: ", page.path, page.text)
        for page in tables.pages()
        if wanted and all(Place("", page.text, page.sought).has(word) for word in wanted)
    ]


def _nothing(typed: list[str], wanted: list[str], places: list[Place]) -> NotDone:
    """That nothing is found, with a guess if a known word is close."""
    pages = list(tables.pages())
    known = {word for place in places for word in place.words()}
    known |= {word for page in pages for word in split_words(f"{page.text} {page.sought}")}
    close = [near for word in wanted for near in get_close_matches(word, sorted(known), 1, _CLOSE)]
    complete = len(close) == len(wanted) and close != wanted
    guess = f"did you mean {' '.join(close)}? " if complete else ""
    docs = "" if pages else "; the search of the docs may know more"
    return NotDone(
        f"there is nothing about '{' '.join(typed)}'",
        f"{guess}fewer words or a shorter beginning find more; kickctl --help lists all verbs"
        f"{docs}",
    )


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
        names = "; ".join(sorted((_name(place, kind) for place in places), key=_in_order))
        yield textwrap.fill(
            f"{kind}: {names}", _WIDTH, subsequent_indent="    ", break_on_hyphens=False
        )


def _kind(place: Place) -> str:
    """What the line of a place in a list of names begins with."""
    before, colon, _ = place.before.partition(": ")
    return before if colon else " ".join(before.split()[:2])


def _name(place: Place, kind: str) -> str:
    """A place's name in the line of its kind."""
    return (place.before + place.name)[len(kind) :].lstrip(": ")


def _in_order(name: str) -> list[tuple[str, int]]:
    """Sorts R2 before R10."""
    return [(text, int(number or 0)) for text, number in re.findall(r"([^0-9]*)([0-9]*)", name)]
