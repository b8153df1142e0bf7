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

from host.util.whole_files import whole_file
from robot import __version__

TOPIC = "/state"
_UNITS = {"t_s": "s", "_rad": "rad", "_rad_s": "rad/s", "_nm": "N m", "_m": "m"}


def unit(column: str) -> str:
    """The unit at the end of a column's name; '1' if there is none."""
    endings = [ending for ending in _UNITS if column.endswith(ending)]
    return _UNITS[max(endings, key=len)] if endings else "1"


def write_csv(path: Path, columns: tuple[str, ...], rows: NDArray[np.float64]) -> Path:
    """Write a line for each time, with every bit of the numbers.

    Args:
        path: the file.
        columns: names of the columns.
        rows: (times, columns).

    Returns:
        The path.
    """
    with whole_file(path) as draft, draft.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(row.tolist() for row in rows)  # not all at once: that takes much memory
    return path


def write_mcap(
    path: Path, columns: tuple[str, ...], rows: NDArray[np.float64], info: dict[str, Any]
) -> Path:
    """Write a message for each time on the channel /state; log times are simulated times.

    Args:
        path: the file.
        columns: names of the columns; the first is the time in s.
        rows: (times, columns).
        info: plain data about the run, kept as metadata.

    Returns:
        The path.
    """
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
    with whole_file(path) as draft, draft.open("wb") as file:
        writer: Any = Writer(file, compression=CompressionType.LZ4, enable_data_crcs=True)
        writer.start(library=f"kickctl {__version__}")
        writer.add_metadata("kickctl", metadata)
        schema_id = writer.register_schema(
            "kickctl.State", "jsonschema", json.dumps(schema, allow_nan=False).encode()
        )
        channel = writer.register_channel(TOPIC, "json", schema_id)
        for number, row in enumerate(map(np.ndarray.tolist, rows)):
            time_ns = round(row[0] * 1e9)
            message = json.dumps(dict(zip(columns, row, strict=True)), allow_nan=False)
            writer.add_message(channel, time_ns, message.encode(), time_ns, number)
        writer.finish()
    return path
