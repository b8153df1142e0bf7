"""Predictions of kicks, computed in a process of their own: neither a stop nor a page waits."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from multiprocessing import active_children, get_context
from typing import Any, NamedTuple

from host.errors import KickctlError, NotDone
from host.runs.processes import begin_process, beginning_processes
from robot.record import Record
from sim_motor.constants import Constants

# How many questions may wait. Each takes about half a second of a core.
MOST_WAITING = 4
_NICENESS = 5

Done = Callable[[dict[str, Any] | KickctlError], None]


class Question(NamedTuple):
    """What is known of a robot when a kick is to be predicted, as host.kicking.prediction takes it.

    kick: the request. The other fields: see there.
    """

    records: Sequence[Record]
    params: Mapping[str, Any]
    kick: Mapping[str, Any]
    motor: Constants
    battery_v: float | None


class Forecasts:
    """Answers questions one after the other. The process begins with the first need, or `begin`."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._others: set[Any] = set()
        self._waiting = 0
        self._lock = threading.Lock()
        self._closed = False

    def begin(self) -> None:
        """Begin the process, and compile or load there what predictions need."""
        with self._lock:
            if self._pool is not None or self._closed:
                return
            with beginning_processes():
                self._others = set(active_children())
                # Spawned, because a fork would copy locks that other threads hold.
                self._pool = ProcessPoolExecutor(1, get_context("spawn"), begin_process)
                self._pool.submit(_warm_up)

    def ask(self, question: Question, done: Done) -> None:
        """Predict a kick.

        Args:
            question: The kick, and what is known of the robot.
            done: Gets {shares, of}, see host.kicking.prediction.Prediction, or the error. It is
                called in any thread, and must return at once.
        """
        self.begin()
        with self._lock:
            pool = self._pool
            busy = self._waiting >= MOST_WAITING
            self._waiting += not busy
        if busy or pool is None:
            done(NotDone("the simulation has too much to predict", "wait a moment, and try again"))
            return
        try:
            future = pool.submit(_answer, question)
        except RuntimeError:  # its process has died, or the lab ends
            future = Future()
            future.cancel()
        future.add_done_callback(lambda future: self._end(pool, future, done))

    def _end(
        self,
        pool: ProcessPoolExecutor,
        future: Future[dict[str, Any] | KickctlError],
        done: Done,
    ) -> None:
        result: dict[str, Any] | KickctlError
        try:
            result = future.result()
        except (BrokenProcessPool, CancelledError):
            result = NotDone(
                "the process that predicts kicks has ended", "try again: that starts a new one"
            )
            with self._lock:
                if self._pool is pool:
                    self._pool = None
        except Exception as error:  # the page that waits must hear of any failure
            logging.getLogger("kickctl").exception("a kick could not be predicted")
            result = NotDone(f"the simulation failed: {error!r}"[:300], "please report this")
        with self._lock:
            self._waiting -= 1
        done(result)

    def close(self) -> None:
        """End the process, also in the middle of a prediction."""
        with self._lock:
            self._closed = True
            pool, self._pool = self._pool, None
        if pool is not None:
            for process in set(active_children()) - self._others:
                process.terminate()
            pool.shutdown(cancel_futures=True)


def _warm_up() -> None:
    from host.kicking.prediction import warm_up

    os.nice(_NICENESS)  # the robot and the page come first
    warm_up()


def _answer(question: Question) -> dict[str, Any] | KickctlError:
    from host.kicking.prediction import predict

    try:
        return asdict(predict(*question))
    except KickctlError as error:
        return NotDone(error.message, error.hint)
