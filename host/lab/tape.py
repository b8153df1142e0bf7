"""A log as the page replays it: its records with all that is drawn and shown beside them.

A tape is plain data, and the same for a page that a lab serves and for a replay in one file. The
page calculates nothing: derived channels and the numbers of the equations come with each record.
"""

from __future__ import annotations

import base64
import gzip
from math import inf, isfinite
from typing import Any, NamedTuple

from host.errors import WrongUse, printable
from host.kicking.robot_motor import EV3
from host.lab import derived, worked
from host.lab.kicks import stall
from host.lab.steady_clock import SteadyClock
from host.lab.twin import Twin, compare_kicks, motors_of
from host.logs.log import Gaps, Log
from host.logs.mcap_files import LogError
from host.logs.mcap_reading import LogFile
from host.logs.replay import Mismatch, Replayer, other_sources, too_large
from host.logs.tap import Event
from robot.record import Record, describe
from robot.safety import RUNNING

# Ten minutes of 30 ms ticks: as many as the robot's black box holds, and about 10 MB.
MOST_TICKS = 20_000
_COMPRESSION = 6


class Cut(NamedTuple):
    """The part of a log that is wanted: from when to when, in s from its first tick."""

    from_s: float = 0.0
    to_s: float = inf

    def __str__(self) -> str:
        if self == Cut():
            return "all of it"
        return f"from {self.from_s:g} s to " + (
            "its end" if self.to_s == inf else f"{self.to_s:g} s"
        )


class _Writer:
    """Follows a log, and packs the ticks of a cut."""

    def __init__(self, name: str, info: dict[str, Any], cut: Cut, twin: Twin | None) -> None:
        self.clock = SteadyClock()
        self.replayer = Replayer(info)
        self.twin = twin
        self.pair: tuple[list[Record], list[Record]] = ([], [])
        self.packed_twin: list[bytes] = []
        self.packed: list[bytes] = []
        self.events: list[dict[str, Any]] = []
        self.gaps: list[dict[str, int]] = []
        self.past = False
        self._name = name
        self._cut = cut
        self._follower = derived.Follower()
        self._gaps = Gaps()
        self._waiting: list[Event] = []

    def take_event(self, event: Event) -> None:
        self._gaps.take(event)
        self.replayer.take(event)
        self._follower.take_event(event)
        if self.twin is not None:
            self.twin.take_event(event)
        if event["event"] == "restart":
            self.clock.restart()
        self._waiting.append(event)

    def take_record(self, record: Record) -> None:
        t_s = self.clock.read(record)
        since_s = t_s - (self.clock.begin_s or 0.0)
        if since_s > self._cut.to_s:
            self.past = True
            return
        if not self.packed and since_s >= self._cut.from_s:
            self.replayer.begin_part()
        known_gaps = len(self._gaps.found)
        self._gaps.take(record)
        numbers = self._work_out(record)
        values = self._follower.derive(record) or self._follower.without_speed(record)
        if since_s < self._cut.from_s:
            self._waiting.clear()
            if self.twin is not None:
                self.twin.pass_over(record, t_s)
            return
        if len(self.packed) == MOST_TICKS:
            raise too_long(self._name, self._cut)
        if not self.packed:
            self._note(self._follower.snapshot(record.tick))
        for first, end in self._gaps.found[known_gaps:]:
            self.gaps.append({"place": len(self.packed), "ticks": end - first})
        self.flush()
        # What the clock adds after a restart is 0 in all other logs: then the bits are the log's.
        shown = record._replace(t_s=t_s)
        own = derived.pack(shown, values)
        self.packed.append(own + worked.STRUCT.pack(*numbers))
        if self.twin is not None:
            twin, its_values = self.twin.take_record(shown, t_s)
            its_values = its_values or self.twin.without_speed(twin)
            self.packed_twin.append(derived.pack(twin, its_values))
            self.pair[0].append(shown)
            self.pair[1].append(twin)

    def flush(self) -> None:
        """Note the events that came before the next record."""
        for event in self._waiting:
            self._note(event)
        self._waiting.clear()

    def _note(self, event: Event) -> None:
        self.events.append({"place": len(self.packed), "event": event})

    def _work_out(self, record: Record) -> tuple[float, ...]:
        controller = self.replayer.controller
        before = [worked.Before.of(wheel) for wheel in controller.wheels]
        known, mismatches = self.replayer.take(record)
        running = record.state == RUNNING
        wheels = (
            worked.work_out(
                wheel, one if known else None, record, controller.params, controller.kick
            )
            if running
            else worked.OFF
            for wheel, one in zip(controller.wheels, before, strict=True)
        )
        compared = self._level(mismatches) if known or not running else worked.NOT_COMPARABLE
        return (compared, *(number for numbers in wheels for number in numbers))

    def _level(self, mismatches: list[Mismatch]) -> int:
        if not mismatches:
            return worked.SAME
        tolerance = self.replayer.result.tolerance
        small = all(abs(one.recorded - one.replayed) <= tolerance for one in mismatches)
        return worked.ROUNDED if small and tolerance else worked.OTHER


def make_tape(
    log: Log | LogFile, name: str, cut: Cut | None = None, motor: str | None = None
) -> dict[str, Any]:
    """Make the tape of a log.

    Args:
        log: In memory, or a file, which is read as a stream.
        name: What to call it on the page, such as its file's name.
        cut: Which part of it; None for all. What came before a cut is followed, so that the cut's
            first tick is known in full.
        motor: The entry of a motors file with which a simulated twin goes beside the robot; empty
            for that of the robot's own motors; None for no twin.

    Returns:
        Plain JSON data, see MESSAGES.md.

    Raises:
        WrongUse: The part has no tick, or more than MOST_TICKS; or nobody knows this motor, or the
            robot's own.
        LogError: The file cannot be read any more, or its numbers are too large to compute with.
    """
    cut = cut or Cut()
    total = log.total if isinstance(log, LogFile) else len(log)
    if total is not None and total > MOST_TICKS and cut == Cut():
        raise too_long(name, cut)
    entry, twin = (None, None) if motor is None else _twin(motor, log.info)
    writer = _Writer(name, log.info, cut, twin)
    for item in log.stream():
        if isinstance(item, dict):
            writer.take_event(item)
        else:
            try:
                writer.take_record(item)
            except OverflowError as error:
                raise too_large(item) from error
        if writer.past:
            break
    else:
        writer.flush()
    if not writer.packed:
        if isinstance(log, LogFile) and not log.whole and not writer.past:
            raise LogError(log.damage(), log.remedy())
        if cut == Cut():
            raise WrongUse(f"{name} has no tick", "`kickctl log list` shows logs and their ticks")
        raise WrongUse(
            f"{name} has no tick in this part: {cut}",
            "--from and --to count in s from its first tick; `kickctl log list` shows how long"
            " logs are",
        )
    return {
        "name": printable(name),
        "part": "" if cut == Cut() else str(cut),
        "ticks": len(writer.packed),
        "begin_s": writer.clock.begin_s,
        "robot": _robot(log.info),
        "facts": _facts(log.info),
        "events": writer.events,
        "gaps": writer.gaps,
        "verdict": _verdict(writer.replayer, log),
        "equations": {side: worked.lines_of(side) for side in ("left", "right")},
        "records": _written(writer.packed),
        "twin": None
        if writer.twin is None
        else {
            "motor": entry,
            "derived": describe(derived.CHANNELS),
            "kicks": compare_kicks(*writer.pair, writer.events),
            "records": _written(writer.packed_twin),
        },
    }


def _written(packed: list[bytes]) -> str:
    return base64.b64encode(gzip.compress(b"".join(packed), _COMPRESSION, mtime=0)).decode("ascii")


def _twin(motor: str, info: dict[str, Any]) -> tuple[str, Twin]:
    """The twin, and the entry of its motors."""
    entry, constants = motors_of(motor, str(info.get("motor", EV3)), "the log's robot")
    return entry, Twin(constants, info.get("battery_v"))


def too_long(name: str, cut: Cut) -> WrongUse:
    """Why a log cannot be replayed as a whole."""
    part = "" if cut == Cut() else f", {cut},"
    return WrongUse(
        f"{name}{part} has more than {MOST_TICKS:,} ticks, and a browser gets no more at once",
        "take a part of it: --from 0 --to 300 are its first five minutes",
    )


def _robot(info: dict[str, Any]) -> dict[str, Any]:
    """The robot as a page's welcome describes one."""
    place = derived.body()
    return {
        "name": printable(str(info.get("brick", ""))),
        "channels": describe(),
        "derived": describe((*derived.CHANNELS, *worked.CHANNELS)),
        "tick_s": info.get("params", {}).get("tick_s", 0.03),
        "stall": _stall(info),
        "track_m": place.track_m,
        "wheel_radius_m": place.wheel_radius_m,
        "walls": None,
        "hand": False,
    }


def _stall(info: dict[str, Any]) -> float | None:
    """The least |M| that moves a wheel from rest; None if the log does not say enough for it."""
    try:
        return stall({"motor": info["motor"]}, info["params"])
    except (KeyError, TypeError):
        return None


def _facts(info: dict[str, Any]) -> dict[str, str]:
    """What a person wants to know of a log's origin, in words; what is unknown is left out."""
    named = {
        "brick": info.get("brick"),
        "started_utc": str(info.get("started_utc", ""))[:19].replace("T", " "),
        "robot_software": info.get("robot_software"),
        "motor": info.get("motor"),
        "seed": info.get("seed"),
        "battery_v": info.get("battery_v"),
    }
    return {name: printable(str(value)) for name, value in named.items() if value not in (None, "")}


def _verdict(replayer: Replayer, log: Log | LogFile) -> dict[str, Any]:
    """What the replay found in the cut."""
    result = replayer.result
    return {
        "exact": result.exact,
        "reproduced": result.reproduced,
        "compared": result.compared,
        "not_comparable": result.not_comparable,
        "missing": result.missing,
        "worst": result.worst if isfinite(result.worst) else None,
        "first_mismatch": None if result.first is None else str(result.first),
        "other_sources": other_sources(log.info),
        "why_not_comparable": result.why_behind_gaps,
        "damage": log.damage() if isinstance(log, LogFile) else "",
    }
