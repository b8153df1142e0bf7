"""Sweeps: one run at each of several values of an option, or of two, and the table of them all."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import prod
from typing import Any, TypedDict

from host.errors import WrongUse
from host.runs.answers import Answer
from host.runs.contract import Findings, Options
from host.runs.registry import Entry

# A figure has two directions.
MOST_SWEPT = 2
# More points are a mistake: a table of them is too long to use.
MOST_POINTS = 100_000
# More values than these are not listed in words.
MOST_SHOWN = 8

Point = dict[str, float]


class Quantity(TypedDict):
    """What a row of the table says beside its point.

    Attributes:
        quantity: What it is; None in the row of a point that failed.
        value: Its value; None if it is a word, or does not exist.
        error: The standard error of the value; None if it is exact, or not known.
        unit: Of value and error; empty without one.
        word: The value, if it is a word.
        failed: Why the point has no quantities; None if it has.
    """

    quantity: str | None
    value: float | None
    error: float | None
    unit: str
    word: str | None
    failed: str | None


class Axis(TypedDict):
    """A swept option: its name, its unit (empty without one), and its values."""

    name: str
    unit: str
    values: list[float]


class Numbers(TypedDict):
    """The numbers of a sweep: whose it is, over what, all other options, and its table."""

    of: str
    swept: list[Axis]
    constants: Options
    rows: list[dict[str, Any]]


def axes(entry: Entry, options: Options) -> list[Axis]:
    """The swept options, in the order of the entry. Raises WrongUse if there are too many."""
    found: list[Axis] = [
        {"name": option.name, "unit": option.unit, "values": options[option.name]}
        for option in entry.options
        if isinstance(options[option.name], list)
    ]
    if len(found) > MOST_SWEPT:
        raise WrongUse(
            f"{', '.join(axis['name'] for axis in found)} have several values each, and a sweep"
            f" goes over {MOST_SWEPT} options at most",
            "give one value to the others",
        )
    if (count := prod(len(axis["values"]) for axis in found)) > MOST_POINTS:
        raise WrongUse(
            f"a sweep over {in_all(found)} has {count} points",
            f"choose fewer values: at most {MOST_POINTS} points",
        )
    return found


def points(swept: list[Axis]) -> list[Point]:
    """The points of a sweep; the last option changes first."""
    names = [axis["name"] for axis in swept]
    return [
        dict(zip(names, values, strict=True))
        for values in product(*(axis["values"] for axis in swept))
    ]


def in_all(swept: list[Axis]) -> str:
    """The values of a sweep, in words."""
    return "; ".join(
        f"{axis['name']} = {', '.join(_few(axis['values']))} {axis['unit']}".strip()
        for axis in swept
    )


def _few(values: list[float]) -> list[str]:
    """The values, or the first and the last ones of many."""
    words = [f"{value:g}" for value in values]
    return words if len(words) <= MOST_SHOWN else [*words[:3], "...", words[-1]]


def quantities(findings: Findings, point: Point) -> list[Quantity]:
    """What a run has found: its answers, or else its claims and single numbers."""
    answers = list(_named(findings.answers, point)) or [
        *(Answer(claim.id, claim.measured, None, claim.unit) for claim in findings.claims),
        *_single(findings.numbers),
    ]
    return [
        {
            "quantity": answer.name,
            "value": None if isinstance(answer.value, str) else answer.value,
            "error": answer.error,
            "unit": "" if answer.unit == "1" else answer.unit,
            "word": answer.value if isinstance(answer.value, str) else None,
            "failed": None,
        }
        for answer in answers
    ]


def failure(reason: str) -> Quantity:
    """The row of a point that failed."""
    return {
        "quantity": None,
        "value": None,
        "error": None,
        "unit": "",
        "word": None,
        "failed": reason,
    }


def _named(answers: list[Answer], point: Point) -> Iterator[Answer]:
    """The answers with names that are the same at all points, and different within one.

    An answer that is indented belongs to the one above it.
    """
    above = ""
    counts: dict[str, int] = {}
    for answer in answers:
        name = answer.name.strip()
        for option, value in point.items():
            name = name.removesuffix(f" at {option} = {value:g}")
        if answer.name.startswith(" "):
            name = f"{above}: {name}"
        else:
            above = name
        counts[name] = number = counts.get(name, 0) + 1
        yield answer._replace(name=name if number == 1 else f"{name} ({number})")


def _single(numbers: Any, name: str = "") -> Iterator[Answer]:
    """The numbers and words in dictionaries, with the keys that lead to them."""
    if isinstance(numbers, dict):
        for key, value in numbers.items():
            if key in ("in_words", "as_table"):
                continue  # sentences for people, of the same numbers
            yield from _single(value, f"{name}: {key}" if name else str(key))
    elif isinstance(numbers, int | float | str):
        yield Answer(name, numbers)


def extremes(rows: list[dict[str, Any]], swept: list[Axis]) -> list[Answer]:
    """Where each quantity is least and greatest, or which words it takes, for people."""
    names = list(dict.fromkeys(row["quantity"] for row in rows if row["quantity"]))
    found = []
    for name in names:
        own = [row for row in rows if row["quantity"] == name]
        known = [row for row in own if row["value"] is not None]
        words = [row["word"] for row in own if row["word"]]
        if known:
            ends = [choose(known, key=lambda row: row["value"]) for choose in (min, max)]
            least, most = (f"{row['value']:.6g} {row['unit']}".strip() for row in ends)
            if least != most:
                least += f" at {place(ends[0], swept)}, to {most} at {place(ends[1], swept)}"
            found.append(Answer(name, least))
        elif words:
            counts = {word: words.count(word) for word in dict.fromkeys(words)}
            common = sorted(counts.items(), key=lambda entry: -entry[1])[:MOST_SHOWN]
            found.append(Answer(name, ", ".join(f"{word} ({n})" for word, n in common)))
    return found


def place(row: dict[str, Any], swept: list[Axis]) -> str:
    """The point of a row, in words."""
    return ", ".join(
        f"{axis['name']} = {row[axis['name']]:g} {axis['unit']}".strip() for axis in swept
    )
