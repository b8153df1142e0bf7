"""Predictions of kicks, computed in a process of their own: neither a stop nor a page waits."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from host.errors import KickctlError, NotDone
from host.lab.worker import Answer, Done, Worker
from robot.record import Record
from sim_motor.constants import Constants

# How many questions may wait. Each takes about half a second of a core.
MOST_WAITING = 4
_NICENESS = 5


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
        self._worker = Worker("predicts kicks", _NICENESS, _warm_up)
        self.begin, self.close = self._worker.begin, self._worker.close
        self._waiting = 0
        self._lock = threading.Lock()

    def ask(self, question: Question, done: Done) -> None:
        """Predict a kick.

        Args:
            question: The kick, and what is known of the robot.
            done: Gets {shares, of}, see host.kicking.prediction.Prediction, or the error. It is
                called in any thread, and must return at once.
        """
        with self._lock:
            busy = self._waiting >= MOST_WAITING
            self._waiting += not busy
        if busy:
            done(NotDone("the simulation has too much to predict", "wait a moment, and try again"))
            return

        def answered(answer: Answer) -> None:
            with self._lock:
                self._waiting -= 1
            done(answer)

        self._worker.ask(_answer, question, answered)


def _warm_up() -> None:
    from host.kicking.prediction import warm_up

    warm_up()


def _answer(question: Question) -> dict[str, Any] | KickctlError:
    from host.kicking.prediction import predict

    try:
        return asdict(predict(*question))
    except KickctlError as error:
        return NotDone(error.message, error.hint)
