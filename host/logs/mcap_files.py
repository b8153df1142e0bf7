"""Logs on disk: MCAP files with JSON schemas, which read back bit for bit.

Foxglove, Lichtblick and PlotJuggler open them. A file holds the metadata record `kickctl` (the
log's info: text as it is, anything else as JSON), the channel /ticks with one message a tick, and
the channel /events. Messages have the order of the robot's stream; an event has the log time of the
record that follows it. A chunk is closed and given to the operating system for every second of
robot time. A process that is killed loses what came after the last whole chunk; the rest reads
without the end of the file, and `kickctl log recover` gives it an index again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, Self

from mcap.writer import CompressionType, Writer

from host.errors import WrongUse
from host.logs.messages import SCHEMAS, Message, Messages, nanoseconds
from host.logs.tap import Event
from host.util.interrupts import uninterrupted
from host.util.whole_files import FileTaken, is_stream, naming, require_text, whole_file
from robot import __version__
from robot.record import Record

METADATA = "kickctl"
FORMAT = "1"
CHUNK_S = 1.0
# Files of other kinds, which programs would try to read as such.
_OTHER_ENDINGS = (
    *(".csv", ".npz", ".parquet", ".json", ".txt", ".tsv", ".xlsx"),
    *(".png", ".svg", ".gif", ".mp4"),
)


class LogError(WrongUse):
    """A log cannot be written or read.

    >>> try:
    ...     Log.load("missing.mcap")
    ... except LogError as error:
    ...     print(error)
    missing.mcap cannot be read: No such file or directory
    """


class NameTaken(LogError):
    """There is a file of this name already."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"{path} exists already, and logs are never overwritten", "choose another name"
        )


def require_new_log(path: Path) -> None:
    """Raise LogError if no log can have this name: it is taken, or that of another kind of file.

    Raise WrongUse if its name cannot be typed.
    """
    require_text(path)
    if path.suffix.lower() in _OTHER_ENDINGS:
        raise LogError(
            f"{path} would be a log, an MCAP file, under the name of another kind of file",
            "end its name with .mcap; `kickctl log export` makes a table of it",
        )
    if os.path.lexists(path) and not is_stream(path):
        raise NameTaken(path)


def _to_text(value: Any) -> str:
    """Text as it is unless it would read back as something else; everything else as JSON."""
    if isinstance(value, str):
        try:
            json.loads(value)
        except ValueError:
            return value
    return json.dumps(value, allow_nan=False)


class McapTap:
    """A Tap, and context manager, that writes a file while the stream arrives.

    Args:
        path: The log's file; also an attribute. It is created, and must not exist.
        info: What was run, as in Log. Its clock_zero_s turns the robot's clock into UTC; after a
            `restart` event, that of the event does.
        file: A new file that is open already, to be written instead.

    Raises:
        NameTaken: The file exists already.
        LogError: The file cannot be created.
        OSError: The disk is full or fails, now or later; the error names the file. If it fails now,
            no file is left.
    """

    def __init__(
        self, path: str | Path, info: dict[str, Any], file: IO[bytes] | None = None
    ) -> None:
        self.path = Path(path)
        self._file = file or _create(self.path, self.path)
        zero_s = info.get("clock_zero_s", 0.0)
        self._messages = Messages(zero_s)
        self._chunk_ns = nanoseconds(zero_s)
        self._channels: dict[str, int] = {}
        self._writer: Any = Writer(
            self._file, compression=CompressionType.LZ4, enable_data_crcs=True
        )
        try:
            with uninterrupted(), naming(self.path):
                self._begin(info)
        except BaseException:
            with suppress(OSError):
                self._file.close()
            if file is None:  # a log without its beginning is of no use
                with suppress(OSError):
                    self.path.unlink()
            raise

    def _begin(self, info: dict[str, Any]) -> None:
        """Write what stands before the first record."""
        self._writer.start(library=f"kickctl {__version__}")
        self._writer.add_metadata(
            METADATA, {"format": FORMAT, **{name: _to_text(value) for name, value in info.items()}}
        )
        for topic, schema in SCHEMAS.items():
            identity = self._writer.register_schema(schema.name, "jsonschema", schema.data)
            self._channels[topic] = self._writer.register_channel(topic, "json", identity)
        self._writer.flush()
        self._file.flush()

    def take_records(self, records: list[Record]) -> None:
        """Write records, and the events that waited for the first of them."""
        with uninterrupted(), naming(self.path):
            for record in records:
                self._take(record)

    def _take(self, record: Record) -> None:
        messages = self._messages.take_record(record)
        self._write(messages)
        now_ns = messages[-1].time_ns
        if abs(now_ns - self._chunk_ns) >= CHUNK_S * 1e9:
            self._writer.flush()
            self._chunk_ns = now_ns

    def take_event(self, event: Event) -> None:
        """Keep an event until the next record gives it its time."""
        self._messages.take_event(event)

    def _write(self, messages: list[Message]) -> None:
        for topic, time_ns, tick, data in messages:
            self._writer.add_message(self._channels[topic], time_ns, data, time_ns, tick)

    def close(self) -> None:
        """Write what waits and the file's index. Once is enough, more does no harm."""
        if self._file.closed:
            return
        with uninterrupted(), naming(self.path), self._file:
            self._write(self._messages.rest())
            self._writer.finish()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@contextmanager
def new_log(path: str | Path, info: dict[str, Any]) -> Iterator[McapTap]:
    """A tap whose file appears under its name at the end of the block, if that ends well.

    Args:
        path: The log's file, which must not exist.
        info: What was run, as in Log.

    Yields:
        The tap.

    Raises:
        NameTaken: The file exists already.
        LogError: The file cannot be created.
        OSError: The disk fails later; the error names the file.
    """
    path = Path(path)
    try:
        with (
            whole_file(path, new=True) as draft,
            _create(draft, path) as file,
            McapTap(path, info, file) as tap,
        ):
            yield tap
    except (FileTaken, IsADirectoryError):
        raise NameTaken(path) from None


def _create(place: Path, path: Path) -> IO[bytes]:
    """Create the file of the log `path` in a place, and open it."""
    require_new_log(path)
    try:
        return place.open("xb")
    except FileExistsError:
        raise NameTaken(path) from None
    except OSError as error:
        if path.is_dir():
            raise NameTaken(path) from None
        raise LogError(
            f"{path} cannot be written: {error.strerror}",
            "choose a folder that is there, and that you may write to",
        ) from None
