"""What the lab knows of a robot's kicks: the records before them, and what came of them."""

from __future__ import annotations

from collections import deque
from typing import Any

from host.kicking.kick_watch import KickWatch
from host.kicking.robot_motor import EV3, known_entry
from host.logs.tap import Event
from robot.kicks import WHEELS
from robot.record import Record
from sim_motor.constants import Constants, load

# Records that predictions and outcomes look back to: a second of the shortest control period.
_RECENT = 120


class Kicks:
    """Keeps the latest records of a robot, and watches the latest kick until its outcome is clear.

    A kick before that leaves the outcome of the one before unknown.
    """

    def __init__(self) -> None:
        self._records: deque[Record] = deque(maxlen=_RECENT)
        self._watch: KickWatch | None = None
        self._id = ""

    def recent(self) -> list[Record]:
        """The latest records, oldest first."""
        return list(self._records)

    def take_event(self, event: Event) -> None:
        """Begin to watch a kick. A restart makes the records before it useless."""
        if event["event"] == "restart":
            self._records.clear()
        elif event["event"] == "kick":
            self._watch = KickWatch(event["kick"], self._records)
            self._id = event["kick"]["id"]

    def take_records(self, records: list[Record]) -> dict[str, Any] | None:
        """Take the next records.

        Args:
            records: Oldest first.

        Returns:
            What an `outcome` message says of the kick, if that is clear now for the first time, or
            why there will be none.
        """
        self._records.extend(records)
        watch = self._watch
        if watch is None:
            return None
        watch.take_records(records)
        if watch.done:
            self._watch = None
        outcome = watch.outcome
        if outcome is None:
            return {"kick_id": self._id, "result": {}, "why": watch.gave_up} if watch.done else None
        wheels = WHEELS if outcome.wheel == "both" else (outcome.wheel,)
        return {
            "kick_id": self._id,
            "before": outcome.before,
            "after": outcome.after,
            "reversed": outcome.reversed,
            "settling_s": outcome.settling_s,
            "result": {side: outcome.results[side] for side in wheels},
        }


def motor_known(hello: dict[str, Any]) -> Constants | None:
    """The constants of the motors that a robot's hello names; None if they are not known here."""
    model = hello.get("motor", EV3)
    entry = known_entry(model) if isinstance(model, str) and model else None
    return None if entry is None else load(entry)


def stall(hello: dict[str, Any], params: dict[str, Any]) -> float | None:
    """The least |M| that moves a robot's wheel from rest.

    Args:
        hello: What the robot says of itself.
        params: Its parameters in force, by name.

    Returns:
        From 0 to 1; None if the motors are not known here.
    """
    motor = motor_known(hello)
    return None if motor is None else stall_of(motor, params)


def stall_of(motor: Constants, params: dict[str, Any]) -> float:
    """The same for a robot whose motors are known."""
    standing_nm = motor.torque_constant * motor.battery_v / motor.resistance
    most = params["duty_scale"] * params["max_duty_pct"] / 100.0
    least = (motor.static + motor.rolling) / standing_nm
    return min(1.0, least / most) if most > 0.0 else 1.0
