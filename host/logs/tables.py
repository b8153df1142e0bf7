"""Logs as tables, for spreadsheets and numpy: one row a tick, in the columns of COLUMNS.

Channels have the names, units and meaning of robot.record.CHANNELS, with names for state and kick; to these comes
left_omega_rad_s, right_omega_rad_s, as Log.omega has them. Floats are written so that they read back bit for bit.
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
    """A log's arrays in the order of COLUMNS, with kick (its mode, or empty) and state as text."""
    import numpy as np

    named = {
        "kick": np.array(KICK_NAMES)[arrays["kick"]],
        "state": np.array(STATES)[arrays["state"]],
    }
    return {name: named.get(name, arrays.get(name)) for name in COLUMNS}


def write_csv(arrays: dict[str, Any], out: TextIO) -> None:
    """Write the table as comma-separated values under a line of names."""
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(zip(*(column.tolist() for column in columns(arrays).values()), strict=True))


def write_npz(
    arrays: dict[str, Any], info: dict[str, Any], events: list[Event], out: IO[bytes]
) -> None:
    """Write the columns as arrays of an .npz file, and `info` and `events` as JSON text."""
    import numpy as np

    np.savez_compressed(out, **columns(arrays), info=json.dumps(info), events=json.dumps(events))
