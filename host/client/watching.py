"""Watch a robot: wait, record, and hand on what it sends, as its stream of records and events."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from math import inf
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakMethod

from host.client.connection import Connection
from host.client.listeners import Backlog, Listener, Records
from host.client.stream import Feed
from host.errors import NoLink
from host.link.names import name_at
from host.logs.tap import Span, Tap
from host.util.arguments import need_function, need_seconds, need_tap, wrong
from host.util.provenance import origin
from robot.record import Record

if TYPE_CHECKING:
    from host.logs.log import Log

LogT = TypeVar("LogT", bound=Tap)


class Watcher(Connection):
    """A connection that looks at the robot and follows its records and events.

    It needs no token.
    """

    def status(self) -> dict[str, Any]:
        """What the robot does now.

        Returns:
            state, reason, tick, parameters in force, battery (V), who controls it and for how long
            (s), and how punctual its ticks are.
        """
        return self.request("status")

    def identify(self) -> dict[str, Any]:
        """Have the robot show for 3 s which one it is: by its lights, a beep, or in words.

        It needs no token. The call does not wait until the robot is done.

        Returns:
            seconds: for how long it will still show itself. ways: how, of 'lights', 'beep' and
            'words' (on its program's standard error); empty for an embedded robot.
        """
        self._need_minor(2, "identify")
        return self.request("identify")

    def describe(self, table: str) -> list[dict[str, Any]]:
        """One of the robot's own tables.

        Args:
            table: 'params', 'channels' or 'commands'.

        Returns:
            The table's rows.
        """
        rows: list[dict[str, Any]] = self.request("describe", {"table": table})["table"]
        return rows

    def wait(self, seconds: float, until: Callable[[], bool] | None = None) -> bool:
        """Let time pass, as counted by the robot's records.

        Args:
            seconds: How long (s of the robot's time). It may be infinite if `until` is given.
            until: Ends the wait as soon as it returns True.

        Returns:
            Whether `until` has ended the wait.

        Raises:
            WrongUse: Nothing would end the wait.
            NoLink: The robot is gone, or sends no more records.
        """
        seconds = need_seconds("seconds", seconds)
        if until is not None:
            need_function("until", until, "a function without arguments")
        elif seconds == inf:
            raise wrong("seconds", seconds, "a number of seconds, or a function as `until`")
        self._subscribe()
        first = self.newest
        patience_s = self.answer_s + self.reconnect_s
        began = self.link.now()
        while until is None or not until():
            newest = self.newest
            if newest is not None:
                if first is None or newest.tick < first.tick:
                    first = newest
                if newest.t_s - first.t_s >= seconds:
                    return False
            self.pump(0.1)
            # Answers to heartbeats show that the robot is there, not that it sends records.
            due_since = max(began, self.stream.fed_s, self._opened_s)
            if self.link.now() - due_since > patience_s:
                raise NoLink(
                    "the robot sends no more records",
                    "is its program alive? `kickctl doctor` looks closer",
                )
        return True

    @property
    def newest(self) -> Record | None:
        """The latest record, None before the first."""
        recent = self.stream.recent
        return recent[-1] if recent else None

    def recent(self) -> list[Record]:
        """The latest records.

        Returns:
            About twelve seconds of records, oldest first.
        """
        return list(self.stream.recent)

    def record(self, seconds: float) -> Log:
        """Record the next `seconds`.

        Args:
            seconds: How long (s of the robot's time).

        Returns:
            The log, in memory.
        """
        from host.logs.log import Log

        return self._record(Log, seconds)

    def _record(self, make: Callable[[dict[str, Any]], LogT], seconds: float) -> LogT:
        seconds = need_seconds("seconds", seconds)
        span = Span(seconds, log := make(self.info()))
        try:
            self.add_tap(span)
            self.wait(inf, until=lambda: span.complete)
        finally:
            self.remove_tap(span)
        return log

    def recording(self) -> AbstractContextManager[Log]:
        """Record while other things are done: `with robot.recording() as log: ...`.

        Yields:
            The log, in memory; it grows until the end of the block.
        """
        from host.logs.log import Log

        return self._recording(Log)

    @contextmanager
    def _recording(self, make: Callable[[dict[str, Any]], LogT]) -> Iterator[LogT]:
        log = make(self.info())
        try:
            self.add_tap(log)
            yield log
        finally:
            self.remove_tap(log)

    def on_record(self, callback: Callable[[Record], object]) -> Listener:
        """Have a function called with every record from now on.

        With a real robot the callback runs in a thread of its own, so it may be slow: link, lease
        and stop do not wait for it. What it cannot take is dropped, the oldest first, and counted
        (`dropped`). An exception of the callback ends nothing, `sys.exit()` neither; it is counted
        (`failures`), and the first one is logged. The calls end with the connection; when the robot
        is gone for good, that is logged, and `error` says why. With sim:// the robot's time passes
        only within calls such as `wait`, and the callback runs within them, in the same thread,
        while the robot's time stands still. docs/listen.md has examples.

        Args:
            callback: Called with one Record at a time.

        Returns:
            The listener; its `close` ends the calls, as does leaving it as a `with` block.
        """
        need_function("callback", callback, "a function that takes a record")
        # The listener's thread lives as long as the connection; it must not keep it alive.
        listener = Listener(callback, WeakMethod(self._forget))
        self.add_tap(listener.backlog)
        if self.link.virtual:
            self.stream.after.append(listener.catch_up)
        else:
            self._endings.append(listener.finish)
            threading.Thread(target=listener.run, name="kickctl listener", daemon=True).start()
        return listener

    def records(self, seconds: float = inf) -> Records:
        """The records of the next `seconds`, one by one: `for record in robot.records(3): ...`.

        The loop may be slow: link, lease and stop do not wait for it. What it cannot take is
        dropped, the oldest first, and counted (`dropped`).

        Args:
            seconds: How long (s of the robot's time), by default for ever.

        Returns:
            An iterator of Records.
        """
        seconds = need_seconds("seconds", seconds)
        backlog = Backlog()
        self.add_tap(backlog)
        return Records(backlog, seconds, lambda until: self.wait(inf, until), self.remove_tap)

    def add_tap(self, tap: Tap) -> None:
        """Feed a tap with everything that the robot sends from now on.

        Args:
            tap: Has take_records(records) and take_event(event), which return at once.
        """
        need_tap(tap)
        with self._lock:
            self._subscribe()
            self.stream.add(tap)

    def remove_tap(self, tap: Tap) -> None:
        """Feed a tap no more.

        Args:
            tap: The tap; nothing happens if it is not fed.
        """
        with self._lock:
            self.stream.remove(tap)

    def pull(self, tap: Tap) -> None:
        """Feed a tap with everything that the robot's black box holds, up to now.

        Other taps get nothing of it, and nothing twice; what is new comes to them a little later.

        Args:
            tap: As for `add_tap`.
        """
        need_tap(tap)
        self._subscribe()
        feed = Feed(end=self.request("status")["tick"])
        feed.add(tap)
        try:
            with self._lock:
                self.stream.open(feed)
            self.wait(inf, until=lambda: feed.complete)
        finally:
            with self._lock:
                self.stream.close(feed)

    def info(self) -> dict[str, Any]:
        """What a log must say of its origin.

        Returns:
            Plain JSON data, as in `Log.info`.
        """
        info = origin(self.link.uri, self.hello, self.status(), self.clock_zero_s, self.started_utc)
        name = name_at(self.link.uri)
        return {"robot": name, **info} if name else info

    def _forget(self, listener: Listener) -> None:
        self.stream.remove(listener.backlog)
        with suppress(ValueError):
            self.stream.after.remove(listener.catch_up)
        with suppress(ValueError):
            self._endings.remove(listener.finish)

    def _subscribe(self) -> None:
        with self._lock:
            if self._broken is not None:
                raise self._broken
            if not self.stream.wanted:
                tick = self.request("subscribe")["tick"]
                if not self.stream.wanted:
                    self.stream.begin(tick, self.link.now())
