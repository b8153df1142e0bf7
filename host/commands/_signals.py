"""What ends a command from outside: ^C, SIGTERM, and a terminal that closes (SIGHUP)."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from types import FrameType

from host.util.interrupts import SIGNALS

# How long one interrupt makes deaf to others (s). Who still waits then can interrupt again.
DEAF_S = 2.0


class Interrupts:
    """Turns signals into KeyboardInterrupt.

    Attributes:
        came: Whether a signal has interrupted the command.
    """

    def __init__(self) -> None:
        self.came = False
        self._deaf_until = -inf

    def rest(self) -> None:
        """Ignore all signals from now on: what the command says of its end is said whole."""
        self._deaf_until = inf

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Interrupt, unless that has just happened.

        A closing terminal often sends its signal twice, and an impatient person ^C five times.
        """
        now = time.monotonic()
        if now >= self._deaf_until:
            self._deaf_until = now + DEAF_S
            self.came = True
            raise KeyboardInterrupt

    def repeat_lost(self, lost: sys.UnraisableHookArgs) -> None:
        """Interrupt again if an interrupt came within a destructor, where Python drops it."""
        if lost.exc_type is not KeyboardInterrupt:
            sys.__unraisablehook__(lost)
        elif self._deaf_until < inf:
            self._deaf_until = -inf
            again = threading.Timer(0.05, _thread.interrupt_main)
            again.daemon = True
            again.start()


@contextmanager
def interruptible(*, process_ends: bool) -> Iterator[Interrupts]:
    """Let SIGTERM and SIGHUP do what ^C does, so that robots stop and logs are closed.

    Who ignores one of them, as nohup does, goes on ignoring it.

    Args:
        process_ends: Whether nothing comes after the block. Then no signal can disturb the end.

    Yields:
        What turns signals into interrupts.
    """
    interrupts = Interrupts()
    hook, sys.unraisablehook = sys.unraisablehook, interrupts.repeat_lost
    before = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for number in SIGNALS:
                if signal.getsignal(number) is not signal.SIG_IGN:
                    before[number] = signal.signal(number, interrupts.handle)
        yield interrupts
    finally:
        interrupts.rest()
        for number, handler in before.items():
            signal.signal(number, signal.SIG_IGN if process_ends else handler)
        sys.unraisablehook = hook
