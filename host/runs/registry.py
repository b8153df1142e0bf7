"""Experiments and studies of the model by name, and the options of each.

This imports little, so that `kickctl --help` answers at once.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Mapping
from numbers import Real
from typing import Any, NamedTuple

from host.errors import WrongUse
from host.util.arguments import shown
from host.util.numbers import Values
from host.util.paths import path_argument

# Options of some runs that people look for in others, and what to tell them there.
ELSEWHERE = {
    "noise": "for white noise of the torque there is: kickctl theory escape --noise 0.1",
    "angle_noise": "for white noise of the angle there is: kickctl theory escape --angle-noise 0.1",
    "rods": "one rod is for wheels of the model, such as in: kickctl theory hopf --rods 1",
    "k": "k is not free here: the run finds it, varies it, or has its own",
    "point": "leave it out: kickctl theory lyapunov --k 15 --tau 1 answers at a point",
    "bounded": (
        "another bound of the torque than the robot's is for wheels of the model, such as in:"
        " kickctl theory portrait --bounded 1"
    ),
}
# The units in help texts: ", s" at the end, or before brackets or another part of the sentence.
_UNIT = re.compile(r", (rad/s|rad|s\^2|s|minutes)(?=$|[ ;,])")


class Option(NamedTuple):
    """An option of a run: a number from `least` to `most`, or a word, one of `choices`.

    The default has the number's type. None is the default of a float that may be left out.
    A list of numbers stands for a sweep: the run is done at each of them.
    """

    name: str
    default: float | str | None
    least: float
    most: float
    doc: str
    choices: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """The unit of a number, as its help text says it; empty for one without."""
        found = _UNIT.search(self.doc)
        return found[1] if found else ""


class Entry(NamedTuple):
    """An experiment or study: its help text, its options, and the ids of the claims it decides."""

    help: str
    options: tuple[Option, ...]
    claims: tuple[str, ...] = ()


def entry_of(kind: str, table: Mapping[str, Entry], name: str) -> Entry:
    """The entry of a name. Raises WrongUse if there is none of this kind."""
    if name not in table:
        raise WrongUse(f"there is no {kind} '{name}'", "there are " + ", ".join(table))
    return table[name]


def complete_options(name: str, entry: Entry, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """All options of an entry, by name; those that are not given have their defaults.

    Raises WrongUse.
    """
    options = {option.name: option for option in entry.options}
    for given in arguments:
        if given not in options:
            they_are = "it has " + (", ".join(options) or "none")
            raise WrongUse(f"'{name}' has no option '{given}'", ELSEWHERE.get(given, they_are))
    return {
        name: _value(option, arguments.get(name, option.default))
        for name, option in options.items()
    }


def _type(option: Option) -> type:
    return float if option.default is None else type(option.default)


def _values(option: Option) -> Values:
    return Values("", option.least, option.most, whole=isinstance(option.default, int))


def _value(option: Option, value: Any) -> Any:
    several = isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
    if several and not option.choices:
        values = [_single(option, one) for one in value]
        if not values or len(set(values)) < len(values):
            raise WrongUse(
                f"{option.name} cannot be {shown(value)}",
                "a sweep takes one value or more, and each of them once",
            )
        return values
    return _single(option, value)


def _single(option: Option, value: Any) -> Any:
    if value is None and option.default is None:
        return None
    if option.choices:
        if value not in option.choices:
            raise WrongUse(
                f"{option.name} cannot be {shown(value)}",
                f"give one of {', '.join(option.choices)}: {option.doc}",
            )
        return value
    a_number = isinstance(value, Real) and not isinstance(value, bool)  # numpy's are numbers, too
    if not a_number or not option.least <= value <= option.most:
        raise WrongUse(
            f"{option.name} cannot be {shown(value)}",
            f"give a number from {option.least:g} to {option.most:g}: {option.doc}",
        )
    if isinstance(option.default, int) and value != int(value):
        raise WrongUse(
            f"{option.name} cannot be {shown(value)}", f"give a whole number: {option.doc}"
        )
    return _type(option)(value)


def _sweeps(options: Iterable[Option]) -> str:
    """What people read about sweeps below the options; empty if no option can be swept."""
    numbers = [option for option in options if not option.choices]
    if not numbers:
        return ""
    takes_k = any(option.name == "k" and option.least <= 0.5 for option in numbers)
    flag, values, span = ("--k", "1,2,4", "0.5:5:10") if takes_k else _sweep_of(numbers)
    return (
        "Several values of one number or of two make a sweep, with one table and one figure for"
        f" all: {flag} {values} or {flag} {span} (start:stop:count, with both ends)."
    )


def _sweep_of(numbers: Iterable[Option]) -> tuple[str, str, str]:
    """The flag of the first option with a default, two values, and evenly spaced ones."""
    option = next(option for option in numbers if option.default is not None)
    most = int(option.default or 0)
    least = max(int(option.least), most // 2)
    steps = next(count for count in (5, 4, 3, 2, 1) if (most - least) % count == 0)
    flag = "--" + option.name.replace("_", "-")
    return flag, f"{least},{most}", f"{least}:{most}:{steps + 1}"


def add_options(parser: argparse.ArgumentParser, entry: Entry) -> None:
    """Add a flag for each option of an entry, and the flags that all runs have."""
    parser.epilog = _sweeps(entry.options) or None
    for option in entry.options:
        own: dict[str, Any] = (
            {"choices": option.choices}
            if option.choices
            else {"type": _values(option), "metavar": "N"}
        )
        words = option.doc + ("" if option.default is None else f" (default {option.default})")
        parser.add_argument(
            "--" + option.name.replace("_", "-"),
            dest=option.name,
            help=words,
            **own,
        )
    for name in ELSEWHERE:
        if all(option.name != name for option in entry.options):
            flag = "--" + name.replace("_", "-")
            parser.add_argument(flag, dest=name, nargs="?", const=True, help=argparse.SUPPRESS)
    parser.add_argument(
        "--out",
        type=path_argument,
        default="results",
        metavar="FOLDER",
        help=(
            "folder for the results; the same command resumes an interrupted run (default"
            " %(default)s)"
        ),
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="compute on the Dask cluster of this scheduler, such as tcp://host:8786",
    )


def options_given(options: argparse.Namespace, entry: Entry) -> dict[str, Any]:
    """The values that were given for options; those left out are missing.

    Those that are not the entry's own `complete_options` refuses.
    """
    names = [*(option.name for option in entry.options), *ELSEWHERE]
    given = {name: getattr(options, name) for name in names}
    return {name: value for name, value in given.items() if value is not None}
