"""The index at the end of a log's file: what the file held when it was closed."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import IO, Any, NamedTuple

from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from mcap.records import Statistics

from host.logs.mcap_files import METADATA
from host.logs.messages import TICKS

MAGIC = b"\x89MCAP0\r\n"
# What mcap's readers raise for a file that breaks off or was damaged. A wrong checksum and wrong
# UTF-8 are ValueErrors.
DAMAGE = (McapError, struct.error, ValueError, RuntimeError, KeyError, OverflowError, MemoryError)
# The last records of the data and of the file: opcode, length, and their fields.
_DATA_END, _FOOTER = struct.Struct("<BQI"), struct.Struct("<BQQQI8s")
_DATA_END_OPCODE, _FOOTER_OPCODE = 0x0F, 0x02
_BLOCK = 1 << 20


class Index(NamedTuple):
    """What the end of a file says.

    Attributes:
        ticks: How many ticks the file was closed with.
        seconds: From its first message to its last (s).
        began_s: When its first message was, as the log's clock_zero_s makes it (Unix time, s).
        info: The log's info as text; empty if it cannot be read.
        intact: Whether the bytes before the index are those that were written, by their checksum.
    """

    ticks: int
    seconds: float
    began_s: float
    info: dict[str, str]
    intact: bool


def read_index(path: Path) -> Index | None:
    """Read the index of a file, and compare the checksums of all of the file.

    Args:
        path: The file.

    Returns:
        The index; None if there is none, or it is damaged itself.

    Raises:
        OSError: The file cannot be read.
    """
    try:
        with path.open("rb") as file:
            return _read(file)
    except DAMAGE:
        return None


def _read(file: IO[bytes]) -> Index | None:
    size = file.seek(0, 2)
    footer_at = size - _FOOTER.size
    file.seek(max(0, footer_at))
    opcode, _, begin, _, crc, magic = _FOOTER.unpack(file.read())
    if (opcode, magic) != (_FOOTER_OPCODE, MAGIC) or not _DATA_END.size < begin <= footer_at:
        return None
    # The checksum of the index covers the footer up to the checksum itself.
    if crc and crc != _checksum(file, begin, size - len(MAGIC) - 4):
        return None
    file.seek(0)
    reader = SeekingReader(file)
    summary = reader.get_summary()
    if summary is None or summary.statistics is None:
        return None
    file.seek(begin - _DATA_END.size)
    opcode, _, crc = _DATA_END.unpack(file.read(_DATA_END.size))
    intact = opcode == _DATA_END_OPCODE and crc in (
        0,  # none was written
        _checksum(file, 0, begin - _DATA_END.size),
    )
    channels = [channel.id for channel in summary.channels.values() if channel.topic == TICKS]
    return _index(summary.statistics, channels, _info(reader), intact)


def _index(
    statistics: Statistics, channels: list[int], info: dict[str, str], intact: bool
) -> Index:
    counts = statistics.channel_message_counts
    ticks = sum(counts.get(channel, 0) for channel in channels)
    seconds = (statistics.message_end_time - statistics.message_start_time) / 1e9
    return Index(ticks, seconds, statistics.message_start_time / 1e9, info, intact)


def _info(reader: SeekingReader) -> dict[str, str]:
    items: Any = reader.iter_metadata()
    try:
        found: dict[str, dict[str, str]] = {item.name: item.metadata for item in items}
    except DAMAGE:
        return {}
    return found.get(METADATA, {})


def _checksum(file: IO[bytes], begin: int, end: int) -> int:
    """The CRC of a part of a file."""
    file.seek(begin)
    crc = 0
    while begin < end and (data := file.read(min(_BLOCK, end - begin))):
        crc = zlib.crc32(data, crc)
        begin += len(data)
    return crc
