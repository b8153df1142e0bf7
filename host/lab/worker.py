"""A process of its own for long computations: neither a stop nor a page waits for them."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context
from typing import Any, TypeVar

from host.errors import KickctlError, NotDone
from host.lab.urgent import UrgentThread, stand_back
from host.runs.processes import begin_process, beginning_processes

Question = TypeVar("Question")
Answer = dict[str, Any] | KickctlError
Done = Callable[[Answer], None]

_beginning = threading.Lock()


class Worker:
    """Answers questions one after the other. The process begins with the first need, or `begin`.

    Args:
        does: What it does, for words, as in 'predicts kicks'.
        niceness: How far the robot, the page and others come before it, as `nice` counts it.
        warm_up: Compiles or loads what the answers need, in the process; None if the first
            question may do that.
    """

    def __init__(
        self, does: str, niceness: int, warm_up: Callable[[], object] | None = None
    ) -> None:
        self._does = does
        self._niceness = niceness
        self._warm_up = warm_up
        self._pool: ProcessPoolExecutor | None = None
        self._own: set[Any] = set()
        self._lock = threading.Lock()
        self._closed = False

    def begin(self) -> None:
        """Begin the process."""
        with self._lock:
            if self._pool is not None or self._closed:
                return
            with _beginning, beginning_processes():
                others = set(active_children())
                # Spawned, because a fork would copy locks that other threads hold.
                self._pool = ProcessPoolExecutor(1, get_context("spawn"), begin_process)
                # The pool's threads bring answers in, for which a stop must not wait.
                first = UrgentThread(target=self._pool.submit, args=(stand_back, self._niceness))
                first.start()
                first.join()
                self._own = set(active_children()) - others
            if self._warm_up is not None:
                self._pool.submit(self._warm_up)

    def ask(self, work: Callable[[Question], Answer], question: Question, done: Done) -> None:
        """Have a question answered in the process.

        Args:
            work: Answers it; a function of a module.
            question: What it takes.
            done: Gets the answer or the error. It is called in any thread, and must return at once.
        """
        self.begin()
        with self._lock:
            pool = self._pool
        future: Future[Answer]
        try:
            if pool is None:
                raise RuntimeError("it is closed")
            future = pool.submit(work, question)
        except RuntimeError:  # its process has died, or the lab ends
            future = Future()
            future.cancel()
        future.add_done_callback(lambda future: done(self._answer(pool, future)))

    def _answer(self, pool: ProcessPoolExecutor | None, future: Future[Answer]) -> Answer:
        try:
            return future.result()
        except (BrokenProcessPool, CancelledError):
            with self._lock:
                if self._pool is pool:
                    self._pool = None
            return NotDone(
                f"the process that {self._does} has ended", "try again: that starts a new one"
            )
        except Exception as error:  # the page that waits must hear of any failure
            logging.getLogger("kickctl").exception("the process that %s failed", self._does)
            return NotDone(f"the simulation failed: {error!r}"[:300], "please report this")

    def close(self) -> None:
        """End the process, also in the middle of a question."""
        with self._lock:
            self._closed = True
            pool, self._pool = self._pool, None
        if pool is not None:
            for process in self._own:
                process.terminate()
            pool.shutdown(cancel_futures=True)
