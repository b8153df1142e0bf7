"""The data dictionary: what each column of a run's tables means, and its unit.

It is read from where the code says it. The rows that an experiment's `report` takes are typed
dictionaries, whose docstrings explain their fields.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterable, Iterator
from typing import (
    Any,
    Literal,
    NamedTuple,
    NotRequired,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

from host.runs.contract import Experiment, Row

# The units in parentheses of docstrings; "1" is that of a number without one.
_UNITS = (
    *("1", "%", "SI", "s", "s^2", "1/s", "Hz", "rad", "rad/s", "rad^2/s^2", "rad per tick"),
    *("turns per second", "degrees", "m", "m/s", "N", "N/m", "N s/rad", "V", "in its unit"),
)
_UNIT = re.compile(rf" \(({'|'.join(map(re.escape, _UNITS))})(?:, ([^()]*))?\)")
_CONSTANT = re.compile(r"\b[A-Z][A-Z_]{2,}\b")
_NUMBER = "1"


class Column(NamedTuple):
    """A column of a table.

    Attributes:
        name: its name in the header.
        unit: of its numbers, "1" for numbers without one; empty for words and for whole numbers.
        meaning: what it says.
    """

    name: str
    unit: str
    meaning: str


class Kind(NamedTuple):
    """A kind of row, which has a table of its own.

    Attributes:
        name: its name in the table's file name.
        meaning: what a row is.
        columns: its columns, in their order.
        required: the names of the columns that no row lacks.
    """

    name: str
    meaning: str
    columns: tuple[Column, ...]
    required: frozenset[str]

    def has(self, row: Row) -> bool:
        """Whether a row is of this kind."""
        return self.required <= row.keys() <= {column.name for column in self.columns}


def kinds_of(experiment: Experiment) -> list[Kind]:
    """The kinds of rows of an experiment; none if its rows are not typed dictionaries."""
    hints = get_type_hints(experiment.report)
    return [_kind(row) for row in _typed_dictionaries(hints.get("rows"))]


def by_kind(rows: Iterable[Row], kinds: list[Kind]) -> dict[str, list[Row]]:
    """The rows of each kind, by its name; all rows under an empty name if there are no kinds.

    Raises:
        LookupError: A row is of none of the kinds.
    """
    found: dict[str, list[Row]] = {}
    names: dict[tuple[str, ...], str] = {}
    for row in rows:
        fields = tuple(row)
        if fields not in names:
            own = next((kind.name for kind in kinds if kind.has(row)), None if kinds else "")
            if own is None:
                raise LookupError(f"the data dictionary has no row of {', '.join(fields)}")
            names[fields] = own
        found.setdefault(names[fields], []).append(row)
    return found


def _typed_dictionaries(hint: Any) -> Iterator[type]:
    if is_typeddict(hint):
        yield hint
    for argument in get_args(hint):
        yield from _typed_dictionaries(argument)


def columns_of(row: type) -> list[Column]:
    """The columns of a typed dictionary, in their order."""
    explained = _explained(row)
    return [
        _column(name, hint, explained.get(name, "")) for name, hint in get_type_hints(row).items()
    ]


def _kind(row: type) -> Kind:
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", "-", row.__name__.removesuffix("Row")).lower()
    # A class without fields of its own joins a cell and what was measured in it.
    about = row if vars(row)["__annotations__"].keys() - _inherited(row) else _bases(row)[-1]
    meaning = (inspect.getdoc(about) or "").partition("\n")[0]
    hints = get_type_hints(row, include_extras=True).items()
    required = frozenset(field for field, hint in hints if get_origin(hint) is not NotRequired)
    return Kind(name, meaning, tuple(columns_of(row)), required)


def _inherited(row: type) -> set[str]:
    return {name for base in _bases(row) for name in get_type_hints(base)}


def _bases(row: type) -> list[type]:
    """The typed dictionaries that another one extends; Python itself forgets them."""
    names = vars(sys.modules[row.__module__])
    (definition,) = ast.parse(inspect.getsource(row)).body
    assert isinstance(definition, ast.ClassDef)
    found = [eval(ast.unparse(base), names) for base in definition.bases]  # noqa: S307 - our source
    return [base for base in found if is_typeddict(base)]


def _explained(row: type) -> dict[str, str]:
    """What docstrings say about the fields of a typed dictionary, by name."""
    names = vars(sys.modules[row.__module__])
    found: dict[str, str] = {}
    for base in _bases(row):
        found |= _explained(base)
    _, _, attributes = (inspect.getdoc(row) or "").partition("Attributes:\n")
    for entry in re.split(r"\n(?=    \w)", attributes.rstrip()):
        name, _, words = entry.strip().partition(": ")
        if name:
            spelled = _CONSTANT.sub(lambda match: _spelled(match[0], names), words)
            found[name] = " ".join(spelled.split()).removesuffix(".")
    return found


def _spelled(name: str, names: dict[str, Any]) -> str:
    """The value or the words of a module's constant; the name itself of anything else."""
    value = names.get(name, name)
    if isinstance(value, float | int):
        return f"{value:g}"
    return value if isinstance(value, str) else ", ".join(map(str, value))


def _column(name: str, hint: Any, words: str) -> Column:
    """The column of a field, from its type and what its docstring says."""
    choices = [str(word) for word in _choices(hint)]
    if any(choice not in words.lower() for choice in choices):
        words = "; ".join(filter(None, [words, " or ".join(choices)]))
    unit = _UNIT.search(words)
    if unit is None:
        return Column(name, _NUMBER if "float" in str(hint) else "", words)
    rest = f", {unit[2]}" if unit[2] else ""
    return Column(name, unit[1], words.replace(unit[0], rest, 1))


def _choices(hint: Any) -> Iterator[Any]:
    """The words of literal types."""
    if get_origin(hint) is Literal:
        yield from get_args(hint)
    else:
        for argument in get_args(hint):
            yield from _choices(argument)
