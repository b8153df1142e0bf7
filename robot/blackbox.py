"""The bounded record of the last minutes: each tick's values, and what changed the robot's course.

A client that lost its link catches up from here; one that was away for too long learns how much is
gone.
"""

from collections import deque

from robot.record import STRUCT
from robot.wire import EVENT, encode_json, encode_samples

DEFAULT_CAPACITY = 20000  # ten minutes of 30 ms ticks in 2.2 MB
JOURNAL_CAPACITY = 2000
FRAMES_KEPT = 16
# After how many events another copy of what is in force is kept: a snapshot replays fewer than
# these. A full journal has 125 copies, of about half a kB each.
EVENTS_PER_COPY = 16
# Bound once: each tick needs them.
_pack_into, _SIZE = STRUCT.pack_into, STRUCT.size


class Snapshot(object):
    """The parameters in force and the kick that acts, as plain data.

    Besides the wheels' states, a tick's outcome depends on these.

    Args:
        params: The values of the parameters by their names.
        kick: A robot.kicks.Kick as a dict, or None.
    """

    def __init__(self, params, kick=None):
        self.params = dict(params)
        self.kick = kick

    def copy(self):
        """A snapshot of the same moment."""
        return Snapshot(self.params, self.kick)

    def take(self, event):
        """Bring the snapshot past an event.

        Args:
            event: A dict, from the journal.
        """
        if event["event"] == "params":
            self.params.update(event["set"])
        elif event["event"] == "kick":
            self.kick = event["kick"]
        elif event["event"] in ("start", "stop", "hold", "fault"):
            self.kick = None

    def as_event(self, tick):
        """The snapshot as an event that precedes a tick's record.

        Args:
            tick: The tick's number.

        Returns:
            The event, a dict.
        """
        kick = self.kick
        if kick is not None and kick["begin"] + kick["ticks"] <= tick:
            kick = None
        return {"event": "snapshot", "tick": tick, "params": dict(self.params), "kick": kick}


class _Frames(object):
    """The frames that were encoded last: hosts at the same place of the record share them."""

    def __init__(self):
        self._kept = [(None, None)] * FRAMES_KEPT

    def get(self, place, encode):
        """What encode() returned for this place, which begins with a number."""
        slot = place[0] % FRAMES_KEPT
        if self._kept[slot][0] != place:
            self._kept[slot] = place, encode()
        return self._kept[slot][1]


class BlackBox(object):
    """The latest records, found by their tick's number, and the journal of events beside them.

    Args:
        params: The values of the parameters by their names, before the first event.
        capacity: How many records to hold.

    Attributes:
        next_tick: The number that the next record gets.
        next_event: The number that the next event gets.
    """

    def __init__(self, params, capacity=DEFAULT_CAPACITY):
        self.next_tick = 0
        self.next_event = 0
        self._capacity = capacity
        self._ring = bytearray(capacity * STRUCT.size)
        self._base = Snapshot(params)
        self._base_tick = 0
        self._journal = deque()
        self._latest = self._base.copy()
        self._copies = {}  # by the number of the first event that comes after them
        self._samples = _Frames()
        self._events = _Frames()

    @property
    def oldest_tick(self):
        """The first tick that can still be read, with all events since."""
        return max(self.next_tick - self._capacity, self._base_tick)

    def append(self, fields):
        """Keep a tick's record under the next number.

        Args:
            fields: The values of `robot.record.CHANNELS` after the tick's number.
        """
        tick = self.next_tick
        _pack_into(self._ring, tick % self._capacity * _SIZE, tick, *fields)
        self.next_tick = tick + 1

    def note(self, event, **details):
        """Put an event into the journal.

        Args:
            event: Its name.
            details: What else there is to say about it.

        Returns:
            The number of the first tick that it concerns, which is the next one to run.
        """
        entry = dict(details, event=event, tick=self.next_tick, number=self.next_event)
        self._journal.append((self.next_event, entry))
        self.next_event += 1
        self._latest.take(entry)
        if self.next_event % EVENTS_PER_COPY == 0:
            self._copies[self.next_event] = self._latest.copy()
        while (
            len(self._journal) > JOURNAL_CAPACITY
            or self._journal[0][1]["tick"] < self.next_tick - self._capacity
        ):
            number, dropped = self._journal.popleft()
            self._copies.pop(number, None)
            self._base.take(dropped)
            self._base_tick = dropped["tick"] + 1
        return self.next_tick

    def read(self, tick, count):
        """Packed records in a row.

        Args:
            tick: The number of the first.
            count: How many at most; there are fewer at the end of the ring, and of the record.

        Returns:
            The records, bytes.
        """
        start = tick % self._capacity
        count = min(count, self.next_tick - tick, self._capacity - start)
        return bytes(self._ring[start * STRUCT.size : (start + count) * STRUCT.size])

    def samples(self, tick, count, number):
        """Records in a row as a frame for the wire, encoded once for all who are at that place.

        Args:
            tick: The number of the first.
            count: How many at most.
            number: The number of the next event behind them.

        Returns:
            (count, frame): how many they are, and the frame, bytes.
        """

        def encode():
            records = self.read(tick, count)
            return len(records) // STRUCT.size, encode_samples(number, records)

        return self._samples.get((tick, count, number), encode)

    def event(self, number):
        """An event of the journal.

        Args:
            number: Its number.

        Returns:
            The event, a dict, or None if it has not happened or is no longer kept.
        """
        index = number - (self.next_event - len(self._journal))
        return self._journal[index][1] if 0 <= index < len(self._journal) else None

    def event_frame(self, number):
        """An event of the journal as a frame for the wire, encoded once.

        Args:
            number: Its number, of an event that `event` returns.

        Returns:
            The frame, bytes.
        """
        return self._events.get((number,), lambda: encode_json(EVENT, self.event(number)))

    def snapshot(self, tick):
        """What was in force before a tick.

        Args:
            tick: The tick's number.

        Returns:
            (number, event): the number of the first event that comes after the snapshot, and the
            snapshot as an event.
        """
        journal, oldest = self._journal, self.next_event - len(self._journal)
        # Ticks only rise, so halving finds the first event that is not before this tick.
        low, high = oldest, self.next_event
        while low < high:
            middle = (low + high) // 2
            if journal[middle - oldest][1]["tick"] < tick:
                low = middle + 1
            else:
                high = middle
        begin = max(oldest, low - low % EVENTS_PER_COPY)
        state = self._copies.get(begin, self._base).copy()
        for number in range(begin, low):
            state.take(journal[number - oldest][1])
        return low, state.as_event(tick)
