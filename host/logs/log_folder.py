"""The folder of logs: names for new logs, and a list of those that are there."""

from __future__ import annotations

from datetime import datetime
from math import inf
from pathlib import Path
from typing import NamedTuple

from mcap.reader import SeekingReader

from host.logs.mcap_files import DAMAGE, METADATA, TICKS, LogError, play
from host.logs.tap import Event
from robot.record import Record

LOG_FOLDER = Path("logs")


def new_path(kind: str) -> Path:
    """A free name in ./logs for a log that begins now, as logs/kick-20261122-153012.mcap.

    The time is local. The folder is created if it is not there.

    Raises:
        LogError: The folder cannot be created.
    """
    stem = f"{kind}-{datetime.now().astimezone():%Y%m%d-%H%M%S}"
    path = LOG_FOLDER / f"{stem}.mcap"
    number = 1
    while path.exists():
        number += 1
        path = LOG_FOLDER / f"{stem}-{number}.mcap"
    try:
        LOG_FOLDER.mkdir(exist_ok=True)
    except OSError as error:
        raise LogError(
            f"the folder {LOG_FOLDER} cannot be created here: {error.strerror}",
            "go to a folder that you may write to",
        ) from None
    return path


class Summary(NamedTuple):
    """One line of a list of logs.

    Attributes:
        path: the file.
        ticks: how many ticks it holds.
        seconds: how much of the robot's time they cover (s).
        brick: address of the robot.
        started_utc: when the log began.
        note: empty, or what is wrong with the file.
    """

    path: Path
    ticks: int
    seconds: float
    brick: str
    started_utc: str
    note: str


def list_logs(folder: str | Path = LOG_FOLDER) -> list[Summary]:
    """The MCAP files in a folder, by name. Only files that break off are read as a whole."""
    return [_summarize(path) for path in sorted(Path(folder).glob("*.mcap"))]


def _summarize(path: Path) -> Summary:
    try:
        found = _summary_of_whole(path)
    except (OSError, *DAMAGE):
        found = None
    if found is not None:
        return found
    extent = _Extent()
    try:
        info, whole = play(path, extent)
    except LogError as error:
        return Summary(path, 0, 0.0, "", "", str(error))
    brick, started_utc = str(info.get("brick", "")), str(info.get("started_utc", ""))
    note = "" if whole else "breaks off"
    return Summary(path, extent.ticks, extent.seconds, brick, started_utc, note)


def _summary_of_whole(path: Path) -> Summary | None:
    """The summary of a file that has an index at its end; None without one."""
    with path.open("rb") as file:
        reader = SeekingReader(file)
        summary = reader.get_summary()
        info = {item.name: item.metadata for item in reader.iter_metadata()}.get(METADATA)
    if summary is None or summary.statistics is None or info is None:
        return None
    statistics = summary.statistics
    counts = statistics.channel_message_counts
    channels = [channel.id for channel in summary.channels.values() if channel.topic == TICKS]
    ticks = sum(counts.get(channel, 0) for channel in channels)
    seconds = (statistics.message_end_time - statistics.message_start_time) / 1e9
    return Summary(path, ticks, seconds, info.get("brick", ""), info.get("started_utc", ""), "")


class _Extent:
    """A tap that finds how long a stream is."""

    def __init__(self) -> None:
        self.ticks = 0
        self.seconds = 0.0
        self._latest_s = inf

    def take_records(self, records: list[Record]) -> None:
        for record in records:
            self.seconds += max(0.0, record.t_s - self._latest_s)
            self._latest_s = record.t_s
        self.ticks += len(records)

    def take_event(self, event: Event) -> None:
        """A robot that restarts counts its time from zero; `take_records` ignores the step back."""
