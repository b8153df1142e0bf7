"""A simulated twin of a robot: the same program under the same kicks, with simulated motors.

The twin begins where the robot's records begin, and again at each start of the robot and after each
gap: with the robot's angles, speeds and potentials. From there on it goes its own way, with the
robot's parameters, kicks and times of ticks. What else pushes the robot, as a wall, a hand or a
weaker battery, does not push the twin.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from host.errors import WrongUse, printable
from host.kicking.outcome import compare
from host.kicking.robot_motor import known_entry
from host.lab import derived
from host.logs.motion import heading_of
from host.logs.replay import Controller
from host.logs.tap import Event
from robot.kicks import DIRECTION_TICKS, WHEELS
from robot.record import Record
from robot.safety import RUNNING, limit_duty
from sim_motor.clock import VirtualClock
from sim_motor.constants import Constants, load
from sim_motor.motor import SPEED, WHEEL_SPEED
from sim_motor.wheel_motor import SimMotor

# How long after a kick wheels are compared at the latest, and at the earliest (s): after the first
# time they have settled, before the second one nobody knows.
_LATEST_S, _EARLIEST_S = 3.0, 1.0
# A tick that begins later than this after the one before counts as one after a gap (s): by then the
# robot's watchdog has stopped its motors, and to compute so much at once would take too long.
_LONGEST_PAUSE_S = 1.0
_NEWS = ("kick", "params", "start", "stop", "hold", "resume", "fault", "restart", "lost")


class Twin:
    """Follows a robot's stream, and computes what its twin does in each tick.

    Args:
        constants: The motors' constants.
        battery_v: The battery's open-circuit voltage (V); None for the nominal one.
    """

    def __init__(self, constants: Constants, battery_v: float | None) -> None:
        self._constants = constants
        self._battery_v = battery_v or constants.battery_v
        self._clock = VirtualClock(0, jitter=False)
        self._controller = Controller()
        self._follower = derived.Follower()
        self._motors: list[SimMotor] = []
        self._before: tuple[float, Record] | None = None

    def take_event(self, event: Event) -> None:
        """Follow parameters and kicks; begin again where the robot does."""
        self._controller.take(event)
        self._follower.take_event(event)
        if event["event"] in ("start", "lost", "restart"):
            self.begin_again()
        if event["event"] == "restart":
            self._before = None

    def begin_again(self) -> None:
        """Have the twin begin with the robot's next tick."""
        self._motors = []

    def pass_over(self, record: Record, t_s: float) -> None:
        """Take a tick of the robot, as `take_record`, for which the twin is not computed.

        The twin begins behind it.
        """
        self.begin_again()
        self._before = t_s, record

    def take_record(self, record: Record, t_s: float) -> tuple[Record, tuple[float, ...] | None]:
        """Compute the twin's tick.

        Args:
            record: The robot's.
            t_s: When the tick began, on a clock that no restart sets back (s).

        Returns:
            The twin's record, and its derived channels as derived.Follower gives them.

        Raises:
            OverflowError: The robot's numbers are too large to compute with.
        """
        self._clock.wait(t_s, lambda _: None)
        before, self._before = self._before, (t_s, record)
        if before is not None and (
            record.tick != before[1].tick + 1 or t_s > before[0] + _LONGEST_PAUSE_S
        ):
            self.begin_again()
        begins = not self._motors
        if begins:
            self._motors = [self._motor(side, record, t_s, before) for side in WHEELS]
            if before is not None:
                self._follower.follow_on(before[1])
        else:
            angles = zip(WHEELS, self._motors, strict=True)
            record = record._replace(
                **{f"{side}_phi_rad": motor.angle_rad() for side, motor in angles}
            )
        self._controller.step(record)
        if begins:
            self._controller.adopt(record)
        else:
            record = record._replace(**self._results(record))
        for side, motor in zip(WHEELS, self._motors, strict=True):
            motor.write_duty(getattr(record, side + "_duty_pct"))
        return record, self._follower.derive(record)

    def without_speed(self, record: Record) -> tuple[float, ...]:
        """Derived channels of a twin's record for which `take_record` gives none."""
        return self._follower.without_speed(record)

    def _motor(
        self, side: str, record: Record, t_s: float, before: tuple[float, Record] | None
    ) -> SimMotor:
        """A motor that stands and turns as the robot's."""
        name = side + "_phi_rad"
        angle = getattr(record, name)
        motor = SimMotor(side, self._clock, self._constants, self._battery_v, angle=angle)
        if before is not None and t_s > before[0]:
            speed = (angle - getattr(before[1], name)) / (t_s - before[0])
            motor.state[SPEED] = motor.state[WHEEL_SPEED] = speed
        return motor

    def _results(self, record: Record) -> dict[str, float]:
        """What the twin's controller has computed, by the names of channels."""
        params, results = self._controller.params, {}
        for wheel in self._controller.wheels:
            duty = limit_duty(params.duty_scale * wheel.torque, params.max_duty_pct)
            values = {
                "x1": wheel.x1,
                "x2": wheel.x2,
                "force": wheel.force,
                "torque": wheel.torque,
                "duty_pct": duty if record.state == RUNNING else 0,
            }
            results.update({f"{wheel.side}_{name}": value for name, value in values.items()})
        return results


def motors_of(entry: str, model: str, whose: str) -> tuple[str, Constants]:
    """The motors of a twin.

    Args:
        entry: The name of an entry of a motors file; empty for that of the robot's own motors.
        model: What the robot's program calls its motors.
        whose: Which robot that is, in words.

    Returns:
        The name of the entry, and its constants.

    Raises:
        WrongUse: There is no entry of this name, or none for this model.
    """
    known = entry or known_entry(model)
    if known is None:
        raise WrongUse(
            f"this computer does not know the motors of {whose}, '{printable(model)}'",
            "name an entry of a motors file: --twin NAME; kickctl experiment calibrate writes one",
        )
    try:
        return known, load(known)
    except ValueError as error:
        raise WrongUse(str(error), "name one of these: --twin NAME") from error


def compare_kicks(
    robot: Sequence[Record], twin: Sequence[Record], events: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    """What each kick did to a robot and to its twin.

    Args:
        robot: The robot's records.
        twin: As many of its twin.
        events: {place, event} as in a tape.

    Returns:
        {place, robot, twin} of each kick after which nothing else happened for a second: the place
        of its event, and what each kicked wheel did, in the words of host.kicking.outcome.
    """
    news = [row for row in events if row["event"]["event"] in _NEWS]
    found = []
    for row, after in pairwise([*news, {"place": len(robot)}]):
        place, kick = row["place"], row["event"].get("kick")
        if row["event"]["event"] != "kick" or place < DIRECTION_TICKS:
            continue
        end = min(place + kick["ticks"], after["place"] - 1)
        last = end
        while last + 1 < after["place"] and robot[last].t_s < robot[end].t_s + _LATEST_S:
            last += 1
        if robot[last].t_s >= robot[end].t_s + _EARLIEST_S:
            did = {
                name: {side: _result(records, side, place, last) for side in kick["wheels"]}
                for name, records in (("robot", robot), ("twin", twin))
            }
            found.append({"place": place, **did})
    return found


def _result(records: Sequence[Record], side: str, begin: int, end: int) -> str:
    """What a wheel did between two places."""
    before, after = (
        heading_of([getattr(one, side + "_phi_rad") for one in part])
        for part in (
            records[begin - DIRECTION_TICKS : begin],
            records[end - DIRECTION_TICKS : end + 1],
        )
    )
    return compare(before, after)
