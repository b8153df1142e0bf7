"""Reads logs on disk as a stream, in little memory, as far as they can be read."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any

from mcap.records import Channel, Message, Metadata

from host.logs.mcap_chunks import Damage, read_items
from host.logs.mcap_files import FORMAT, METADATA, LogError
from host.logs.mcap_index import DAMAGE, MAGIC, Index, read_index
from host.logs.messages import EVENTS, NAMED, TICKS
from host.logs.tap import Event, Tap
from host.util.whole_files import is_stream
from robot.record import NAMES, Record

# MCAP has times of 64 bits, in ns.
_LATEST_S = 2**63 / 1e9
_NUMBERS = frozenset((int, float, bool))
_DAMAGED = "the log's file was damaged here"
_GIVE_OURS = "give a log that kickctl recorded; 'kickctl log list' shows those in ./logs"


class LogFile:
    """A log on disk.

    Args:
        path: The file; also an attribute.

    Attributes:
        info: What was run, as in Log.
        breaks_off: Whether the file ends before its end, or cannot be read from some place on.
        left_out: How many ticks and events were left out because they cannot be right, such as
            one with a number that is not finite.
        first_left_out: The first of them, in words; empty if there is none.
        last_tick: The last tick that was read; None before the first.
        ticks: How many ticks were read.
        skipped: How many ticks lie in the damaged places between those that were read.
        open_end: Whether the file's last part cannot be read.

    These, except `info`, are known at the end of `stream`.

    Raises:
        LogError: The file cannot be opened, or is not a log of kickctl.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._begin()
        found = (
            item.metadata
            for item in self._items()
            if isinstance(item, Metadata) and item.name == METADATA
        )
        metadata = next(found, None)
        if metadata is None:
            raise LogError(f"{self.path} is an MCAP file, but holds no log of kickctl", _GIVE_OURS)
        self.info = _info(self.path, metadata)
        self._begin()

    def _begin(self) -> None:
        self.__dict__.pop("_index", None)
        self.breaks_off = False
        self.left_out = 0
        self.first_left_out = ""
        self.last_tick: int | None = None
        self.ticks = 0
        self.skipped = 0
        self.open_end = False
        self._due: int | None = None  # the tick after those that were read or are known to be lost

    @property
    def whole(self) -> bool:
        """Whether all of the log was read. It is known at the end of `stream`."""
        return not self.breaks_off and not self.left_out

    @property
    def total(self) -> int | None:
        """How many ticks the file was closed with; None if it has no index that says so."""
        return None if self._index is None else self._index.ticks

    @property
    def lost(self) -> int | None:
        """How many of its ticks were not read; None if that is not known.

        It is known at the end of `stream`.
        """
        if self.whole:
            return 0
        total = self.total
        return None if total is None else total - self.ticks

    def damage(self) -> str:
        """What is missing, in words; empty if nothing is. It is known at the end of `stream`."""
        found = []
        if self.breaks_off:
            place = "at its beginning" if self.last_tick is None else f"after tick {self.last_tick}"
            lost = self.lost
            # Without an index nobody knows if anything follows: perhaps only the index is lost.
            gone = (
                "what may follow was not read"
                if lost is None
                else f"{lost:,} of {self.total:,} ticks are missing"
            )
            found.append(f"breaks off or is damaged {place}; {gone}")
        if self.left_out:
            more = f", and {self.left_out - 1} more" if self.left_out > 1 else ""
            found.append(f"{self.first_left_out} is left out{more}")
        return f"{self.path}: " + "; ".join(found) if found else ""

    def remedy(self) -> str:
        """The command that reads more of a damaged log than `stream` does."""
        return (
            f"kickctl log recover {shlex.quote(str(self.path))} also reads what is whole behind the"
            " damage, and writes it to a new log"
        )

    def stream(self, *, past_damage: bool = False) -> Iterator[Event | Record]:
        """Events and records in the order in which they came, as far as they can be read.

        Args:
            past_damage: Whether to go on behind damaged places. Each has an event `lost` then.

        Returns:
            An iterator of dictionaries (events) and Records.

        Raises:
            LogError: The file cannot be read any more.
        """
        self._begin()
        topics: dict[int, str] = {}
        items = self._items(past_damage)
        behind = False  # whether a damaged place comes before the next message
        # A damaged record may look like one that other programs wrote: then only the ticks show it.
        doubtful = past_damage and not (self._index and self._index.intact)
        try:
            for item in items:
                if isinstance(item, Damage):
                    behind = True
                elif isinstance(item, Channel):
                    topics[item.id] = item.topic
                elif isinstance(item, Message):
                    message = json.loads(item.data)
                    if past_damage and item.channel_id not in topics:  # its channel is lost
                        topics[item.channel_id] = EVENTS if "event" in message else TICKS
                    topic = topics[item.channel_id]
                    if doubtful and topic in (TICKS, EVENTS):
                        yield from self._mark_gap(message, behind)
                        behind = False
                    yield from self._take(topic, message)
        except DAMAGE:
            self.breaks_off = True
        finally:
            items.close()

    def _mark_gap(self, message: dict[str, Any], behind: bool) -> Iterator[Event]:
        """Yield the events for a damaged place before a message; none if no tick was in it."""
        tick, name = message["tick"], message.get("event", "")
        first = message["from"] if name == "lost" else tick
        due = first if self._due is None else self._due
        if name == "restart" or first < due:  # the robot's program has started again
            if behind or name != "restart":
                yield lost_event(due, due)
            if name != "restart":
                yield {"event": "restart", "tick": first, "reason": _DAMAGED}
        elif first > due or (behind and self._due is None):
            self.skipped += first - due
            yield lost_event(due, first)
        self._due = tick if name else tick + 1

    @cached_property
    def _index(self) -> Index | None:
        """The file's index, read once for each stream: that takes all of the file."""
        return read_index(self.path)

    def _take(self, topic: str, message: dict[str, Any]) -> Iterator[Event | Record]:
        """Yield the event or the record of a message; nothing for a topic of others."""
        if topic == TICKS:
            record = _record(message)
            if all(map(isfinite, record)):
                self.last_tick = record.tick
                self.ticks += 1
                yield record
            else:
                self._leave_out("tick", message)
        elif topic == EVENTS:
            if _not_finite(message):
                self._leave_out(f"the event {message['event']} of tick", message)
            else:
                yield message

    def _leave_out(self, what: str, message: dict[str, Any]) -> None:
        self.left_out += 1
        if not self.first_left_out:
            cause = f"{_not_finite(message)} is no finite number"
            self.first_left_out = f"{what} {message['tick']} ({cause})"

    def _items(self, past_damage: bool = False) -> Any:
        """Yield what is in the file, as `read_items` does, and note if it breaks off."""
        try:
            if self.path.exists() and not self.path.is_file() and not self.path.is_dir():
                raise LogError(
                    f"{self.path} is a pipe or a device, and a log is read more than once",
                    "save it to a file first",
                )
            with self.path.open("rb") as file:
                if file.read(len(MAGIC)) != MAGIC:
                    raise LogError(f"{self.path} is not an MCAP file", _GIVE_OURS)
                file.seek(0)
                size = self.path.stat().st_size
                for item in read_items(file, size, past_damage=past_damage):
                    if isinstance(item, Damage):
                        self.breaks_off = True
                        self.open_end = item.last
                    yield item
        except OSError as error:
            raise LogError(
                f"{self.path} cannot be read: {error.strerror}",
                "'kickctl log list' shows the logs there are",
            ) from None


def lost_event(first: int, end: int) -> Event:
    """The event of a gap in a log, as the robot sends it: ticks first to end - 1 are lost."""
    return {"event": "lost", "tick": end, "from": first, "reason": _DAMAGED}


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
    """Raise LogError if something else than a log is about to get a log's place or name.

    There is no second one of a log that is replaced, and nobody expects a table under its name.
    """
    path = Path(path)
    if path.suffix.lower() == ".mcap":
        raise LogError(f"{path} is the name of a log", "choose another ending than .mcap")
    if not path.is_file() or is_stream(path):
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
    info = {name: _from_text(text) for name, text in metadata.items() if name != "format"}
    # No checksum of its own protects this record, and what is written again needs a time.
    zero_s = info.get("clock_zero_s", 0.0)
    if not isinstance(zero_s, (int, float)) or not 0 <= zero_s < _LATEST_S:
        del info["clock_zero_s"]
    return info


def _from_text(text: str) -> Any:
    """A value of the info. A number that is not finite, which old logs may have, is unknown."""
    try:
        return json.loads(text, parse_constant=lambda name: None)
    except ValueError:
        return text


def _not_finite(value: Any, name: str = "") -> str:
    """The name of the first number in plain data that is not finite; empty if all are."""
    if isinstance(value, float):
        return "" if isfinite(value) else name
    if isinstance(value, dict):
        return next(filter(None, (_not_finite(part, key) for key, part in value.items())), "")
    if isinstance(value, list):
        return next(filter(None, (_not_finite(part, name) for part in value)), "")
    return ""


def _record(message: dict[str, Any]) -> Record:
    for name, words in NAMED.items():
        message[name] = words.index(message[name])
    values = [message[name] for name in NAMES]
    if not _NUMBERS.issuperset(map(type, values)):
        raise ValueError("a value that is not a number")
    return Record(*values)
