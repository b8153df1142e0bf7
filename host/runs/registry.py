"""What can be run by a name, an experiment or a study of the model, and what each can be asked for. Light enough for `kickctl --help`."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any, NamedTuple

from host.errors import WrongUse


class Option(NamedTuple):
    """A number that a run can be asked for, from `least` to `most`; or a word, one of `choices`.

    default: its type is the number's; None, of a float that need not be given.
    """

    name: str
    default: float | str | None
    least: float
    most: float
    doc: str
    choices: tuple[str, ...] = ()


class Entry(NamedTuple):
    """What can be run, for people. claims.

    Ids of the paper's claims that are settled here (others may be touched).
    """

    help: str
    options: tuple[Option, ...]
    claims: tuple[str, ...] = ()


def entry_of(kind: str, table: Mapping[str, Entry], name: str) -> Entry:
    """The entry of a name. Raises WrongUse if there is none of this kind."""
    if name not in table:
        raise WrongUse(f"there is no {kind} '{name}'", "there are " + ", ".join(table))
    return table[name]


def checked(name: str, entry: Entry, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """All options of an entry, those that are not given at their defaults. Raises WrongUse."""
    options = {option.name: option for option in entry.options}
    for given in arguments:
        if given not in options:
            raise WrongUse(
                f"'{name}' has no option '{given}'", "it has " + (", ".join(options) or "none")
            )
    return {
        name: _value(option, arguments.get(name, option.default))
        for name, option in options.items()
    }


def _type(option: Option) -> type:
    return float if option.default is None else type(option.default)


def _value(option: Option, value: Any) -> Any:
    if value is None and option.default is None:
        return None
    if option.choices:
        if value not in option.choices:
            raise WrongUse(
                f"{option.name} cannot be {value!r}",
                f"give one of {', '.join(option.choices)}: {option.doc}",
            )
        return value
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, float))
        or not option.least <= value <= option.most
    ):
        raise WrongUse(
            f"{option.name} cannot be {value!r}",
            f"give a number from {option.least:g} to {option.most:g}: {option.doc}",
        )
    if isinstance(option.default, int) and value != int(value):
        raise WrongUse(f"{option.name} cannot be {value!r}", f"give a whole number: {option.doc}")
    return _type(option)(value)


def add_options(parser: argparse.ArgumentParser, entry: Entry) -> None:
    """A flag for each option, and those that all runs have."""
    for option in entry.options:
        own: dict[str, Any] = (
            {"choices": option.choices}
            if option.choices
            else {"type": _type(option), "metavar": "N"}
        )
        words = option.doc if option.default is None else f"{option.doc} (default %(default)s)"
        parser.add_argument(
            "--" + option.name.replace("_", "-"),
            dest=option.name,
            default=option.default,
            help=words,
            **own,
        )
    parser.add_argument(
        "--out",
        default="results",
        metavar="FOLDER",
        help=(
            "where results go; the same command goes on where it was cut short (default"
            " %(default)s)"
        ),
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="spread the computing over this Dask cluster, as tcp://host:8786",
    )


def options_given(options: argparse.Namespace, entry: Entry) -> dict[str, Any]:
    """The values of an entry's own options."""
    return {option.name: getattr(options, option.name) for option in entry.options}
