"""Recompute the controller from the logged angles and delta t, and compare exactly.

The robot's own code computes: robot.wheel.Wheel, robot.safety.limit_duty, and the black box's way
to follow parameters and kicks through the log's events.
"""

from __future__ import annotations

import platform
from collections.abc import Iterator
from dataclasses import dataclass, replace
from operator import attrgetter
from struct import pack
from typing import Any

from host.errors import NotDone
from host.logs.log import Gaps, Log
from host.logs.mcap_files import LogError
from host.logs.mcap_reading import LogFile
from host.logs.tap import Event
from host.util.provenance import sources
from robot.blackbox import Snapshot
from robot.kicks import WHEELS, Kick
from robot.params import Params
from robot.record import Record
from robot.safety import FAULT, RUNNING, limit_duty
from robot.sources import of_robot
from robot.wheel import Wheel

# Another machine's libm may round sin, cos, exp and tanh differently in the last bit.
OTHER_MACHINE_TOLERANCE = 1e-12
# What a replay computes anew of each wheel.
_COMPUTED = ("x1", "x2", "force", "torque", "duty_pct")
_RECORDED = {side: attrgetter(*(f"{side}_{name}" for name in _COMPUTED)) for side in WHEELS}


@dataclass(frozen=True)
class Mismatch:
    """A channel of a tick that the replay computed differently."""

    tick: int
    channel: str
    recorded: float
    replayed: float

    def __str__(self) -> str:
        where = f"{self.channel} of tick {self.tick}"
        return f"{where} is {self.recorded!r} in the log and {self.replayed!r} in the replay"


@dataclass
class ReplayResult:
    """What a replay found.

    Attributes:
        tolerance: The largest difference that counts as reproduced.
        compared: How many ticks were compared in every channel.
        not_comparable: How many ticks gave their potentials to the replay, because the log does not
            say what these were before: the first tick of the log, the first after a gap or a
            restart, and ticks in which a motor failed; or because parameters and kicks may have
            changed in a gap, and no snapshot follows it that says so.
        behind_gaps: How many of the latter follow a gap in which parameters or kicks may have
            changed.
        missing: How many ticks are not in the log.
        first: The first channel that differs in any bit.
        beyond: The first channel that differs by more than the tolerance.
        worst: The greatest difference.
    """

    tolerance: float
    compared: int = 0
    not_comparable: int = 0
    behind_gaps: int = 0
    missing: int = 0
    first: Mismatch | None = None
    beyond: Mismatch | None = None
    worst: float = 0.0

    @property
    def exact(self) -> bool:
        """Whether every compared bit is the same."""
        return self.first is None

    @property
    def why_behind_gaps(self) -> str:
        """Why ticks behind a gap are not comparable, in words; empty if there are none."""
        if not self.behind_gaps:
            return ""
        return (
            f"{self.behind_gaps} ticks cannot be compared, since they follow a gap: a kick or a"
            " change of a parameter may be lost in it"
        )

    @property
    def reproduced(self) -> bool:
        """Whether something was compared, and nothing differs by more than the tolerance.

        The tolerance is 0 for logs of this kind of machine.
        """
        return self.compared > 0 and self.beyond is None

    def note(self, mismatch: Mismatch) -> None:
        """Take a difference into account."""
        difference = abs(mismatch.recorded - mismatch.replayed)
        self.first = self.first or mismatch
        self.worst = max(self.worst, difference)
        if self.tolerance == 0.0 or not difference <= self.tolerance:
            self.beyond = self.beyond or mismatch


def nothing_compared(path: object) -> NotDone:
    """Why a replay says nothing of a log."""
    return NotDone(
        f"no tick of {path} can be compared with the robot's program",
        "give a longer log, or one without gaps: `kickctl record 10` writes one",
    )


class Controller:
    """The robot's controller as the log describes it.

    Attributes:
        wheels: The left and the right robot.wheel.Wheel after the latest tick.
        params: The robot.params.Params in force.
        kick: The latest robot.kicks.Kick, which may be over; None if there is none.
    """

    def __init__(self) -> None:
        self.wheels = [Wheel(side) for side in WHEELS]
        self.params: Any = Params()
        self._snapshot = Snapshot(self.params.values())
        self.kick: Kick | None = None

    def take(self, event: Event) -> None:
        """Change parameters, kick and potentials as an event says."""
        if event["event"] == "snapshot":
            self._snapshot = Snapshot(event["params"], event["kick"])
        else:
            self._snapshot.take(event)
        self.params.apply(self._snapshot.params)
        self.kick = Kick(**self._snapshot.kick) if self._snapshot.kick else None
        if event["event"] == "start":
            for wheel, potentials in zip(self.wheels, event["x"], strict=True):
                wheel.rest()
                wheel.x1, wheel.x2 = potentials

    def step(self, record: Record) -> None:
        """Compute the tick of a record."""
        for wheel in self.wheels:
            if record.state == RUNNING:
                wheel.phi = getattr(record, wheel.side + "_phi_rad")
                wheel.step(record.tick, record.dt_s, self.params, self.kick)
            else:
                wheel.rest()

    def adopt(self, record: Record) -> None:
        """Take over the potentials of a record."""
        for wheel in self.wheels:
            wheel.x1 = getattr(record, wheel.side + "_x1")
            wheel.x2 = getattr(record, wheel.side + "_x2")

    def differences(self, record: Record) -> Iterator[Mismatch]:
        """Yield every channel of a record that is not what `step` computed, in every bit."""
        for wheel in self.wheels:
            recorded = _RECORDED[wheel.side](record)
            # From the recorded torque: rounding to whole percents may turn a difference in the last
            # bit into one of 1.
            *_, torque, _ = recorded
            duty = (
                limit_duty(self.params.duty_scale * torque, self.params.max_duty_pct)
                if record.state == RUNNING
                else 0
            )
            replayed = wheel.x1, wheel.x2, wheel.force, wheel.torque, duty
            if pack("5d", *recorded) == pack("5d", *replayed):
                continue
            for name, was, value in zip(_COMPUTED, recorded, replayed, strict=True):
                if pack("d", was) != pack("d", value):
                    yield Mismatch(record.tick, f"{wheel.side}_{name}", was, value)


def other_sources(info: dict[str, Any]) -> list[str]:
    """Whether a log comes from other code than this, with which its replay may differ.

    Args:
        info: The log's.

    Returns:
        Sentences; none if the sources are the same, or the log does not say them.
    """
    programs = {
        "robot_sources": ("the robot's program that this log comes from", of_robot()),
        "sources": ("the kickctl that recorded this log", sources()),
    }
    return [
        f"{program} has other sources ({info[name]}) than this one ({ours}): a difference may come"
        " from that"
        for name, (program, ours) in programs.items()
        if info.get(name, "") not in ("", ours)
    ]


class Replayer:
    """Replays a log item by item.

    Args:
        info: The log's.

    Attributes:
        controller: What computes, as it is after the latest item.
    """

    def __init__(self, info: dict[str, Any]) -> None:
        python = f"{platform.python_implementation()} {platform.python_version()}"
        here = f"{platform.machine()} {python}"
        same = info.get("robot_machine", here) == here
        self.controller = Controller()
        self._result = ReplayResult(0.0 if same else OTHER_MACHINE_TOLERANCE)
        self._known_before: int | None = None  # the tick before which the potentials are known
        self._failed = False
        self._followed = True  # whether parameters and kicks are known
        self._gaps = Gaps()

    @property
    def result(self) -> ReplayResult:
        """What was found so far."""
        return replace(self._result, missing=sum(end - first for first, end in self._gaps.found))

    def begin_part(self) -> None:
        """Count from the next item on."""
        self._result = ReplayResult(self._result.tolerance)
        self._gaps.found.clear()

    def take(self, item: Event | Record) -> tuple[bool, list[Mismatch]]:
        """Replay the next item.

        Args:
            item: An event, which only has an effect on what follows, or a record.

        Returns:
            Whether the log says what the potentials were before this tick, and each channel that
            differs in any bit.

        Raises:
            LogError: The numbers of the log are too large to compute with.
        """
        self._gaps.take(item)
        if isinstance(item, dict):
            self._take_event(item)
            return False, []
        known = (
            item.tick == self._known_before
            and self._followed
            and not (self._failed and item.state == FAULT)
        )
        try:
            self.controller.step(item)
        except OverflowError as error:
            raise too_large(item) from error
        if not known:
            self.controller.adopt(item)
        compares = known or item.state != RUNNING
        mismatches = list(self.controller.differences(item)) if compares else []
        for mismatch in mismatches:
            self._result.note(mismatch)
        self._result.compared += known
        self._result.not_comparable += not known
        self._result.behind_gaps += not self._followed
        self._known_before = item.tick + 1
        self._failed = False
        return known, mismatches

    def _take_event(self, event: Event) -> None:
        self.controller.take(event)
        if event["event"] == "start":
            self._known_before = event["tick"]
        elif event["event"] == "restart":
            self._known_before = None
        elif event["event"] in ("lost", "snapshot"):
            self._followed = event["event"] == "snapshot"
        self._failed = self._failed or event["event"] == "fault"


def too_large(record: Record) -> LogError:
    """What to say of a record with which nobody can compute."""
    return LogError(
        f"tick {record.tick} of the log, or the one before, has numbers too large to compute with",
        "no robot has these: the log was changed or damaged; take one that is whole",
    )


def replay(log: Log | LogFile) -> ReplayResult:
    """Replay a log. In a log that was neither changed nor damaged, nothing differs.

    Args:
        log: In memory, or a file, which is read as a stream and may be long.

    Returns:
        What was compared, and what differs.

    Raises:
        LogError: The file cannot be read any more, or its numbers are too large to compute with.
    """
    replayer = Replayer(log.info)
    for item in log.stream():
        replayer.take(item)
    return replayer.result
