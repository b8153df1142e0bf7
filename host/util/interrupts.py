"""Interrupts (^C, SIGTERM, SIGHUP of a closed terminal), held back while they could do harm."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold back interrupts until the end of the block, for what must be done whole or not at all.

    An interrupt while compiled code is loaded would crash the interpreter, and one while a log is
    written would leave half a message in it. Blocks may be nested: the outermost one hands the
    first interrupt on, also when the block fails. Signals without a handler keep their effect.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    kept: list[int] = []
    before: dict[int, Any] = {}
    try:
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if callable(handler):
                before[number] = handler
                signal.signal(number, lambda number, frame: kept.append(number))
        yield
    finally:
        for held, handler in before.items():
            signal.signal(held, handler)
        if kept:
            signal.raise_signal(kept[0])
