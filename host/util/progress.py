"""How far a long work is, on standard error.

A bar with the time left on a terminal, a line now and then where there is none.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

# How often a log gets a line, s.
_LINE_S = 30.0


@contextmanager
def progress(what: str, total: float) -> Iterator[Callable[[float], None]]:
    """Yields a function that is told how much of `total` is done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield _lines(what, total, time.monotonic)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.0f}/{task.total:.0f}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done: bar.update(task, completed=done)


def _lines(what: str, total: float, clock: Callable[[], float]) -> Callable[[float], None]:
    """Writes a line, if the last is long ago.

    What was done at first, from an earlier run, says nothing about the pace.
    """
    began_s = told_s = clock()
    at_first: float | None = None

    def tell(done: float) -> None:
        nonlocal told_s, at_first
        at_first = done if at_first is None else at_first
        now_s = clock()
        if now_s - told_s >= _LINE_S and at_first < done < total:
            told_s = now_s
            left_s = (now_s - began_s) / (done - at_first) * (total - done)
            print(
                f"{what}: {done:.0f} of {total:.0f}, about {_words(left_s)} left",
                file=sys.stderr,
                flush=True,
            )

    return tell


def _words(seconds: float) -> str:
    return (
        f"{seconds:.0f} s"
        if seconds < 120.0
        else f"{seconds / 60:.0f} min"
        if seconds < 7200.0
        else f"{seconds / 3600:.1f} h"
    )
