"""Logs on disk: MCAP files with JSON schemas, which read back bit for bit.

Foxglove, Lichtblick and PlotJuggler open them. A file holds the metadata record `kickctl` (the
log's info: text as it is, anything else as JSON), the channel /ticks with one message a tick, and
the channel /events. Messages have the order of the robot's stream; an event has the log time of the
record that follows it. A chunk is closed and given to the operating system for every second of
robot time. A process that is killed loses what came after the last whole chunk; the rest reads
without the end of the file.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from mcap.exceptions import McapError
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
CHUNK_S = 1.0

_GIVE_OURS = "give a log that kickctl recorded; 'kickctl log list' shows those in ./logs"
_NAMED = {"state": STATES, "kick": KICK_NAMES}
# What the reader raises for a file that breaks off or was damaged. A wrong checksum and wrong UTF-8
# are ValueErrors.
DAMAGE = (McapError, struct.error, ValueError, RuntimeError, KeyError, OverflowError, MemoryError)


class LogError(WrongUse):
    """A log cannot be written or read."""


def _ticks_schema() -> dict[str, Any]:
    properties: dict[str, Any] = {}
    for channel in CHANNELS:
        if channel.name in _NAMED:
            properties[channel.name] = {"type": "string", "enum": list(_NAMED[channel.name])}
        else:
            properties[channel.name] = {"type": "number" if channel.code in "df" else "integer"}
        doc = channel.doc.split(":")[0] if channel.name in _NAMED else channel.doc
        properties[channel.name]["description"] = f"[{channel.unit}] {doc}"
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
    return json.dumps(value, allow_nan=False)


def _from_text(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


class McapTap:
    """A Tap, and context manager, that writes a new file while the stream arrives.

    Args:
        path: the new file; also an attribute. A log is never overwritten.
        info: see Log. Its clock_zero_s turns the robot's clock into UTC; after a `restart` event,
            that of the event does.

    Raises:
        LogError: The file exists already or cannot be written.
        OSError: The disk fails later; the error names the file.
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
                f"{self.path} cannot be written: {error.strerror}",
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
        text = json.dumps(schema, allow_nan=False)
        identity = self._writer.register_schema(name, "jsonschema", text.encode())
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
        """Keep an event until the next record gives it its time."""
        if event["event"] == "restart" and "clock_zero_s" in event:
            self._zero_ns = _nanoseconds(event["clock_zero_s"])
        self._waiting.append(event)

    def _write_events(self) -> None:
        for event in self._waiting:
            self._write(self._events, event, event["tick"])
        self._waiting.clear()

    def _write(self, channel: int, message: dict[str, Any], tick: int) -> None:
        data = json.dumps(message, allow_nan=False, separators=(",", ":")).encode()
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
    """Add the file's name to the OSError of a disk that is full or fails."""
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        raise


def _nanoseconds(seconds: float) -> int:
    return round(seconds * 1e9)


def play(path: str | Path, tap: Tap) -> tuple[dict[str, Any], bool]:
    """Feed a tap with the stream in a file, as far as the file can be read.

    Returns:
        The log's info, and whether the file is whole.

    Raises:
        LogError: The file cannot be opened, or is not a log of kickctl.
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
            except DAMAGE:
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
            raise ValueError("a value that is not a number")
        tap.take_records([Record(*values)])
    elif topic == EVENTS:
        tap.take_event(message)
