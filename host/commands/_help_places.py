"""All places in which help finds words: verbs, options, parameters, columns, faults, claims ..."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

from host.commands import _help_tables as tables
from host.commands._help_notes import note_on
from host.experiments.registry import TABLE as EXPERIMENTS
from host.link.sim_settings import settings
from host.runs.claim_sentences import SENTENCES
from host.runs.registry import Option
from host.theory.studies.registry import TABLE as STUDIES
from robot.params import TABLE as PARAMS
from robot.record import CHANNELS

# The verbs whose parts are runs, and those.
RUNS = {"experiment": EXPERIMENTS, "theory": STUDIES}
LETTER, WORD, PARAMETER, SETTING = "letter: ", "word: ", "kickctl params set ", "sim://?"
SEEN = "what you see: "
# What is shown first of places that fit equally well.
_RANKS = (LETTER, WORD, PARAMETER)


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
        found = split_words(f"{self.name} {self.text}")
        if self.before == LETTER:  # those without their index, x for x1
            found += [word[0] for word in found if re.fullmatch("[a-z][0-9]", word)]
        return found

    def has(self, word: str) -> bool:
        """Whether one of its words begins with this one, or is it, if this is a single letter."""
        return (f" {word}" if len(word) > 1 else f" {word} ") in _line_of(self)

    def is_called(self, words: list[str]) -> bool:
        """Whether these words are its name, which that of an option is not.

        What is explained is also called by the first words of its name, as Hopf.
        """
        if self.before == LETTER:
            return self.likeness(words) < 3 or self._begins_with(words)
        if self.before == WORD and len(words[0]) > 1:
            return self._begins_with(words)
        return self.name[0] != "-" and split_words(self.name.partition("=")[0]) == words

    def likeness(self, typed: list[str]) -> int:
        """How much a letter is like what was typed: 0 the same, up to 3; 3 for all other places.

        Capitals count: F is a force, and f is friction.
        """
        if self.before != LETTER or len(typed) != 1:
            return 3
        names = [name.strip() for name in self.name.split(",")]
        stems = [re.split("[0-9_]", name)[0] for name in names]
        small = [name.lower() for name in (*names, *stems)]
        tries = (typed[0] in names, typed[0] in stems, typed[0].lower() in small)
        return next((rank for rank, fits in enumerate(tries) if fits), 3)

    def rank(self) -> int:
        """Where it stands among places that fit equally well."""
        return _RANKS.index(self.before) if self.before in _RANKS else len(_RANKS)

    def _begins_with(self, words: list[str]) -> bool:
        return any(split_words(name)[: len(words)] == words for name in self.name.split(","))

    def __str__(self) -> str:
        """As it is printed."""
        return f"{self.before}{self.name}\n    {self.text}"


@cache
def _line_of(place: Place) -> str:
    """All that is searched in a place, each word between spaces."""
    return f" {' '.join(place.words())} "


def split_words(text: str) -> list[str]:
    """The words of a text, in small letters."""
    return re.findall(r"[^\W_]+", text.lower())


def places_of(parser: argparse.ArgumentParser) -> Iterator[Place]:
    """All places.

    Args:
        parser: That of the whole command line.
    """
    yield from _explained()
    yield from _of_verbs(parser)
    yield from _of_runs()
    yield from _of_robot()


def _explained() -> Iterator[Place]:
    for name, text in tables.letters():
        yield Place(LETTER, name, f"{text}; docs/model.md")
    for word, meaning, command in tables.words():
        note = note_on(command)
        assert note is not None  # each command of the glossary has one
        yield Place(WORD, word, f"{meaning}; see kickctl {command}, and {note.page}")


def _of_verbs(parser: argparse.ArgumentParser) -> Iterator[Place]:
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


def _of_runs() -> Iterator[Place]:
    for verb, entries in RUNS.items():
        for name, entry in entries.items():
            yield Place(f"kickctl {verb} ", name, entry.help)
            for option in entry.options:
                yield Place(f"kickctl {verb} {name} ", _flag(option), _of_option(option))
            for claim in entry.claims:
                text = f"{SENTENCES[claim]}; measured by kickctl {verb} {name}"
                yield Place("claim ", claim, text)


def _of_robot() -> Iterator[Place]:
    for param in PARAMS.values():
        allowed = (
            " or ".join(str(choice) for choice in param.choices)
            if param.choices
            else f"{param.minimum:g} to {param.maximum:g} {param.unit.removeprefix('1')}".strip()
        )
        yield Place(PARAMETER, f"{param.name}=VALUE", f"{param.doc}; {allowed}; docs/model.md")
    for setting in settings():
        span = f"{setting.span} {setting.unit}".strip()
        text = f"{setting.doc}; {span}; {setting.default} if left out; docs/simulated-robot.md"
        yield Place(SETTING, f"{setting.name}=VALUE", text)
    for channel in CHANNELS:
        unit = f", {channel.unit}" if channel.unit != "1" else ""
        yield Place("column of logs: ", channel.name, f"{channel.doc}{unit}")
    for seen, remedy in tables.faults():
        yield Place(SEEN, seen, remedy)


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
