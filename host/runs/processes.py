"""Computes the cells of a run in processes, one for each core of this machine.

This is for work that runs on one thread, as MuJoCo does.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process, resource_tracker

from host.errors import NotDone
from host.runs.contract import Cell, Part, Parts, Setting
from host.util.interrupts import uninterrupted


def compute_in_processes(
    parts: Parts,
    cells: list[Cell],
    setting: Setting,
    begun: Callable[[Cell], Part | None] = lambda cell: None,
) -> Generator[tuple[Cell, Part]]:
    """Compute cells part by part.

    Args:
        parts: Computes a cell; a process asks it for one part at a time.
        cells: What to compute.
        setting: What the cells share.
        begun: Gives the complete parts of a cell. It has a part as soon as the next pair is asked
            for.

    Yields:
        (cell, its next part), in the order in which they are complete. Closing the generator ends
        all that still runs.

    Raises:
        NotDone: Something ended a process.
    """
    processes = min(len(os.sched_getaffinity(0)), len(cells))
    if processes < 2:
        yield from ((cell, part) for cell in cells for part in parts(cell, setting, begun(cell)))
        return
    others = set(active_children())
    # Spawned, because a fork would copy locks that other threads hold, but not the threads.
    pool = ProcessPoolExecutor(processes, get_context("spawn"), begin_process)

    def go_on(cell: Cell) -> Future[Part]:
        with beginning_processes():
            return pool.submit(_next_part, parts, cell, setting, begun(cell))

    try:
        running = {go_on(cell): cell for cell in cells}
        while running:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                cell, part = running.pop(future), future.result()
                yield cell, part
                if part.share < 1.0:
                    running[go_on(cell)] = cell
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


def _next_part(parts: Parts, cell: Cell, setting: Setting, begun: Part | None) -> Part:
    return next(parts(cell, setting, begun))


@contextmanager
def beginning_processes() -> Iterator[None]:
    """Begin processes whole in this block, and let no ^C end one in its first steps.

    They inherit that SIGINT is blocked; `begin_process` then ignores it.
    """
    # It unblocks SIGINT when it begins, which the first process would have it do below.
    resource_tracker.ensure_running()
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
