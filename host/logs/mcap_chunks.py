"""What is in an MCAP file, in its order; behind a damaged place, from the next intact chunk on."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from mmap import ACCESS_READ, mmap
from typing import IO, Any

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Metadata
from mcap.stream_reader import breakup_chunk

from host.logs.mcap_index import DAMAGE, MAGIC

# A record begins with its opcode and length. In a chunk, 28 bytes of numbers follow, then the name
# of its compression.
_HEAD = struct.Struct("<BQ")
_COMPRESSION_AT = _HEAD.size + 28
_COMPRESSION = re.compile(rb"\x03\0\0\0lz4|\x04\0\0\0zstd")
_OPCODES = {int(opcode) for opcode in Opcode}
_PRIVATE_OPCODES = 0x80


class Damage:
    """Stands for a place that cannot be read.

    Attributes:
        last: Whether nothing that can be read follows.
    """

    def __init__(self, last: bool) -> None:
        self.last = last


def read_items(file: IO[bytes], size: int, *, past_damage: bool = False) -> Iterator[Any]:
    """Yield what a log needs of a file, with all checksums compared.

    Args:
        file: The file.
        size: Its length, bytes.
        past_damage: Whether to go on behind damaged places.

    Yields:
        Channels, messages and metadata, as mcap has them; Damage where something cannot be read.
    """
    good = 0
    while True:
        try:
            for opcode, content in _records(file, good, size):
                yield from _parse(opcode, content)
                good = file.tell()
            return
        except DAMAGE:
            found = _next_chunk(file, good) if past_damage else None
        yield Damage(last=found is None)
        if found is None:
            return
        good = found


def _records(file: IO[bytes], begin: int, size: int) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and content of each record. No record reads beyond its own end."""
    file.seek(begin)
    crc = 0
    if begin == 0:
        crc = zlib.crc32(file.read(len(MAGIC)))
    opcode = 0
    while opcode != Opcode.FOOTER:
        head = file.read(_HEAD.size)
        opcode, length = _HEAD.unpack(head)
        if length > size or (opcode not in _OPCODES and opcode < _PRIVATE_OPCODES):
            raise ValueError("no record begins here")
        content = file.read(length)
        if len(content) < length:
            raise ValueError("the file ends in a record")
        # The checksum of the data counts from the beginning of the file.
        if opcode == Opcode.DATA_END and begin == 0:
            (expected,) = struct.unpack_from("<I", content)
            if expected not in (0, crc):
                raise ValueError("the checksum of the data is wrong")
        crc = zlib.crc32(content, zlib.crc32(head, crc))
        yield opcode, content
    if file.read(len(MAGIC)) != MAGIC:
        raise ValueError("the file's end is not that of an MCAP file")


def _parse(opcode: int, content: bytes) -> list[Any]:
    """What a log needs of a record."""
    stream = ReadDataStream(BytesIO(content))
    if opcode == Opcode.CHUNK:
        return breakup_chunk(Chunk.read(stream), validate_crc=True)
    if opcode == Opcode.MESSAGE:
        return [Message.read(stream, len(content))]
    if opcode == Opcode.CHANNEL:
        return [Channel.read(stream)]
    if opcode == Opcode.METADATA:
        return [Metadata.read(stream)]
    return []


def _next_chunk(file: IO[bytes], begin: int) -> int | None:
    """Where the next compressed chunk begins whose checksum is right; None if there is none."""
    with mmap(file.fileno(), 0, access=ACCESS_READ) as data:
        for match in _COMPRESSION.finditer(data, begin):
            at = match.start() - _COMPRESSION_AT
            if at >= begin and data[at] == Opcode.CHUNK:
                begin_of_content = at + _HEAD.size
                end = begin_of_content + _HEAD.unpack_from(data, at)[1]
                if end <= len(data) and _is_intact(data[begin_of_content:end]):
                    return at
    return None


def _is_intact(content: bytes) -> bool:
    try:
        chunk = Chunk.read(ReadDataStream(BytesIO(content)))
        breakup_chunk(chunk, validate_crc=True)
    except DAMAGE:
        return False
    return bool(chunk.uncompressed_crc)  # without a checksum nobody knows
