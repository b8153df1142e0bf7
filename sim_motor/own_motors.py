"""A user's own motors: a file with tables as in motors.toml.

The experiment `calibrate` writes it.
"""

import os
import tomllib
from math import isfinite
from pathlib import Path
from typing import Any

from robot.user_folders import config_folder

Entry = dict[str, list[Any]]  # name -> [value, unit, source]

_MAY_BE_ZERO = {
    "viscous_friction",
    "coulomb_friction",
    "rolling_resistance",
    "backlash",
    "latency",
    "encoder_dither",
    "source_resistance",
    "spread",
}


def own_file() -> Path | None:
    """Where they are: $KICK_MOTORS, else a file in the user's configuration folder."""
    named = os.environ.get("KICK_MOTORS")
    if named:
        return Path(os.path.expanduser(named))  # noqa: PTH111 - Path.expanduser raises without home
    folder = config_folder()
    return Path(folder, "motors.toml") if folder else None


def own_motor(name: str, published: dict[str, Entry]) -> Entry:
    """A table of the user's file.

    Args:
        name: The table's.
        published: The tables of motors.toml.

    Returns:
        All that a published motor has, and what differs from the published robot.

    Raises:
        ValueError: There is no usable table of this name. The message says what to do.
    """
    path = own_file()
    known = [motor for motor in published if motor != "robot"]
    if name == "robot" or path is None or not path.exists():
        raise ValueError(
            f"there is no motor '{name}': published are {', '.join(known)}, and your own would be"
            f" in {path or 'a file that KICK_MOTORS names'}"
        )
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(
            f"your motors in {path} cannot be read: {error}; mend or remove that file"
        ) from error
    if name not in tables:
        raise ValueError(
            f"there is no motor '{name}': published are {', '.join(known)}, and your own in {path}:"
            f" {', '.join(tables)}"
        )
    entry: Entry = tables[name] if isinstance(tables[name], dict) else {}
    needed = published[known[0]]
    missing = [key for key in needed if key not in entry]
    strange = [key for key in entry if key not in needed and key not in published["robot"]]
    wrong = [key for key, row in entry.items() if not _sound(key, row)]
    for keys, fault in (
        (missing, "lacks"),
        (strange, "has, and nobody knows,"),
        (wrong, "has no [value, unit, source] that can be, in"),
    ):
        if keys:
            raise ValueError(
                f"motor '{name}' in {path} {fault} {', '.join(keys)}; mend that file, or calibrate"
                " again"
            )
    return entry


def _sound(key: str, row: Any) -> bool:
    if (
        not isinstance(row, list)
        or len(row) != 3
        or isinstance(row[0], bool)
        or not isinstance(row[0], (int, float))
    ):
        return False
    return isfinite(row[0]) and (row[0] > 0 or (row[0] == 0 and key in _MAY_BE_ZERO))
