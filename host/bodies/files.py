"""Write the motion of a simulated body to files with named columns.

MCAP, which Foxglove, Lichtblick and PlotJuggler open, and CSV.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray

from robot import __version__

TOPIC = "/state"
_UNITS = {"t_s": "s", "_rad": "rad", "_rad_s": "rad/s", "_nm": "N m", "_m": "m"}


def unit(column: str) -> str:
    """The unit at the end of a column's name; '1' if there is none."""
    endings = [ending for ending in _UNITS if column.endswith(ending)]
    return _UNITS[max(endings, key=len)] if endings else "1"


class CsvStates:
    """A file with a line for each time, with every bit of the numbers.

    Args:
        path: The file.
        columns: Names of the columns.
    """

    def __init__(self, path: Path, columns: tuple[str, ...]) -> None:
        self._file = path.open("w", newline="", encoding="utf-8")
        self._writer = csv.writer(self._file)
        self._writer.writerow(columns)

    def add(self, rows: NDArray[np.float64]) -> None:
        """Write the next rows, (times, columns)."""
        self._writer.writerows(rows.tolist())

    def finish(self) -> None:
        """End the file."""
        self._file.close()


class McapStates:
    """A file with a message for each time on the channel /state; log times are simulated times.

    Args:
        path: The file.
        columns: Names of the columns; the first is the time in s.
        info: Plain data about the run, kept as metadata.
    """

    def __init__(self, path: Path, columns: tuple[str, ...], info: dict[str, Any]) -> None:
        schema = {
            "title": "state",
            "description": "a simulated body",
            "type": "object",
            "properties": {
                column: {"type": "number", "description": f"[{unit(column)}]"} for column in columns
            },
            "required": list(columns),
        }
        metadata = {name: json.dumps(value, allow_nan=False) for name, value in info.items()}
        self._columns, self._count, self._file = columns, 0, path.open("wb")
        self._writer: Any = Writer(
            self._file, compression=CompressionType.LZ4, enable_data_crcs=True
        )
        self._writer.start(library=f"kickctl {__version__}")
        self._writer.add_metadata("kickctl", metadata)
        schema_id = self._writer.register_schema(
            "kickctl.State", "jsonschema", json.dumps(schema, allow_nan=False).encode()
        )
        self._channel = self._writer.register_channel(TOPIC, "json", schema_id)

    def add(self, rows: NDArray[np.float64]) -> None:
        """Write the next rows, (times, columns)."""
        for row in rows.tolist():
            time_ns = round(row[0] * 1e9)
            message = json.dumps(dict(zip(self._columns, row, strict=True)), allow_nan=False)
            self._writer.add_message(self._channel, time_ns, message.encode(), time_ns, self._count)
            self._count += 1

    def finish(self) -> None:
        """End the file."""
        with self._file:
            self._writer.finish()
