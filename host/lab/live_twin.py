"""The simulated twin of a running robot, fed from its station's stream.

It is computed where the stream comes in, in the station's own thread, once the robot's records are
on their way to the pages: in the server's thread a STOP would wait for it. A tick takes a fraction
of a millisecond. What comes all at once after a broken link is passed over instead, and the twin
begins behind it.
"""

from __future__ import annotations

from collections import deque
from typing import Any

from host.errors import WrongUse
from host.kicking.outcome import STOPPED
from host.kicking.robot_motor import EV3
from host.lab import derived
from host.lab.allowance import Allowance
from host.lab.kicks import Kicks, stall_of
from host.lab.observed import VERDICTS_KEPT
from host.lab.ring import Ring
from host.lab.steady_clock import SteadyClock
from host.lab.twin import Twin, motors_of
from host.logs.tap import Event
from robot.record import Record
from sim_motor.constants import Constants

# How many ticks a second are computed, and how many at once. The shortest control period is 10 ms.
RATE_PER_S, BURST = 150.0, 300.0


class LiveTwin:
    """Follows a station, and computes what its robot's twin does.

    Args:
        entry: The entry of a motors file; empty for that of the robot's own motors.

    Attributes:
        ring: The twin's latest records, packed with the derived channels.
        trouble: Why there is no twin; None if there is one, or may be.

    Raises:
        WrongUse: There is no entry of this name.
    """

    def __init__(self, entry: str = "") -> None:
        self.ring = Ring(derived.SIZE)
        self.trouble: WrongUse | None = None
        self._wanted = self._entry = entry
        self._constants: Constants | None = None
        if entry:
            motors_of(entry, "", "")
        self._twin: Twin | None = None
        self._clock = SteadyClock()
        self._allowance = Allowance(0.0, RATE_PER_S, BURST)
        self._watched = {"robot": Kicks(), "twin": Kicks()}
        self._outcomes: dict[str, dict[str, Any]] = {}
        self._compared: deque[dict[str, Any]] = deque(maxlen=VERDICTS_KEPT)
        self._score = {"same": 0, "kicks": 0}

    def description(self, params: dict[str, Any]) -> dict[str, Any]:
        """What the welcome says of the twin.

        Args:
            params: The robot's parameters in force, by name.
        """
        trouble = self.trouble
        return {
            "motor": self._entry,
            "stall": None if self._constants is None else stall_of(self._constants, params),
            "why": "" if trouble is None else trouble.message,
            "hint": "" if trouble is None else trouble.hint,
            "compared": list(self._compared),
            "score": dict(self._score),
            "history": self.ring.end - self.ring.recent,
        }

    def meet(self, hello: dict[str, Any], battery_v: float | None) -> None:
        """A connection to the robot has been opened.

        Args:
            hello: What the robot says of itself.
            battery_v: The voltage of its battery (V); None if it is unknown.
        """
        try:
            entry, constants = motors_of(self._wanted, str(hello.get("motor", EV3)), "this robot")
        except WrongUse as error:
            self.trouble, self._twin, self._constants = error, None, None
            return
        self.trouble = None
        if constants != self._constants:
            self._entry, self._constants = entry, constants
            self._twin = Twin(constants, battery_v)

    def take_event(self, event: Event) -> None:
        """Follow what changes the robot's course."""
        if event["event"] == "restart":
            self._clock.restart()
        for kicks in self._watched.values():
            kicks.take_event(event)
        if self._twin is not None:
            self._twin.take_event(event)

    def take_records(self, records: list[Record], now: float) -> dict[str, Any] | None:
        """Compute the twin in the robot's next ticks.

        Args:
            records: The robot's, oldest first.
            now: The time on the station's clock (s).

        Returns:
            What a `twin` message says of a kick, if it is clear now for the first time what robot
            and twin did.
        """
        twin = self._twin
        if twin is None:
            return None
        computed = []
        for record in records:
            t_s = self._clock.read(record)
            if not self._allowance.take(now):
                twin.pass_over(record, t_s)
                continue
            try:
                own, values = twin.take_record(record, t_s)
            except OverflowError:
                twin.begin_again()
                continue
            if values is not None:
                self.ring.append(derived.pack(own, values))
            computed.append(own)
        return self._compare({"robot": records, "twin": computed})

    def _compare(self, records: dict[str, list[Record]]) -> dict[str, Any] | None:
        """Take in what both have done, and compare them once both outcomes are known."""
        for name, kicks in self._watched.items():
            outcome = kicks.take_records(records[name])
            if outcome is not None:
                self._outcomes[name] = outcome
        if len(self._outcomes) < len(self._watched):
            return None
        robot, twin = (self._outcomes[name] for name in self._watched)
        if robot["kick_id"] != twin["kick_id"]:
            return None
        self._outcomes.clear()
        if not (robot["result"] and twin["result"]):
            return None
        same = _deeds(robot) == _deeds(twin)
        self._score["kicks"] += 1
        self._score["same"] += same
        compared = {
            "kick_id": robot["kick_id"],
            "robot_did": {name: robot[name] for name in ("before", "result")},
            "twin_did": {name: twin[name] for name in ("before", "result")},
            "same": same,
            "score": dict(self._score),
        }
        self._compared.append(compared)
        return compared


def _deeds(outcome: dict[str, Any]) -> dict[str, tuple[str, bool]]:
    """What each kicked wheel did, and whether it did that from rest."""
    return {
        side: (result, outcome["before"][side] == STOPPED)
        for side, result in outcome["result"].items()
    }
