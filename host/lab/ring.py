"""The latest records of a robot in packed form, from which each page reads at its own place."""

from __future__ import annotations

import struct
import threading
from typing import NamedTuple

# Half a minute at the usual control period of 30 ms. Who is further behind gets the present.
CAPACITY = 1024
# How many records a page gets of what was before it came.
HISTORY = 600
# What stands before the records of a message, and how many there may be.
_HEADER, _RECORDS_KIND = struct.Struct("<BBHI"), 1
MOST_RECORDS = 256


class Portion(NamedTuple):
    """What a page gets: `missed` records were gone, then come `records` records in `data`.

    `place` is where the next portion begins.
    """

    missed: int
    records: int
    data: bytes
    place: int

    def message(self, robot: int) -> bytes:
        """The binary message of MESSAGES.md; `robot` is the index of the robot in the welcome."""
        return _HEADER.pack(_RECORDS_KIND, robot, self.records, self.missed) + self.data


class Ring:
    """Packed records by their place: the number of records that came before.

    One thread may append while others read.

    Args:
        size: The bytes of a packed record.
        capacity: How many records to hold.
    """

    def __init__(self, size: int, capacity: int = CAPACITY) -> None:
        self.end = 0
        self._size = size
        self._capacity = capacity
        self._bytes = bytearray(size * capacity)
        self._lock = threading.Lock()

    def append(self, packed: bytes) -> None:
        """Keep a packed record, and forget the oldest one if the ring is full."""
        if len(packed) != self._size:
            raise ValueError(f"a record has {self._size} bytes, not {len(packed)}")
        with self._lock:
            slot = self.end % self._capacity * self._size
            self._bytes[slot : slot + self._size] = packed
            self.end += 1

    def latest(self, count: int) -> int:
        """The place at which the latest `count` records begin, or fewer if there are fewer."""
        return max(0, self.end - min(count, self._capacity))

    @property
    def recent(self) -> int:
        """The place at which a page that comes now begins to read."""
        return self.latest(HISTORY)

    def read(self, place: int, most: int) -> Portion:
        """Records from a place on.

        Args:
            place: Where to begin; it must not lie behind the end.
            most: How many records at most.

        Returns:
            The portion; `records` is 0 if nothing new has come.
        """
        with self._lock:
            begin = max(place, self.end - self._capacity)
            count = min(most, self.end - begin)
            first = begin % self._capacity
            straight = min(count, self._capacity - first)
            size = self._size
            data = bytes(self._bytes[first * size : (first + straight) * size])
            data += bytes(self._bytes[: (count - straight) * size])
        return Portion(begin - place, count, data, begin + count)
