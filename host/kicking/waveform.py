"""Waveforms of kicks in files: one value for each tick.

A file is plain text with a value a line, or a CSV table with a column for the values. Its first
line may name what the values are, such as `k` or `shift_rad`; a table needs that. Blank lines and
lines that begin with # count for nothing.
"""

from __future__ import annotations

import csv
from pathlib import Path

from host.errors import WrongUse
from host.util.numbers import parse_number
from robot.kick_requests import CHANGED
from robot.kicks import MAX_WAVEFORM

_NAMES = ", ".join(CHANGED)
# A file with the longest waveform is far smaller.
_MOST_BYTES = 1_000_000


def read_waveform(path: Path, param: str | None) -> tuple[str, list[float]]:
    """What a file's waveform changes, and its values, one a tick.

    Args:
        path: The file.
        param: What the waveform changes, one of robot.kick_requests.CHANGED; None to take what the
            file names.

    Returns:
        The name and the values in its unit.

    Raises:
        WrongUse: There is no such file, or it holds no waveform.
    """
    rows = _rows(path)
    header, first = None, rows[0][1]
    if any(cell and cell[0].isalpha() for cell in first):
        header, rows = first, rows[1:]
    named = [name for name in header or () if name in CHANGED]
    if header and not named:
        raise WrongUse(
            f"{path} names '{', '.join(header)}', which no kick changes",
            f"the first line may name one of {_NAMES}; the name says the unit, too",
        )
    if param is None and len(named) != 1:
        raise WrongUse(
            f"{path} names {'more than one' if named else 'no'} parameter, and a kick changes one",
            f"say which: --param with one of {_NAMES}",
        )
    name = param or named[0]
    if named and name not in named:
        raise WrongUse(
            f"{path} holds values of {', '.join(named)}, not of {name}",
            f"leave out --param, or change the first line to {name}",
        )
    column = header.index(name) if header else 0
    if not 0 < len(rows) <= MAX_WAVEFORM:
        raise WrongUse(
            f"{path} has {len(rows)} values, and a waveform has one for each tick, 1 to"
            f" {MAX_WAVEFORM}",
            "write fewer; 100 ticks of 30 ms last 3 s" if rows else "write one value on each line",
        )
    width = len(header) if header else 1
    return name, [_value(path, number, cells, column, width) for number, cells in rows]


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """The lines of a file that count, in cells, each with its number."""
    try:
        with path.open("rb") as file:
            raw = file.read(_MOST_BYTES + 1)
        if len(raw) > _MOST_BYTES:
            raise WrongUse(
                f"{path} is too large for a waveform", f"write 1 to {MAX_WAVEFORM} values"
            )
        text = raw.decode("utf-8-sig")
    except OSError as error:
        raise WrongUse(
            f"the waveform {path} cannot be read: {error.strerror}", "name a text file"
        ) from error
    except UnicodeDecodeError as error:
        raise WrongUse(f"{path} is no text", "save it as plain text or CSV, in UTF-8") from error
    lines = [
        (number, line.strip())
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.strip().startswith("#")
    ]
    if not lines:
        raise WrongUse(f"{path} is empty", "write one value on each line")
    mark = next((mark for mark in (";", "\t", ",") if mark in lines[0][1]), ",")
    return [
        (number, [cell.strip() for cell in next(csv.reader([line], delimiter=mark))])
        for number, line in lines
    ]


def _value(path: Path, number: int, cells: list[str], column: int, width: int) -> float:
    """The value of a line."""
    text = cells[column] if len(cells) == width else ""
    value = parse_number(text)
    if value is None:
        shown = ",".join(cells)[:40]
        raise WrongUse(
            f"line {number} of {path} is '{shown}', where a number should be",
            "write a point, as in 2.5, and one value on each line"
            if width == 1
            else f"write {width} cells on each line, as in the first one, and a point in numbers",
        )
    return float(value)
