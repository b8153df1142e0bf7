"""Logs as tables, for spreadsheets and numpy: one row a tick, in the columns of COLUMNS.

Channels have the names, units and meaning of robot.record.CHANNELS, with names for state and kick; to these comes
left_omega_rad_s, right_omega_rad_s: Log.omega. Floats are written so that they read back bit for bit.
"""

from __future__ import annotations

import csv
import json
from typing import IO, Any, TextIO

from host.log import Log
from robot.kicks import WHEELS
from robot.record import KICK_NAMES, STATES

_WHEEL = ("phi_rad", "x1", "x2", "force", "torque", "duty_pct", "omega_rad_s")
# The order is a promise; new columns come last.
COLUMNS = ("tick", "t_s", "dt_s") + tuple(f"{side}_{name}" for side in WHEELS for name in _WHEEL) + ("kick", "state", "late_s", "missed")


def columns(log: Log) -> dict[str, Any]:
    """numpy arrays by the names and in the order of COLUMNS; kick (its mode, or empty) and state as text."""
    import numpy as np

    table = log.arrays()
    table["kick"] = np.array(KICK_NAMES)[table["kick"]]
    table["state"] = np.array(STATES)[table["state"]]
    for side in WHEELS:
        table[f"{side}_omega_rad_s"] = log.omega(side)
    return {name: table[name] for name in COLUMNS}


def write_csv(log: Log, out: TextIO) -> None:
    """Write the table as comma-separated values under a line of names."""
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(zip(*(column.tolist() for column in columns(log).values()), strict=True))


def write_npz(log: Log, out: IO[bytes]) -> None:
    """Write the columns as arrays of an .npz file, and `info` and `events` as JSON text."""
    import numpy as np

    np.savez_compressed(out, **columns(log), info=json.dumps(log.info), events=json.dumps(log.events))
