"""The data dictionary: every column is explained, and every row is of a kind that it has."""

from typing import Literal, NotRequired, TypedDict

import pytest

from host.perform.catalogue import KINDS, find
from host.runs.columns import Column, by_kind, kinds_of

NAMES = [name for table, _, _ in KINDS.values() for name in table]
LEAST = 3


class Cell(TypedDict):
    """A cell.

    Attributes:
        tau: time constant (s), at least LEAST.
    """

    tau: float


class Turn(TypedDict):
    """How one wheel turned.

    Attributes:
        way: the direction.
        omega: mean speed (rad/s, forward positive); None
            at rest.
    """

    way: Literal["up", "down"]
    omega: float | None


class SlowTurnRow(Cell, Turn):
    """A row."""


class OtherRow(Cell):
    """Another row.

    Attributes:
        ratio: a number.
        count: a whole number.
    """

    ratio: float
    count: NotRequired[int]


class Toy:
    @staticmethod
    def report(rows: list[SlowTurnRow | OtherRow], setting):
        pass


def test_kinds_are_read_from_the_rows_types_and_their_docstrings():
    slow, other = kinds_of(Toy)
    tau = Column("tau", "s", "time constant, at least 3")
    assert (slow.name, slow.meaning) == ("slow-turn", "How one wheel turned.")
    assert slow.columns == (
        tau,
        Column("way", "", "the direction; up or down"),
        Column("omega", "rad/s", "mean speed, forward positive; None at rest"),
    )
    assert (other.name, other.meaning) == ("other", "Another row.")
    assert other.columns == (
        tau,
        Column("ratio", "1", "a number"),
        Column("count", "", "a whole number"),
    )


def test_rows_are_told_apart_by_their_columns():
    kinds = kinds_of(Toy)
    turn = {"tau": 1.0, "way": "up", "omega": None}
    whole, part = {"tau": 1.0, "ratio": 2.0, "count": 1}, {"ratio": 2.0, "tau": 1.0}
    assert by_kind([turn, whole, part], kinds) == {"slow-turn": [turn], "other": [whole, part]}
    assert by_kind([turn], []) == {"": [turn]}
    with pytest.raises(LookupError, match="tau, phi"):
        by_kind([{"tau": 1.0, "phi": 2.0}], kinds)


@pytest.mark.parametrize("name", NAMES)
def test_every_column_of_every_run_is_explained(name):
    kinds = kinds_of(find(name).work)
    assert kinds
    names = [kind.name for kind in kinds]
    assert len(set(names)) == len(names)
    for kind in kinds:
        assert kind.meaning.endswith(".")
        assert [column.name for column in kind.columns if not column.meaning] == []
        alike = [
            other.name
            for other in kinds
            if other is not kind and other.has(dict.fromkeys(kind.required))
        ]
        assert alike == []
