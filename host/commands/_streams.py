"""Standard input, output and error of the command: none of them can end it in a traceback."""

from __future__ import annotations

import errno
import io
import os
import select
import sys
from contextlib import suppress
from typing import Any

# How errors name standard output, so that nobody takes those of a link or a log for it.
OUTPUT = "standard output"


class _Output(io.FileIO):
    """Standard output, which names itself in its errors, and waits where it must not block."""

    def write(self, data: Any) -> int:
        try:
            while (count := super().write(data)) is None:
                select.select([], [self], [])
        except OSError as error:
            error.filename = OUTPUT
            if error.errno == errno.EBADF:
                error.strerror = "it is closed"
            raise
        return count


class _Words(io.FileIO):
    """Drops what cannot be written: words for people are no reason to end what a robot does."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data) or len(data)
        except OSError:
            return len(data)


def prepare() -> None:
    r"""Make the three streams of this process usable.

    What stands in for a stream that was closed cannot be written. Otherwise a log could get its
    number, and Python would print the words for standard error on standard output. Letters that a
    terminal cannot show appear as codes like \xb0.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY)  # gets the lowest free number, which is this one
    sys.stdout = _stream(_Output, 1, sys.stdout)
    sys.stderr = _stream(_Words, 2, sys.stderr)


def _stream(kind: type[io.FileIO], number: int, before: Any) -> io.TextIOWrapper:
    """A text stream with the encoding of the one before it."""
    file = kind(number, "w", closefd=False)
    return io.TextIOWrapper(
        io.BufferedWriter(file),
        encoding="utf-8" if before is None else before.encoding,
        errors="backslashreplace",
        line_buffering=kind is _Words or file.isatty(),
    )


def drop_output() -> None:
    """Nobody reads standard output any more: send the interpreter's last flush to nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
