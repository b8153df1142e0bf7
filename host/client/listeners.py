"""Live records for programs: callbacks and iterators that the link never waits for."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable, Iterator
from typing import Self
from weakref import WeakMethod

from host.errors import KickctlError
from host.logs.tap import Event
from host.util.callbacks import failure_of
from robot.record import Record

# How many records a listener may fall behind, a minute of ticks, before it loses the oldest.
BACKLOG_RECORDS = 2000


class Backlog:
    """A tap that keeps records until somebody takes them, at most `length`.

    What does not fit pushes out the oldest; `dropped` counts what was lost so.
    """

    def __init__(self, length: int = BACKLOG_RECORDS) -> None:
        self.dropped = 0
        self._length = length
        self._records: deque[Record] = deque()
        self._changed = threading.Condition()
        self._ended = False

    def __len__(self) -> int:
        return len(self._records)

    def take_records(self, records: list[Record]) -> None:
        """Keep records; never waits."""
        with self._changed:
            if self._ended:  # the link's thread had these in its hands
                return
            self._records.extend(records)
            while len(self._records) > self._length:
                self._records.popleft()
                self.dropped += 1
            self._changed.notify()

    def take_event(self, event: Event) -> None:
        """Events are no records."""

    def get(self) -> Record | None:
        """The oldest record, None if there is none now."""
        with self._changed:
            return self._records.popleft() if self._records else None

    def wait(self) -> Record | None:
        """The oldest record, as soon as there is one; None when no more will come."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._records)
            return self._records.popleft() if self._records else None

    def finish(self) -> None:
        """No more records will come; those that are there can still be taken."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def end(self) -> None:
        """Let nobody wait any longer, and give nobody what is left."""
        with self._changed:
            self._records.clear()
            self.finish()


class Listener:
    """A callback that is called with every record; what `Robot.on_record` returns.

    >>> speeds = []
    >>> with connect("sim://", seed=1) as robot:
    ...     with robot.on_record(lambda record: speeds.append(record.left_duty_pct)) as listener:
    ...         robot.wait(1)
    False
    >>> len(speeds), listener.dropped, listener.failures
    (34, 0, 0)

    Attributes:
        failures: How often the callback has raised an exception. The first one is logged.
        error: The latest exception that it has raised; when the robot is gone for good, why.
    """

    def __init__(
        self,
        callback: Callable[[Record], object],
        forget: WeakMethod[Callable[[Listener], None]],
    ) -> None:
        self.failures = 0
        self.error: BaseException | None = None
        self.backlog = Backlog()
        self._callback = callback
        self._forget = forget
        self._calling = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        name = getattr(self._callback, "__qualname__", repr(self._callback))
        return f"<Listener {name}: {self.dropped} records dropped, {self.failures} failures>"

    @property
    def dropped(self) -> int:
        """How many records the callback was too slow to take."""
        return self.backlog.dropped

    def close(self) -> None:
        """Call the callback no more."""
        forget = self._forget()
        if forget is not None:
            forget(self)
        self.backlog.end()

    def finish(self, why: KickctlError | None) -> None:
        """Have the calls end when those that wait are done, since no more records will come.

        Args:
            why: What has happened to the robot; None if its connection was closed.
        """
        if why is not None:
            self.error = why
            logging.getLogger("kickctl").error("on_record ends: %s", why)
        self.backlog.finish()

    def run(self) -> None:
        """Call the callback with what comes, until `close`."""
        while (record := self.backlog.wait()) is not None:
            self._call(record)

    def catch_up(self) -> None:
        """Call the callback with what is there. Does nothing when called from the callback.

        A callback that lets the robot's time pass makes new records. It gets them the next time, so
        that whoever waits for the robot does not wait for ever.
        """
        if self._calling:
            return
        self._calling = True
        try:
            left = len(self.backlog)
            while len(self.backlog) <= left and (record := self.backlog.get()) is not None:
                left = len(self.backlog)
                self._call(record)
        finally:
            self._calling = False

    def _call(self, record: Record) -> None:
        error = failure_of(lambda: self._callback(record))
        if error is not None:
            self.failures += 1
            self.error = error
            if self.failures == 1:
                logging.getLogger("kickctl").error(
                    "a callback of on_record failed; the robot and the link go on", exc_info=error
                )


class Records(Iterator[Record]):
    """The records of a robot as they come; what `Robot.records` returns.

    >>> with connect("sim://", seed=1) as robot:
    ...     for record in robot.records(0.1):
    ...         print(record.tick, round(record.left_phi_rad, 2))
    3 6.07
    4 6.28
    5 6.51
    6 6.79
    7 7.09

    It ends after the given time of the robot. `close` ends it early.
    """

    def __init__(
        self,
        backlog: Backlog,
        seconds: float,
        wait_for: Callable[[Callable[[], bool]], object],
        forget: Callable[[Backlog], None],
    ) -> None:
        self._backlog = backlog
        self._seconds = seconds
        self._wait_for = wait_for
        self._forget = forget
        self._first: Record | None = None
        self._ended = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def __next__(self) -> Record:
        if self._ended:
            raise StopIteration
        record = self._backlog.get()
        while record is None:
            self._wait_for(lambda: len(self._backlog) > 0)
            record = self._backlog.get()
        if self._first is None or record.tick < self._first.tick:
            self._first = record
        if record.t_s - self._first.t_s >= self._seconds:
            self.close()
        return record

    @property
    def dropped(self) -> int:
        """How many records the loop was too slow to take."""
        return self._backlog.dropped

    def close(self) -> None:
        """Take no more records."""
        if not self._ended:
            self._ended = True
            self._forget(self._backlog)
