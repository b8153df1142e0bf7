"""Reads logs on disk as a stream, in little memory, as far as they can be read."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mcap.exceptions import McapError
from mcap.records import Channel, Message, Metadata
from mcap.stream_reader import StreamReader

from host.logs.mcap_files import EVENTS, FORMAT, METADATA, NAMED, TICKS, LogError
from host.logs.tap import Event, Tap
from robot.record import NAMES, Record

MAGIC = b"\x89MCAP0\r\n"
# What the reader raises for a file that breaks off or was damaged. A wrong checksum and wrong UTF-8
# are ValueErrors.
DAMAGE = (McapError, struct.error, ValueError, RuntimeError, KeyError, OverflowError, MemoryError)

_GIVE_OURS = "give a log that kickctl recorded; 'kickctl log list' shows those in ./logs"


class LogFile:
    """A log on disk.

    Args:
        path: The file; also an attribute.

    Attributes:
        info: What was run, as in Log.
        whole: Whether the file ends as it should. This is known at the end of `stream`; before, it
            is True.

    Raises:
        LogError: The file cannot be opened, or is not a log of kickctl.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.whole = True
        found = (
            item.metadata
            for item in self._items()
            if isinstance(item, Metadata) and item.name == METADATA
        )
        metadata = next(found, None)
        if metadata is None:
            raise LogError(f"{self.path} is an MCAP file, but holds no log of kickctl", _GIVE_OURS)
        self.whole = True
        self.info = _info(self.path, metadata)

    def stream(self) -> Iterator[Event | Record]:
        """Events and records in the order in which they came, up to where the file breaks off.

        Returns:
            An iterator of dictionaries (events) and Records.

        Raises:
            LogError: The file cannot be read any more.
        """
        topics: dict[int, str] = {}
        items = self._items()
        try:
            for item in items:
                if isinstance(item, Channel):
                    topics[item.id] = item.topic
                elif isinstance(item, Message):
                    yield from _event_or_record(topics[item.channel_id], json.loads(item.data))
        except DAMAGE:
            self.whole = False
        finally:
            items.close()

    def _items(self) -> Any:
        """Yield what is in the file, as mcap's reader gives it, and note if it breaks off."""
        self.whole = True
        try:
            with self.path.open("rb") as file:
                if file.read(len(MAGIC)) != MAGIC:
                    raise LogError(f"{self.path} is not an MCAP file", _GIVE_OURS)
                file.seek(0)
                size = self.path.stat().st_size
                try:
                    yield from StreamReader(
                        file, validate_crcs=True, record_size_limit=size
                    ).records
                except DAMAGE:
                    self.whole = False
        except OSError as error:
            raise LogError(
                f"{self.path} cannot be read: {error.strerror}",
                "'kickctl log list' shows the logs there are",
            ) from None


def play(path: str | Path, tap: Tap) -> tuple[dict[str, Any], bool]:
    """Feed a tap with the stream in a file, as far as the file can be read.

    Args:
        path: The file.
        tap: Has take_records(records) and take_event(event).

    Returns:
        The log's info, and whether the file is whole.

    Raises:
        LogError: The file cannot be opened, or is not a log of kickctl.
    """
    file = LogFile(path)
    for item in file.stream():
        if isinstance(item, dict):
            tap.take_event(item)
        else:
            tap.take_records([item])
    return file.info, file.whole


def require_no_log(path: str | Path) -> None:
    """Raise LogError if a file that is about to be replaced is a log: there is no second one."""
    path = Path(path)
    if not path.is_file():
        return
    try:
        with path.open("rb") as file:
            is_log = file.read(len(MAGIC)) == MAGIC
    except OSError:
        return  # who writes it will say why
    if is_log:
        raise LogError(f"{path} is a log, and logs are never overwritten", "choose another name")


def _info(path: Path, metadata: dict[str, str]) -> dict[str, Any]:
    if metadata.get("format") != FORMAT:
        raise LogError(
            f"{path} has log format {metadata.get('format')}, not {FORMAT}",
            "read it with the release that wrote it",
        )
    return {name: _from_text(text) for name, text in metadata.items() if name != "format"}


def _from_text(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def _event_or_record(topic: str, message: dict[str, Any]) -> Iterator[Event | Record]:
    """Yield the event or the record of a message; nothing for a topic of others."""
    if topic == TICKS:
        for name, words in NAMED.items():
            message[name] = words.index(message[name])
        values = [message[name] for name in NAMES]
        if not all(isinstance(value, (int, float)) for value in values):
            raise ValueError("a value that is not a number")
        yield Record(*values)
    elif topic == EVENTS:
        yield message
