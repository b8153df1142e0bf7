"""The folder of logs: names for new logs, and a list of those that are there."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from itertools import chain, count
from math import inf
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from host.logs.mcap_files import LogError, NameTaken
from host.logs.mcap_index import read_index
from host.logs.mcap_reading import LogFile
from host.logs.tap import Event
from robot.record import Record

T = TypeVar("T")

LOG_FOLDER = Path("logs")
# The notes of logs that cannot be read to their end: one has no end (yet), the other one has.
BREAKS_OFF, DAMAGED = "breaks off", "damaged"
# By so much (s) the clocks of a robot and of this computer may part.
_CLOCKS_PART_S = 60.0


def in_folder(what: str, info: dict[str, Any], write: Callable[[Path], T]) -> T:
    """Write a log that begins now to ./logs, under a name that says what it is.

    It is named as in logs/20261122-153012-ev3dev.local-kick-phase-4-ticks.mcap: by the local time,
    so that names sort by it, the robot, and what was done. The folder is created if it does not
    exist.

    Args:
        what: What was done.
        info: What is known of it, as in Log; `robot` is the robot's name if it has one, `brick`
            its address.
        write: Creates the file that it gets; see `under_free_name`.

    Returns:
        What `write` returns.

    Raises:
        LogError: The folder or the file cannot be created.
        OSError: The disk is full.
    """
    try:
        LOG_FOLDER.mkdir(exist_ok=True)
    except FileExistsError:
        kind = "a link that leads nowhere" if LOG_FOLDER.is_symlink() else "a file"
        raise LogError(
            f"logs go to the folder {LOG_FOLDER}, and {LOG_FOLDER} is {kind} here",
            "rename or remove it, or go to another folder",
        ) from None
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise
        raise LogError(
            f"the folder {LOG_FOLDER} cannot be created here: {error.strerror}",
            "go to a folder that you may write to",
        ) from None
    moment = datetime.now().astimezone()
    robot = str(info.get("robot") or robot_in_name(str(info.get("brick", ""))))
    parts = [f"{moment:%Y%m%d-%H%M%S}", robot, what]
    return under_free_name(LOG_FOLDER / ("-".join(filter(None, parts)) + ".mcap"), write)


def robot_in_name(address: str) -> str:
    """What a file's name says of a robot: its host or device, or the kind of its address.

    Args:
        address: The robot's, as in ssh://robot@ev3dev.local; may be empty.

    Returns:
        Letters, digits, points and hyphens, at most 40.
    """
    kind, _, rest = address.partition("://")
    place = rest.partition("?")[0].rpartition("@")[2].rstrip("/").rpartition("/")[2]
    plain, plain_kind = (re.sub("[^A-Za-z0-9.]+", "-", text).strip("-.") for text in (place, kind))
    return (plain or plain_kind)[:40].strip("-.")


def under_free_name(path: Path, write: Callable[[Path], T]) -> T:
    """Write a log under the first free name of NAME.mcap, NAME-2.mcap, NAME-3.mcap ...

    A name is free if a file of this name can be created. Looking first would not do: another
    program may take it in between.

    Args:
        path: NAME.mcap.
        write: Creates the file that it gets, or raises NameTaken.

    Returns:
        What `write` returns.
    """
    others = (path.with_stem(f"{path.stem}-{number}") for number in count(2))
    for name in chain([path], others):
        with suppress(NameTaken):
            return write(name)
    raise AssertionError("numbers do not end")


def rename_log(path: Path, name: str) -> Path:
    """Give a log another name in its folder, or the next free one after it; replace nothing.

    Args:
        path: The log, which may still be written.
        name: The new name, as in NAME.mcap.

    Returns:
        The log's path from now on: the old one if the system does not let it be renamed.
    """

    def move(target: Path) -> Path:
        try:
            target.touch(exist_ok=False)
        except FileExistsError:
            raise NameTaken(target) from None
        return path.replace(target)

    try:
        return under_free_name(path.with_name(name), move)
    except OSError:
        return path


class Summary(NamedTuple):
    """One line of a list of logs.

    Attributes:
        path: the file.
        ticks: how many ticks it holds.
        seconds: how much of the robot's time they cover (s).
        brick: address of the robot.
        started_utc: when its first tick was, ISO 8601; when the host connected, if that is not
            known, as of a simulated robot whose time is ahead of this computer's.
        note: empty, or what is wrong with the file.
    """

    path: Path
    ticks: int
    seconds: float
    brick: str
    started_utc: str
    note: str


def list_logs(folder: str | Path = LOG_FOLDER) -> list[Summary]:
    """The MCAP files in a folder, by name.

    The checksum of each file is compared. The ticks are read of damaged files only; `ticks` are
    those before the damage. A file that is deleted meanwhile is not listed.

    Raises:
        LogError: The folder cannot be read.
    """
    try:
        paths = sorted(path for path in Path(folder).iterdir() if path.name.endswith(".mcap"))
    except FileNotFoundError:
        return []
    except OSError as error:
        raise LogError(
            f"the folder {folder} cannot be read: {error.strerror}",
            "name a folder that you may read",
        ) from None
    summaries = map(_summarize, paths)
    return [summary for summary in summaries if os.path.lexists(summary.path)]


def _summarize(path: Path) -> Summary:
    try:
        found = _summary_of_whole(path) if path.is_file() else None
    except OSError:
        found = None
    if found is not None:
        return found
    extent = _Extent()
    try:
        log = LogFile(path)
        for item in log.stream():
            extent.take(item)
    except LogError as error:
        return Summary(path, 0, 0.0, "", "", error.message)
    brick, connected_utc = str(log.info.get("brick", "")), str(log.info.get("started_utc", ""))
    started_utc = _started_utc(path, extent.began_s(log.info), connected_utc)
    note = "" if log.whole else BREAKS_OFF
    if log.breaks_off and (total := log.total) is not None:
        note = f"{DAMAGED}: {total - extent.ticks} of {total} ticks are missing"
    return Summary(path, extent.ticks, extent.seconds, brick, started_utc, note)


def _summary_of_whole(path: Path) -> Summary | None:
    """The summary of an intact file that has an index at its end; None of any other."""
    index = read_index(path)
    if index is None or not index.intact or not index.info:
        return None
    brick, connected_utc = index.info.get("brick", ""), index.info.get("started_utc", "")
    began_s = index.began_s if index.ticks and "clock_zero_s" in index.info else None
    started_utc = _started_utc(path, began_s, connected_utc)
    return Summary(path, index.ticks, index.seconds, brick, started_utc, "")


def _started_utc(path: Path, began_s: float | None, connected_utc: str) -> str:
    """When a log began, by its first tick (Unix time, s) or when the host connected."""
    try:
        written_s = path.stat().st_mtime
    except OSError:  # it was deleted meanwhile
        return connected_utc
    # No log begins after it was written: then the robot's time is not this computer's.
    if began_s is None or not 0.0 <= began_s <= written_s + _CLOCKS_PART_S:
        return connected_utc
    return datetime.fromtimestamp(began_s, UTC).isoformat()


class _Extent:
    """Finds how long a stream is, and when it begins."""

    def __init__(self) -> None:
        self.ticks = 0
        self.seconds = 0.0
        self._latest_s = inf
        self._first_s: float | None = None

    def began_s(self, info: dict[str, Any]) -> float | None:
        """When the first record was (Unix time, s); None if the log's info or records lack it."""
        zero_s = info.get("clock_zero_s")
        return None if zero_s is None or self._first_s is None else zero_s + self._first_s

    def take(self, item: Event | Record) -> None:
        """Count a record. A robot that restarts counts its time from zero: a step back is none."""
        if not isinstance(item, dict):
            self._first_s = item.t_s if self._first_s is None else self._first_s
            self.seconds += max(0.0, item.t_s - self._latest_s)
            self._latest_s = item.t_s
            self.ticks += 1
