"""Channels that the server computes beside a robot's own, once for each record.

The robot's own functions compute: what the page draws of the model comes from here.
"""

from __future__ import annotations

import struct
from functools import cache
from math import atan2, ceil, cos, nan, pi, sin
from typing import Any, NamedTuple

from host.logs.tap import Event
from robot.blackbox import Snapshot
from robot.controller import actual_positions, target_position
from robot.kicks import WHEELS, Kick, apply_kick, seen_positions
from robot.params import Params
from robot.record import STRUCT, Record, channel, of_each_wheel
from sim_motor.constants import data

_WHEEL = (
    channel("target1", "f", "1", "where the first neuron wants its rod"),
    channel("target2", "f", "1", "where the second neuron wants its rod"),
    channel("seen1", "f", "1", "the position that the first neuron sees"),
    channel("seen2", "f", "1", "the position that the second neuron sees"),
    channel("omega_rad_s", "f", "rad/s", "speed since the record before, forward positive"),
    channel("lag_rad", "f", "rad", "how far the angle atan2(x2, x1) lies behind phi_rad"),
)
_PLACE = (
    channel("x_m", "f", "m", "place by odometry since the lab began, along its first heading"),
    channel("y_m", "f", "m", "place by odometry, to the left of the first heading"),
    channel("heading_rad", "f", "rad", "heading by odometry, to the left positive"),
)
CHANNELS = (*of_each_wheel(_WHEEL), *_PLACE)
_VALUES = struct.Struct(f"<{len(CHANNELS)}f")
# The bytes of what `pack` gives.
SIZE = STRUCT.size + _VALUES.size


def pack(record: Record, values: tuple[float, ...]) -> bytes:
    """A record with its derived channels, as pages take it."""
    own: bytes = STRUCT.pack(*record)
    return own + _VALUES.pack(*values)


class Body(NamedTuple):
    """The robot's measures that odometry needs (m)."""

    track_m: float
    wheel_radius_m: float


@cache
def body() -> Body:
    """The measures of the paper's robot, as motors.toml has them."""
    robot = data()["robot"]
    return Body(float(robot["track"][0]), float(robot["wheel_radius"][0]))


class Follower:
    """Follows a robot's stream, and computes the derived channels of each record."""

    def __init__(self) -> None:
        self._body = body()
        self._before: Record | None = None
        self._kick: Kick | None = None
        self._snapshot = Snapshot(Params().values())
        self._x_m = self._y_m = self._heading_rad = 0.0

    def take_event(self, event: Event) -> None:
        """Follow parameters and kicks. A restart sets the wheels' angles to zero."""
        if event["event"] == "restart":
            self._before = None
        elif event["event"] == "snapshot":
            self._snapshot = Snapshot(event["params"], event["kick"])
        else:
            self._snapshot.take(event)
        kick = self._snapshot.kick
        self._kick = Kick(**kick) if kick else None

    def follow_on(self, record: Record) -> None:
        """Have the next record follow another one than it did: that of where a twin begins."""
        self._before = record

    @property
    def params(self) -> dict[str, Any]:
        """The parameters in force, by name."""
        return self._snapshot.params

    def snapshot(self, tick: int) -> Event:
        """What is in force from a tick on, as an event."""
        event: Event = self._snapshot.as_event(tick)
        return event

    def derive(self, record: Record) -> tuple[float, ...] | None:
        """The derived channels of the next record.

        Args:
            record: The record.

        Returns:
            One number for each of CHANNELS; None for the first record, which has no speed.
        """
        before, self._before = self._before, record
        if before is None or record.t_s <= before.t_s:
            return None
        seconds = record.t_s - before.t_s
        left_rad = record.left_phi_rad - before.left_phi_rad
        right_rad = record.right_phi_rad - before.right_phi_rad
        self._roll(left_rad, right_rad)
        return self._values(record, left_rad / seconds, right_rad / seconds)

    def without_speed(self, record: Record) -> tuple[float, ...]:
        """The same of a record for which `derive` gives None: speeds are NaN, all else is known."""
        return self._values(record, nan, nan)

    def _values(self, record: Record, left_rad_s: float, right_rad_s: float) -> tuple[float, ...]:
        left, right = self._wheel(0, record, left_rad_s), self._wheel(1, record, right_rad_s)
        return (*left, *right, self._x_m, self._y_m, self._heading_rad)

    def _wheel(self, index: int, record: Record, omega_rad_s: float) -> tuple[float, ...]:
        """A wheel's derived channels."""
        side, params = WHEELS[index], self._snapshot.params
        phi_rad = getattr(record, side + "_phi_rad")
        x1, x2 = getattr(record, side + "_x1"), getattr(record, side + "_x2")
        gain, seen = params["a"], actual_positions(phi_rad)
        kick = self._kick
        if kick is not None and side in kick.wheels and kick.acts_at(record.tick):
            numbers = kick.numbers(index)
            acting = apply_kick(numbers, record.tick, x1, x2, gain, params["tau_s"], params["k"])
            gain, seen = acting[2], seen_positions(phi_rad, *acting[5:])
        return (
            target_position(x1, gain),
            target_position(x2, gain),
            *seen,
            omega_rad_s,
            wrapped(phi_rad - atan2(x2, x1)),
        )

    def _roll(self, left_rad: float, right_rad: float) -> None:
        """Roll on both wheels, along an arc."""
        radius_m = self._body.wheel_radius_m
        turn_rad = radius_m * (right_rad - left_rad) / self._body.track_m
        way_m = radius_m * (left_rad + right_rad) / 2.0
        middle_rad = self._heading_rad + turn_rad / 2.0
        self._x_m += way_m * cos(middle_rad)
        self._y_m += way_m * sin(middle_rad)
        self._heading_rad += turn_rad


def wrapped(angle_rad: float) -> float:
    """The same direction as an angle in (-pi, pi] (rad)."""
    return angle_rad - 2.0 * pi * ceil((angle_rad - pi) / (2.0 * pi))
