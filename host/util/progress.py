"""The progress of long work, on standard error.

On a terminal this is a bar with the time left; elsewhere a line now and then.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

# The time between two lines, s.
_LINE_S = 30.0


@contextmanager
def progress(what: str, total: float) -> Iterator[Callable[[float], None]]:
    """Yields a function to call with how much of `total` is done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    console = Console(stderr=True)
    pace = _Pace(total, time.monotonic)
    if not console.is_terminal:
        yield _lines(what, total, pace, time.monotonic)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.0f}/{task.total:.0f}"),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=total, left="")
        yield lambda done: bar.update(task, completed=done, left=_words(pace.left_s(done)))


class _Pace:
    """Estimates the time left from the steps after the first step of this run.

    The first step also compiles and starts things, once; what an earlier run did says nothing about
    this one. Several processes end their first steps at about the same time, which looks too fast.
    So there is no estimate until the later steps took half as long as the first.
    """

    def __init__(self, total: float, clock: Callable[[], float]) -> None:
        self._total = total
        self._clock = clock
        self._begin_s = clock()
        self._at_start: float | None = None
        self._first: tuple[float, float] | None = None  # when the first step ended, and where

    def left_s(self, done: float) -> float | None:
        """The time left (s); None if it is not known yet. Call this at the end of every step."""
        now_s = self._clock()
        if self._at_start is None:
            self._at_start = done
        elif self._first is None and done > self._at_start:
            self._first = now_s, done
        if self._first is None:
            return None
        first_s, first_done = self._first
        if done <= first_done or now_s - first_s < (first_s - self._begin_s) / 2:
            return None
        return (now_s - first_s) / (done - first_done) * (self._total - done)


def _lines(
    what: str, total: float, pace: _Pace, clock: Callable[[], float]
) -> Callable[[float], None]:
    """Returns a function that writes a line if the last one is long ago."""
    last_s = clock()
    at_start: float | None = None

    def show(done: float) -> None:
        nonlocal last_s, at_start
        at_start = done if at_start is None else at_start
        now_s, left = clock(), _words(pace.left_s(done))
        if now_s - last_s >= _LINE_S and at_start < done < total:
            last_s = now_s
            words = f"{what}: {round(done, 1):g} of {total:.0f}" + (f", {left}" if left else "")
            print(words, file=sys.stderr, flush=True)

    return show


def _words(seconds: float | None) -> str:
    """The time left in words; empty if it is not known."""
    if seconds is None:
        return ""
    time_left = (
        f"{seconds:.0f} s"
        if seconds < 120.0
        else f"{seconds / 60:.0f} min"
        if seconds < 7200.0
        else f"{seconds / 3600:.1f} h"
    )
    return f"about {time_left} left"
