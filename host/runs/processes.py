"""Simulates cells side by side on this machine's cores, each in a process of its own.

For what runs on one thread, as MuJoCo does.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context

from host.errors import NotDone
from host.runs.contract import Cell, Row, Setting


def side_by_side(
    simulate: Callable[[Cell, Setting], list[Row]], cells: list[Cell], setting: Setting
) -> Generator[tuple[Cell, list[Row]]]:
    """(cell, rows) as they are done. What is under way when the generator is closed is given up.

    Raises NotDone.
    """
    processes = min(len(os.sched_getaffinity(0)), len(cells))
    if processes < 2:
        yield from ((cell, simulate(cell, setting)) for cell in cells)
        return
    others = set(active_children())
    # Spawned, for a copy of this process would have threads' locks and no threads. ^C, which a
    # terminal sends to all, is for this one.
    pool = ProcessPoolExecutor(
        processes, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN)
    )
    try:
        futures = {pool.submit(simulate, cell, setting): cell for cell in cells}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as error:
        raise NotDone(
            "a process that simulated was ended from outside",
            "run the same command again; it may need more memory",
        ) from error
    finally:
        for process in set(active_children()) - others:
            process.terminate()
        pool.shutdown(cancel_futures=True)
