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
    """Returns a function that writes a line if the last one is long ago.

    The work that an earlier run did says nothing about the pace of this one.
    """
    start_s = last_s = clock()
    at_start: float | None = None

    def show(done: float) -> None:
        nonlocal last_s, at_start
        at_start = done if at_start is None else at_start
        now_s = clock()
        if now_s - last_s >= _LINE_S and at_start < done < total:
            last_s = now_s
            left_s = (now_s - start_s) / (done - at_start) * (total - done)
            print(
                f"{what}: {round(done, 1):g} of {total:.0f}, about {_words(left_s)} left",
                file=sys.stderr,
                flush=True,
            )

    return show


def _words(seconds: float) -> str:
    return (
        f"{seconds:.0f} s"
        if seconds < 120.0
        else f"{seconds / 60:.0f} min"
        if seconds < 7200.0
        else f"{seconds / 3600:.1f} h"
    )
