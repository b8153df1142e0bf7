"""Computes the cells of a run in processes, one for each core of this machine.

This is for work that runs on one thread, as MuJoCo does.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process

from host.errors import NotDone
from host.runs.contract import Cell, Row, Setting
from host.util.interrupts import uninterrupted


def compute_in_processes(
    simulate: Callable[[Cell, Setting], list[Row]], cells: list[Cell], setting: Setting
) -> Generator[tuple[Cell, list[Row]]]:
    """Yields (cell, rows) as they are complete. Closing the generator ends all that still runs.

    Raises NotDone.
    """
    processes = min(len(os.sched_getaffinity(0)), len(cells))
    if processes < 2:
        yield from ((cell, simulate(cell, setting)) for cell in cells)
        return
    others = set(active_children())
    # Spawned, because a fork would copy locks that other threads hold, but not the threads.
    pool = ProcessPoolExecutor(processes, get_context("spawn"), begin_process)
    try:
        with beginning_processes():
            futures = {pool.submit(simulate, cell, setting): cell for cell in cells}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as error:
        raise NotDone(
            "something ended a process of the simulation",
            "run the same command again, which resumes the run; it may need more memory. In a"
            " script of your own, what starts the run must stand below:"
            " if __name__ == '__main__':",
        ) from error
    finally:
        for process in set(active_children()) - others:
            process.terminate()
        pool.shutdown(cancel_futures=True)


@contextmanager
def beginning_processes() -> Iterator[None]:
    """Begin processes whole in this block, and let no ^C end one in its first steps.

    They inherit that SIGINT is blocked; `begin_process` then ignores it.
    """
    with uninterrupted():
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def begin_process() -> None:
    """Set a new process up.

    A terminal sends ^C to all processes; only the first one obeys it. If that is killed, nothing
    else ends the others, which wait for work.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    if (parent := parent_process()) is not None:
        parent.join()
        os._exit(1)
