"""Standard input, output and error of the command: none of them can end it in a traceback."""

from __future__ import annotations

import io
import os
import sys
from contextlib import suppress
from typing import Any


class _Lenient(io.FileIO):
    """Drops what cannot be written: words for people are no reason to end what a robot does."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data) or 0
        except OSError:
            return len(data)


def prepare() -> None:
    r"""Make the three streams of this process usable.

    A stream that was closed leads nowhere. Otherwise a log could get its number, and Python would
    print the words for standard error on standard output. Letters that a terminal cannot show
    appear as codes like \xb0.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest free number, which is this one
    if sys.stdout is None:
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    encoding = sys.stderr.encoding if sys.stderr is not None else "utf-8"
    words = io.BufferedWriter(_Lenient(2, "w", closefd=False))
    sys.stderr = io.TextIOWrapper(
        words, encoding=encoding, errors="backslashreplace", line_buffering=True
    )


def drop_output() -> None:
    """Nobody reads standard output any more: send the interpreter's last flush to nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
