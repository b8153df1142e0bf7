"""The course of a simulated body on disk.

MCAP, which Foxglove, Lichtblick and PlotJuggler open, and CSV, both with named columns.
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
    """The unit of a column, which its name ends with; 1 if it has none."""
    endings = sorted((ending for ending in _UNITS if column.endswith(ending)), key=len)
    return _UNITS[endings[-1]] if endings else "1"


def write_csv(path: Path, columns: tuple[str, ...], rows: NDArray[np.float64]) -> Path:
    """A row for each time, with every bit of the numbers."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(rows.tolist())
    return path


def write_mcap(
    path: Path, columns: tuple[str, ...], rows: NDArray[np.float64], info: dict[str, Any]
) -> Path:
    """A message for each time on the channel /state; the log time is the simulated one. info.

    Plain data, kept as metadata.
    """
    properties = {
        column: {"type": "number", "description": f"[{unit(column)}]"} for column in columns
    }
    schema = {
        "title": "state",
        "description": "a simulated body",
        "type": "object",
        "properties": properties,
        "required": list(columns),
    }
    with path.open("wb") as file:
        writer: Any = Writer(file, compression=CompressionType.LZ4, enable_data_crcs=True)
        writer.start(library=f"kickctl {__version__}")
        writer.add_metadata("kickctl", {name: json.dumps(value) for name, value in info.items()})
        identity = writer.register_schema(
            "kickctl.State", "jsonschema", json.dumps(schema).encode()
        )
        channel = writer.register_channel(TOPIC, "json", identity)
        for number, row in enumerate(rows.tolist()):
            time_ns = round(row[0] * 1e9)
            writer.add_message(
                channel,
                time_ns,
                json.dumps(dict(zip(columns, row, strict=True))).encode(),
                time_ns,
                number,
            )
        writer.finish()
    return path
