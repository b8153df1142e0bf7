"""Interrupts (^C, SIGTERM, SIGHUP of a closed terminal), held back while they could do harm."""

from __future__ import annotations

import signal
import threading
from importlib import import_module
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


# The functions below `signal`, without the enumerations that it makes of numbers: an embedded robot
# holds interrupts back in every tick, about twenty thousand times a second.
_functions: Any = import_module("_signal")


class _Held:
    """What the main thread, the only one that signals interrupt, holds back now."""

    def __init__(self) -> None:
        self.depth = 0
        self.kept: list[int] = []
        self.before: dict[int, Any] = {}

    def begin(self) -> None:
        """Hold back every signal that has a handler."""
        self.kept = []
        try:
            for number in SIGNALS:
                handler = _functions.getsignal(number)
                if callable(handler):
                    self.before[number] = handler
                    _functions.signal(number, self._keep)
            self.depth = 1
        except BaseException:  # an interrupt that came before all were held back
            self._restore()
            raise

    def end(self) -> None:
        """Hold back nothing any more, and hand the first on that came."""
        self.depth = 0
        self._restore()
        if self.kept:
            signal.raise_signal(self.kept[0])

    def _keep(self, number: int, frame: FrameType | None) -> None:
        self.kept.append(number)

    def _restore(self) -> None:
        try:
            for number in list(self.before):
                _functions.signal(number, self.before[number])
                del self.before[number]
        finally:
            if self.before:  # one that was handed on already interrupted this
                self._restore()


_held = _Held()


class uninterrupted:  # noqa: N801 - used as a function, and too often to be a generator
    """Hold back interrupts until the end of the block, for what must be done whole or not at all.

    An interrupt while compiled code is loaded would crash the interpreter, and one while a log is
    written would leave half a message in it. Blocks may be nested: the outermost one hands the
    first interrupt on, also when the block fails. Signals without a handler keep their effect.
    """

    __slots__ = ("_counts",)

    def __enter__(self) -> None:
        self._counts = threading.current_thread() is threading.main_thread()
        if self._counts and _held.depth:
            _held.depth += 1
        elif self._counts:
            _held.begin()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._counts and _held.depth > 1:
            _held.depth -= 1
        elif self._counts:
            _held.end()
