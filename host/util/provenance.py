"""What a log must say of where it comes from."""

from __future__ import annotations

import platform
import subprocess
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

from robot import __version__


def origin(
    uri: str,
    hello: dict[str, Any],
    status: dict[str, Any],
    clock_zero_s: float,
    started_utc: datetime,
) -> dict[str, Any]:
    """A log's `info`, from the robot's hello and status, the Unix time of its clock's zero, and when this host met it."""
    return {
        "brick": uri,
        "seed": hello["seed"],
        "boot": hello["boot"],
        "robot_software": hello["software"],
        "robot_machine": hello["machine"],
        "host_software": __version__,
        "host_machine": (
            f"{platform.machine()} {platform.python_implementation()} {platform.python_version()}"
        ),
        "commit": commit(),
        "params": status["params"],
        "polarity": {side: status["params"]["polarity_" + side] for side in ("left", "right")},
        "battery_v": status["battery_v"],
        "clock_zero_s": clock_zero_s,
        "started_utc": started_utc.isoformat(),
    }


@cache
def commit() -> str:
    """The commit of the checkout that this runs from, with a '+' if it was changed.

    Empty outside of one.
    """
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return ""
    try:
        done = subprocess.run(
            ["git", "describe", "--always", "--dirty=+"],
            cwd=root,
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip()
