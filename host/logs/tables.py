"""Logs as tables for spreadsheets and numpy: one row a tick, with the columns COLUMNS.

Columns have the names, units and meaning of robot.record.CHANNELS, but state and kick are words.
left_omega_rad_s and right_omega_rad_s are those of Log.omega. Floats read back bit for bit.
"""

from __future__ import annotations

import csv
import json
from typing import IO, Any, TextIO

from host.logs.tap import Event
from robot.kicks import WHEELS
from robot.record import KICK_NAMES, STATES

_WHEEL = ("phi_rad", "x1", "x2", "force", "torque", "duty_pct", "omega_rad_s")
# The order is a promise; new columns come last.
COLUMNS = (
    ("tick", "t_s", "dt_s")
    + tuple(f"{side}_{name}" for side in WHEELS for name in _WHEEL)
    + ("kick", "state", "late_s", "missed")
)


def columns(arrays: dict[str, Any]) -> dict[str, Any]:
    """A log's arrays in the order of COLUMNS, with state and kick as words; no kick is empty."""
    import numpy as np

    named = {
        "kick": np.array(KICK_NAMES)[arrays["kick"]],
        "state": np.array(STATES)[arrays["state"]],
    }
    return {name: named.get(name, arrays.get(name)) for name in COLUMNS}


def write_csv(arrays: dict[str, Any], out: TextIO) -> None:
    """Write the table as comma-separated values below a line of column names."""
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(zip(*(column.tolist() for column in columns(arrays).values()), strict=True))


def write_npz(
    arrays: dict[str, Any], info: dict[str, Any], events: list[Event], out: IO[bytes]
) -> None:
    """Write the columns as arrays of an .npz file, and `info` and `events` as JSON text."""
    import numpy as np

    np.savez_compressed(
        out,
        **columns(arrays),
        info=json.dumps(info, allow_nan=False),
        events=json.dumps(events, allow_nan=False),
    )
