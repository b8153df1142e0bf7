"""Single keys from a terminal, which is as it was before when it is given back.

It is given back at the end, after an error or an interrupt, and while the program is suspended.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

from host.util.interrupts import uninterrupted

try:
    import termios
except ImportError:  # Windows
    termios = None  # type: ignore[assignment]

LOOK_S = 0.1
_ESCAPE = "\x1b"
_INPUT_MODES, _LOCAL_MODES, _CHARACTERS = 0, 3, 6


def why_no_keys() -> str:
    """Why there can be no keys here, in words; empty if there can."""
    if termios is None:
        return "this system has no terminals that give single keys"
    try:
        both = os.isatty(sys.stdin.fileno()) and os.isatty(sys.stdout.fileno())
    except (AttributeError, OSError, ValueError):  # closed, or not a file
        both = False
    return "" if both else "standard input and output are no terminal"


class KeyParser:
    """Takes keys from what a terminal sends, without arrows and others that send sequences.

    The sequence of the key Home has a 1 in it, and nobody who presses Home wants a kick. But a
    space is a space everywhere: it stops the robot.
    """

    def __init__(self) -> None:
        self._place = ""

    def take(self, data: bytes) -> Iterator[str]:
        """The keys in the next bytes."""
        for letter in data.decode("latin-1"):
            if letter == " ":
                self._place = ""
                yield letter
            elif letter == _ESCAPE:
                self._place = _ESCAPE
            elif self._place == _ESCAPE:
                self._place = "[" if letter in "[O" else ""
            elif self._place:
                if "@" <= letter <= "~":
                    self._place = ""
            else:
                yield letter


class _Terminal:
    """Reads keys in a thread, while this program is in the terminal's foreground."""

    def __init__(
        self,
        descriptor: int,
        press: Callable[[str], None],
        rest: Callable[[], None],
        go_on: Callable[[], None],
    ) -> None:
        self._descriptor = descriptor
        self._press = press
        self._rest = rest
        self._go_on = go_on
        self._before: list[Any] | None = None  # the modes, while the terminal is taken
        self._resting = threading.Event()
        self._ended = threading.Event()
        self._lock = threading.RLock()
        self._handler: Any = None
        self._thread = threading.Thread(target=self._read, name="kickctl keys", daemon=True)

    def begin(self) -> None:
        if threading.current_thread() is threading.main_thread():
            self._handler = signal.signal(signal.SIGTSTP, self._suspend)
        with suppress(OSError, ValueError, termios.error):  # the thread tries again
            self._take()  # before anything is drawn that names keys
        self._thread.start()

    def end(self) -> None:
        self._ended.set()
        self._give_back()
        if self._handler is not None:
            signal.signal(signal.SIGTSTP, self._handler)
        if self._thread.ident is not None:
            self._thread.join()

    def _read(self) -> None:
        parser = KeyParser()
        while not self._ended.is_set():
            try:
                if not self._take():
                    self._ended.wait(LOOK_S)
                elif select.select([self._descriptor], [], [], LOOK_S)[0]:
                    data = os.read(self._descriptor, 64)
                    if not data:
                        return
                    for key in parser.take(data):
                        self._press(key)
            except (OSError, ValueError, termios.error):  # the terminal is gone
                return

    def _take(self) -> bool:
        """Have the terminal give single keys. Returns whether it does."""
        with self._lock:
            if self._ended.is_set() or self._resting.is_set() or not self._in_foreground():
                return False
            modes = termios.tcgetattr(self._descriptor)
            if modes[_LOCAL_MODES] & termios.ICANON:  # as at the beginning, or a shell changed it
                self._before = termios.tcgetattr(self._descriptor)
                modes[_LOCAL_MODES] &= ~(termios.ICANON | termios.ECHO)
                modes[_INPUT_MODES] &= ~termios.IXON  # ^S would hold up what is drawn
                characters = modes[_CHARACTERS]
                characters[termios.VMIN], characters[termios.VTIME] = 1, 0
                # ^\ would end the program without giving the terminal back.
                characters[termios.VQUIT] = os.fpathconf(self._descriptor, "PC_VDISABLE")
                termios.tcsetattr(self._descriptor, termios.TCSANOW, modes)
            return True

    def _give_back(self) -> None:
        with self._lock, suppress(OSError, termios.error):
            # In the background the terminal is another program's, and a change would suspend us.
            if self._before is not None and self._in_foreground():
                termios.tcsetattr(self._descriptor, termios.TCSANOW, self._before)
            self._before = None

    def _in_foreground(self) -> bool:
        try:
            return os.tcgetpgrp(self._descriptor) == os.getpgrp()
        except OSError:
            return True  # a terminal that controls no jobs

    def _suspend(self, number: int, frame: FrameType | None) -> None:
        """Answer ^Z: give the terminal back, sleep, and take it again."""
        self._resting.set()
        self._rest()
        self._give_back()
        signal.signal(number, signal.SIG_DFL)
        signal.raise_signal(number)  # until SIGCONT
        signal.signal(number, self._suspend)
        self._go_on()
        self._resting.clear()


@contextmanager
def keys(
    press: Callable[[str], None], rest: Callable[[], None], go_on: Callable[[], None]
) -> Iterator[None]:
    """Read single keys from standard input until the end of the block.

    Args:
        press: Called with each key, in a thread of its own. It returns at once.
        rest: Called before the program is suspended.
        go_on: Called when it goes on.
    """
    terminal = _Terminal(sys.stdin.fileno(), press, rest, go_on)
    try:
        with uninterrupted():
            terminal.begin()
        yield
    finally:
        with uninterrupted():
            terminal.end()
