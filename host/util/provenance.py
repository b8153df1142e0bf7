"""Where a log or a result comes from: robot, host, commit, and a fingerprint of the sources."""

from __future__ import annotations

import platform
import subprocess
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

import host as host_package
import robot as robot_package
import sim_motor
from host.errors import NotDone, printable
from robot import __version__
from robot.sources import fingerprint, times


def origin(
    uri: str,
    hello: dict[str, Any],
    status: dict[str, Any],
    clock_zero_s: float,
    started_utc: datetime,
) -> dict[str, Any]:
    """A log's `info`.

    Args:
        uri: The robot's address.
        hello: What the robot said when this host connected.
        status: Its status.
        clock_zero_s: The Unix time at which the robot's clock showed 0, s.
        started_utc: When this host connected.

    Returns:
        Plain data. A robot of an older release does not say its sources: they are empty then; nor
        its motors, which are left out.
    """
    return {
        "brick": uri,
        "seed": hello["seed"],
        "boot": hello["boot"],
        "robot_software": hello["software"],
        "robot_sources": hello.get("sources", ""),
        "robot_machine": hello["machine"],
        **({"motor": printable(str(hello["motor"]))} if "motor" in hello else {}),
        "host_software": __version__,
        "host_machine": (
            f"{platform.machine()} {platform.python_implementation()} {platform.python_version()}"
        ),
        "sources": sources(),
        "commit": commit(),
        "params": status["params"],
        "polarity": {side: status["params"]["polarity_" + side] for side in ("left", "right")},
        "battery_v": status["battery_v"],
        "clock_zero_s": clock_zero_s,
        "started_utc": started_utc.isoformat(),
    }


# Of host/ only these cannot change a result: they speak to people, draw, film, or show a page. All
# else counts, and so does a new package until it is named here.
SHOWS_ONLY = ("__main__.py", "cli.py", "commands", "figures", "films", "lab")


def _places() -> list[str]:
    """What can change a result: robot/, sim_motor/, and host/ without SHOWS_ONLY."""
    host, robot, motors = (
        Path(package.__path__[0]).resolve() for package in (host_package, robot_package, sim_motor)
    )
    computing = sorted(
        path
        for path in host.iterdir()
        if path.name not in SHOWS_ONLY
        and not path.name.startswith(".")
        and (path.is_dir() or path.suffix == ".py")
    )
    return [str(path) for path in (robot, motors, *computing)]


# When this module is imported, the program has just begun: later, somebody may change a source.
_TIMES, _LOADED = times(*_places()), str(fingerprint(*_places()))


def sources() -> str:
    """The fingerprint of the sources that this program has loaded, 16 hexadecimal digits.

    A kept result, plan or map belongs to the sources that computed it, and is never taken for that
    of others.
    """
    return _LOADED


def unchanged() -> bool:
    """Whether the sources still are what this program has loaded.

    If not, it computes with the old code, and with the new code of what it had not loaded.
    """
    places = _places()
    # A cluster's worker asks for each cell, so the files are read only if one has been written.
    return bool(times(*places) == _TIMES or fingerprint(*places) == _LOADED)


def require_unchanged() -> None:
    """Raise NotDone if a source has changed since this program began."""
    if not unchanged():
        raise NotDone(
            f"the sources in {Path(host_package.__path__[0]).resolve().parent} have changed since"
            " this program began, so it would compute with old and new ones",
            "run the same command again; in a notebook, restart the kernel first",
        )


@cache
def commit() -> str:
    """The commit of the checkout that this runs from, with a '+' if files have changed since.

    Empty if this does not run from a checkout.
    """
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return ""
    name = _git(root, "describe", "--always")
    changed = _git(root, "status", "--porcelain", "--untracked-files=no")
    return name + "+" * bool(name and changed)


def _git(root: Path, *words: str) -> str:
    """What git answers; empty if it fails. `describe --dirty` would lock the user's index."""
    try:
        done = subprocess.run(
            ["git", "--no-optional-locks", *words],
            cwd=root,
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip()
