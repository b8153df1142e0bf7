"""What a run returns: its summary, and its tables as arrays."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.runs.answers import lines
from host.runs.columns import Kind, by_kind
from host.runs.contract import Row

Table = dict[str, NDArray[Any]]


class Results(dict[str, Any]):
    """The summary of a run, as in summary.json, and its tables.

    Args:
        rows: All rows of the run.
        kinds: The kinds of rows, with the meaning and unit of each column.
        summary: The summary.
    """

    def __init__(self, rows: list[Row], kinds: list[Kind], summary: dict[str, Any]) -> None:
        super().__init__(summary)
        self.kinds = kinds
        self._rows = rows

    @cached_property
    def tables(self) -> dict[str, Table]:
        """The tables by the kind of row, as in the files' names; each has arrays by column.

        A number that is not known is nan. A run with rows of one kind has one table; its name is
        empty.
        """
        found = by_kind(self._rows, self.kinds)
        return {kind: _table(rows) for kind, rows in found.items()}

    def __repr__(self) -> str:
        tables = (
            f"  table {kind or self['experiment']}: {len(next(iter(table.values())))} rows"
            for kind, table in self.tables.items()
        )
        return "\n".join(
            [f"{self['experiment']}, in {self['folder']}", *lines(self["answers"]), *tables]
        )


def _table(rows: list[Row]) -> Table:
    columns = dict.fromkeys(column for row in rows for column in row)
    return {column: _array([row.get(column) for row in rows]) for column in columns}


def _array(values: list[Any]) -> NDArray[Any]:
    """The values as numbers if they are numbers or unknown, as words if they are words."""
    if all(value is None or isinstance(value, int | float) for value in values):
        unknown = any(value is None for value in values)
        return np.array(values, dtype=np.float64) if unknown else np.array(values)
    if all(isinstance(value, str) for value in values):
        return np.array(values)
    found = np.empty(len(values), dtype=object)
    found[:] = values
    return found
