"""Logs on disk: MCAP files with JSON schemas, which Foxglove, Lichtblick and PlotJuggler open, and which read back bit for bit.

A file holds the metadata record `kickctl` (the log's info; text as it is, anything else as JSON), the channel /ticks with one
message a tick and the channel /events. Messages stand in the order of the robot's stream; an event carries the log time of the
record it precedes. A chunk is closed, and handed to the operating system, for every second of robot time: a process that is killed
loses what came after the last whole chunk, and since chunks follow each other with nothing needed from the end of the file, the
rest reads without it.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from math import inf
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from mcap.records import Channel, Message, Metadata
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from host.errors import WrongUse
from host.logs.tap import Event, Tap
from robot import __version__
from robot.record import CHANNELS, KICK_NAMES, NAMES, STATES, Record

METADATA = "kickctl"
FORMAT = "1"
TICKS, EVENTS = "/ticks", "/events"
LOG_FOLDER = Path("logs")
CHUNK_S = 1.0

_GIVE_OURS = "give a log that kickctl recorded; 'kickctl log list' shows those in ./logs"
_NAMED = {"state": STATES, "kick": KICK_NAMES}
# What a file that breaks off or was damaged makes the reader stumble over; a wrong checksum and wrong UTF-8 are ValueErrors.
_DAMAGE = (McapError, struct.error, ValueError, RuntimeError, KeyError, OverflowError, MemoryError)


class LogError(WrongUse):
    """A log cannot be made or read."""


def _ticks_schema() -> dict[str, Any]:
    properties: dict[str, Any] = {}
    for channel in CHANNELS:
        if channel.name in _NAMED:
            properties[channel.name] = {"type": "string", "enum": list(_NAMED[channel.name])}
        else:
            properties[channel.name] = {"type": "number" if channel.code in "df" else "integer"}
        properties[channel.name]["description"] = (
            f"[{channel.unit}] {channel.doc.split(':')[0] if channel.name in _NAMED else channel.doc}"
        )
    return {
        "title": "tick",
        "description": "one tick of the robot",
        "type": "object",
        "properties": properties,
        "required": list(NAMES),
    }


def _events_schema() -> dict[str, Any]:
    properties = {
        "event": {"type": "string", "description": "what happened"},
        "tick": {"type": "integer", "description": "[1] the first tick that it concerns"},
        "reason": {"type": "string", "description": "why, for people"},
    }
    return {
        "title": "event",
        "description": "what changed the robot's course",
        "type": "object",
        "properties": properties,
    }


def _to_text(value: Any) -> str:
    """Text as it is unless it would read back as something else; everything else as JSON."""
    if isinstance(value, str):
        try:
            json.loads(value)
        except ValueError:
            return value
    return json.dumps(value)


def _from_text(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


class McapTap:
    """A Tap that writes a new file while the stream arrives; a context manager. `path` is where.

    info: see Log; its clock_zero_s, or that of a `restart` event for what follows, turns the robot's clock into UTC.
    Raises LogError if the file exists already or cannot be made: a log is never overwritten. OSError, with the
    file's name, if the disk fails later.
    """

    def __init__(self, path: str | Path, info: dict[str, Any]) -> None:
        self.path = Path(path)
        try:
            self._file = self.path.open("xb")
        except OSError as error:
            if self.path.exists():
                raise LogError(
                    f"{self.path} exists already, and logs are never overwritten",
                    "choose another name",
                ) from None
            raise LogError(
                f"{self.path} cannot be made: {error.strerror}",
                "choose a folder that is there, and that you may write to",
            ) from None
        self._zero_ns = _nanoseconds(info.get("clock_zero_s", 0.0))
        self._now_ns = self._chunk_ns = self._zero_ns
        self._waiting: list[Event] = []
        self._writer: Any = Writer(
            self._file, compression=CompressionType.LZ4, enable_data_crcs=True
        )
        self._writer.start(library=f"kickctl {__version__}")
        self._writer.add_metadata(
            METADATA, {"format": FORMAT, **{name: _to_text(value) for name, value in info.items()}}
        )
        self._ticks = self._register(TICKS, "kickctl.Tick", _ticks_schema())
        self._events = self._register(EVENTS, "kickctl.Event", _events_schema())
        self._writer.flush()

    def _register(self, topic: str, name: str, schema: dict[str, Any]) -> int:
        identity = self._writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
        return int(self._writer.register_channel(topic, "json", identity))

    def take_records(self, records: list[Record]) -> None:
        """Write records, and the events that waited for the first of them."""
        with _named(self.path):
            for record in records:
                self._now_ns = self._zero_ns + _nanoseconds(record.t_s)
                self._write_events()
                message = record._asdict()
                for name, words in _NAMED.items():
                    message[name] = words[message[name]]
                self._write(self._ticks, message, record.tick)
                if abs(self._now_ns - self._chunk_ns) >= CHUNK_S * 1e9:
                    self._writer.flush()
                    self._chunk_ns = self._now_ns

    def take_event(self, event: Event) -> None:
        """Keep an event until the record it concerns tells the time."""
        if event["event"] == "restart" and "clock_zero_s" in event:
            self._zero_ns = _nanoseconds(event["clock_zero_s"])
        self._waiting.append(event)

    def _write_events(self) -> None:
        for event in self._waiting:
            self._write(self._events, event, event["tick"])
        self._waiting.clear()

    def _write(self, channel: int, message: dict[str, Any], tick: int) -> None:
        data = json.dumps(message, separators=(",", ":")).encode()
        self._writer.add_message(channel, self._now_ns, data, self._now_ns, tick)

    def close(self) -> None:
        """Write what waits and the file's index. Once is enough, more does no harm."""
        if self._file.closed:
            return
        with _named(self.path), self._file:
            self._write_events()
            self._writer.finish()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Have the OSError of a disk that is full or fails tell which file it was."""
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        raise


def _nanoseconds(seconds: float) -> int:
    return round(seconds * 1e9)


def play(path: str | Path, tap: Tap) -> tuple[dict[str, Any], bool]:
    """Feed a tap with the stream in a file. Returns the log's info, and whether the file is whole.

    One that breaks off or is damaged gives what can be read up to there. Raises LogError if the file cannot be opened, is no MCAP file,
    or is none of ours.
    """
    path = Path(path)
    info: dict[str, Any] | None = None
    whole = True
    topics: dict[int, str] = {}
    try:
        with path.open("rb") as file:
            if file.read(8) != b"\x89MCAP0\r\n":
                raise LogError(f"{path} is not an MCAP file", _GIVE_OURS)
            file.seek(0)
            try:
                for item in StreamReader(
                    file, validate_crcs=True, record_size_limit=path.stat().st_size
                ).records:
                    if isinstance(item, Metadata) and item.name == METADATA:
                        info = _info(path, item.metadata)
                    elif isinstance(item, Channel):
                        topics[item.id] = item.topic
                    elif isinstance(item, Message) and info is not None:
                        _take(tap, topics[item.channel_id], json.loads(item.data))
            except _DAMAGE:
                whole = False
    except OSError as error:
        raise LogError(
            f"{path} cannot be read: {error.strerror}",
            "'kickctl log list' shows the logs there are",
        ) from None
    if info is None:
        raise LogError(f"{path} is an MCAP file, but holds no log of kickctl", _GIVE_OURS)
    return info, whole


def _info(path: Path, metadata: dict[str, str]) -> dict[str, Any]:
    if metadata.get("format") != FORMAT:
        raise LogError(
            f"{path} has log format {metadata.get('format')}, not {FORMAT}",
            "read it with the release that wrote it",
        )
    return {name: _from_text(text) for name, text in metadata.items() if name != "format"}


def _take(tap: Tap, topic: str, message: dict[str, Any]) -> None:
    if topic == TICKS:
        for name, words in _NAMED.items():
            message[name] = words.index(message[name])
        values = [message[name] for name in NAMES]
        if not all(isinstance(value, (int, float)) for value in values):
            raise ValueError("a value that is no number")
        tap.take_records([Record(*values)])
    elif topic == EVENTS:
        tap.take_event(message)


def new_path(kind: str) -> Path:
    """A name in ./logs for a new log that begins now (local time), as logs/kick-20261122-153012.mcap; one that is not taken.

    Makes the folder if need be. Raises LogError if that cannot be done.
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
            f"the folder {LOG_FOLDER} cannot be made here: {error.strerror}",
            "go to a folder that you may write to",
        ) from None
    return path


class Summary(NamedTuple):
    """One line of a list of logs. `note` is empty, or says what is wrong with the file."""

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
        with path.open("rb") as file:
            reader = SeekingReader(file)
            summary = reader.get_summary()
            info = {item.name: item.metadata for item in reader.iter_metadata()}.get(METADATA)
            if summary is not None and summary.statistics is not None and info is not None:
                counts = summary.statistics.channel_message_counts
                ticks = sum(
                    counts.get(channel.id, 0)
                    for channel in summary.channels.values()
                    if channel.topic == TICKS
                )
                seconds = (
                    summary.statistics.message_end_time - summary.statistics.message_start_time
                ) / 1e9
                return Summary(
                    path, ticks, seconds, info.get("brick", ""), info.get("started_utc", ""), ""
                )
    except (OSError, *_DAMAGE):
        pass  # without its index, the file has to be read
    extent = _Extent()
    try:
        brief, whole = play(path, extent)
    except LogError as error:
        return Summary(path, 0, 0.0, "", "", str(error))
    note = "" if whole else "breaks off"
    return Summary(
        path,
        extent.ticks,
        extent.seconds,
        str(brief.get("brick", "")),
        str(brief.get("started_utc", "")),
        note,
    )


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
        """A robot that begins anew counts its time anew; the step back is no time."""
