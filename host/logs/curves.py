"""What pictures of a log need, read as a stream: some columns over time, kicks, and stops."""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.logs.tap import Event
from robot.blackbox import Snapshot
from robot.kicks import WHEELS
from robot.params import Params
from robot.record import NAMES, Record
from robot.safety import RUNNING

Array = NDArray[np.float64]

COLUMNS = tuple(
    f"{side}_{name}" for side in WHEELS for name in ("phi_rad", "x1", "x2", "torque", "duty_pct")
)
# The events that end a motion, and what they are called in a picture.
STOPS = {"stop": "stop", "fault": "fault", "restart": "restart of the robot's program"}
_PLACES = tuple(NAMES.index(name) for name in COLUMNS)


class ActingKick(NamedTuple):
    """A kick as it acted.

    Attributes:
        begin_s: When it began, s.
        end_s: When it ended or was stopped, s.
        kick: The kick as plain data, as in the log's event.
    """

    begin_s: float
    end_s: float
    kick: Event


class Curves(NamedTuple):
    """Columns of a log over time.

    Attributes:
        t_s: The time since the log's first record, s, (ticks,). A restart of the robot's program
            does not turn it back.
        tick: The number of each tick, (ticks,).
        a: The parameter a in each tick, without kicks, (ticks,).
        running: Whether the robot was running, (ticks,).
        params: The robot's parameters that stayed the same, without kicks, by name.
        values: The columns COLUMNS by name, each (ticks,).
        breaks: Before which rows ticks are missing, or the robot's program started again.
        kicks: The kicks that acted, oldest first.
        stops: (time s, one of STOPS) of each event that ended a motion.
    """

    t_s: Array
    tick: NDArray[np.int64]
    a: Array
    running: NDArray[np.bool_]
    params: dict[str, Any]
    values: dict[str, Array]
    breaks: list[int]
    kicks: list[ActingKick]
    stops: list[tuple[float, str]]


def curves(stream: Iterable[Event | Record]) -> Curves:
    """Read a log.

    Args:
        stream: A log's events and records, in their order. It is read once, and may be long: a tick
            takes about 100 bytes.

    Returns:
        Its columns.
    """
    reader = _Reader()
    for item in stream:
        if isinstance(item, dict):
            reader.take_event(item)
        else:
            reader.take_record(item)
    return reader.curves()


class _Reader:
    def __init__(self) -> None:
        self._numbers = {name: array("d") for name in ("t_s", "a", *COLUMNS)}
        self._ticks, self._running = array("q"), array("b")
        self._snapshot = Snapshot(Params().values())
        self._params: dict[str, set[Any]] = {}
        self._may_differ = True  # the parameters, from those of the record before
        self._waiting: list[Event] = []  # kicks that have not begun
        self._acting: list[tuple[float, Event]] = []
        self._kicks: list[ActingKick] = []
        self._stops: list[str] = []  # before the next record
        self._stopped: list[tuple[float, str]] = []
        self._breaks: list[int] = []
        self._zero_s: float | None = None  # of the robot's clock
        self._now_s = 0.0
        self._due: int | None = None

    def take_event(self, event: Event) -> None:
        name, self._may_differ = event["event"], True
        if name == "snapshot":
            self._snapshot = Snapshot(event["params"], event["kick"])
        else:
            self._snapshot.take(event)
        if name == "kick":
            self._waiting.append(event["kick"])
        elif name in STOPS:
            self._stops.append(name)
        if name == "restart":
            self._end_kicks()
            self._zero_s = self._due = None

    def take_record(self, record: Record) -> None:
        if self._zero_s is None:
            # After a restart nobody knows how long the robot was away: time goes on with a tick.
            self._now_s += record.dt_s if self._ticks else 0.0
            self._zero_s = record.t_s - self._now_s
        self._now_s = record.t_s - self._zero_s
        if self._ticks and record.tick != self._due:
            self._breaks.append(len(self._ticks))
        self._due = record.tick + 1
        if self._may_differ:
            for name, value in self._snapshot.params.items():
                self._params.setdefault(name, set()).add(value)
            self._may_differ = False
        self._follow_kicks(record)
        self._stopped += [(self._now_s, name) for name in self._stops]
        self._stops.clear()
        self._ticks.append(record.tick)
        self._running.append(record.state == RUNNING)
        for name, value in zip(
            ("t_s", "a", *COLUMNS),
            (self._now_s, self._snapshot.params["a"], *(record[place] for place in _PLACES)),
            strict=True,
        ):
            self._numbers[name].append(value)

    def _follow_kicks(self, record: Record) -> None:
        if not record.kick:
            self._end_kicks()
        for begun in [one for one in self._acting if record.tick >= _end(one[1])]:
            self._acting.remove(begun)
            self._kicks.append(ActingKick(begun[0], self._now_s, begun[1]))
        for kick in [kick for kick in self._waiting if kick["begin"] <= record.tick]:
            self._waiting.remove(kick)
            if record.kick and record.tick < _end(kick):
                self._acting.append((self._now_s, kick))

    def _end_kicks(self) -> None:
        self._kicks += [ActingKick(begin_s, self._now_s, kick) for begin_s, kick in self._acting]
        self._acting.clear()

    def curves(self) -> Curves:
        self._end_kicks()
        self._stopped += [(self._now_s, name) for name in self._stops]
        numbers = {name: np.array(values) for name, values in self._numbers.items()}
        return Curves(
            numbers.pop("t_s"),
            np.array(self._ticks),
            numbers.pop("a"),
            np.array(self._running, dtype=bool),
            {name: value for name, (value, *more) in self._params.items() if not more},
            numbers,
            self._breaks,
            sorted(self._kicks, key=lambda one: one.begin_s),
            self._stopped,
        )


def _end(kick: Event) -> int:
    return int(kick["begin"] + kick["ticks"])
