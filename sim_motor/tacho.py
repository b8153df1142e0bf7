"""One motor as the kernel's tacho-motor class shows it: attributes as text, and commands.

Speed and stall flag come late, as there. It follows the ev3dev kernel's tacho_motor_class.c and
legoev3_motor.c as of 4.14.117-ev3dev-2.3.5-ev3. Commands for runs that the kernel regulates (all
but run-direct, stop and reset) fail with EOPNOTSUPP, and `hold` only brakes: nothing here needs
them.
"""

import errno
import os
import re
from collections import deque
from collections.abc import Callable
from functools import partial
from math import floor, pi
from typing import NamedTuple

from sim_motor.motor import ANGLE
from sim_motor.wheel_motor import SimMotor

LARGE = "lego-ev3-l-motor"
MAX_SPEED = 1050
COUNT_PER_ROT = 360
COMMANDS = (
    "run-forever",
    "run-to-abs-pos",
    "run-to-rel-pos",
    "run-timed",
    "run-direct",
    "stop",
    "reset",
)
STOP_ACTIONS = ("coast", "brake", "hold")
POLARITIES = {"normal": 1, "inversed": -1}
# What only a regulated run would use: name -> (least, most, after a reset).
SETTINGS = {
    "speed_sp": (-MAX_SPEED, MAX_SPEED, 0),
    "position_sp": (-(2**31), 2**31 - 1, 0),
    "time_sp": (0, 2**31 - 1, 0),
    "ramp_up_sp": (0, 60000, 0),
    "ramp_down_sp": (0, 60000, 0),
    "speed_pid/Kp": (-(2**31), 2**31 - 1, 1000),
    "speed_pid/Ki": (-(2**31), 2**31 - 1, 60),
    "speed_pid/Kd": (-(2**31), 2**31 - 1, 0),
    "hold_pid/Kp": (-(2**31), 2**31 - 1, 80000),
    "hold_pid/Ki": (-(2**31), 2**31 - 1, 0),
    "hold_pid/Kd": (-(2**31), 2**31 - 1, 0),
}

IDLE_ENTRY_S = 0.05
SLOPE_S = 0.02
SLOPE_STEP = 4
SLOPE_ENTRIES = 64
STALLED_S = 0.1

READ, WRITE, BOTH = 0o444, 0o220, 0o664


class Attribute(NamedTuple):
    """A file of a device: its mode bits, and what reading and writing it does.

    Either may raise OSError.
    """

    mode: int
    show: Callable[[], str]
    store: Callable[[str], None]


def failure(number: int) -> OSError:
    """The error of a system call."""
    return OSError(number, os.strerror(number))


def no_show() -> str:
    """What cannot be read."""
    raise failure(errno.EACCES)


def no_store(text: str) -> None:
    """What cannot be written."""
    raise failure(errno.EACCES)


def whole_number(text: str, least: int, most: int) -> int:
    """A number as the kernel's kstrtoint reads it, within bounds.

    Raises OSError: EINVAL, or ERANGE beyond 32 bits.
    """
    if not re.fullmatch(r"[+-]?[0-9]+\n?", text, re.ASCII):
        raise failure(errno.EINVAL)
    number = int(text)
    if not -(2**31) <= number < 2**31:
        raise failure(errno.ERANGE)
    if not least <= number <= most:
        raise failure(errno.EINVAL)
    return number


class Tachometer:
    """The encoder as the brick's coprocessor keeps it.

    It is a ring of counts with their times, with an entry every 50 ms if there is no count.
    """

    def __init__(self, now: float, angle: float, counts_per_turn: float) -> None:
        self._per_rad = counts_per_turn / (2 * pi)
        self._origin = floor(angle * self._per_rad)
        self._time = now
        self._counts = angle * self._per_rad - self._origin
        self._ring: deque[tuple[float, int]] = deque([(now, 0)], SLOPE_ENTRIES + 1)

    @property
    def degrees(self) -> int:
        """Whole degrees, two counts each, rounded towards zero as in C."""
        return int(self._ring[-1][1] / 2)

    def sample(self, now: float, angle: float) -> None:
        """Take the angle (rad) at a time (s).

        Between two samples it is taken to have turned evenly.
        """
        counts = angle * self._per_rad - self._origin
        before, after = floor(self._counts), floor(counts)
        sense = 1 if after > before else -1
        # Older counts than the ring holds need not be entered.
        first = before if abs(after - before) <= SLOPE_ENTRIES else after - sense * SLOPE_ENTRIES
        for count in range(first + sense, after + sense, sense) if after != before else ():
            edge = count if sense > 0 else count + 1
            part = (edge - self._counts) / (counts - self._counts)
            self._ring.append((self._time + part * (now - self._time), count))
        while now - self._ring[-1][0] >= IDLE_ENTRY_S:
            self._ring.append((self._ring[-1][0] + IDLE_ENTRY_S, after))
        self._time, self._counts = now, counts

    @property
    def speed(self) -> int:
        """deg/s over the last 20 ms or more, in steps of four entries.

        So it is zero no sooner than 200 ms after the last count.
        """
        until, count = self._ring[-1]
        since, old = self._ring[0]
        for back in range(SLOPE_STEP, len(self._ring), SLOPE_STEP):
            since, old = self._ring[-1 - back]
            if until - since >= SLOPE_S:
                break
        return int((count - old) / (until - since) / 2) if until > since else 0


class TachoMotor:
    """A large motor that was plugged into a port at the time `now` (s).

    `sample` brings it the time from outside.
    """

    def __init__(self, motor: SimMotor, port: str, now: float) -> None:
        self._motor = motor
        self._connected = True
        self._now = now
        motor.angle_rad()
        self._tachometer = Tachometer(
            now, float(motor.state[ANGLE]), motor.constants.encoder_counts
        )
        self._offset = 0
        self._still_since: float | None = None
        self._running = False
        self._duty = 0
        self._polarity = "normal"
        self._stop_action = "coast"
        self._settings = {name: after_reset for name, (_, _, after_reset) in SETTINGS.items()}
        self.attributes = self._attributes(port)

    def sample(self, now: float) -> None:
        """The kernel's 2 ms timer: take the angle that the motor has now."""
        self._now = now
        if self._connected:
            self._motor.angle_rad()
            self._tachometer.sample(now, float(self._motor.state[ANGLE]))
        if not self._running or self._tachometer.speed:
            self._still_since = None
        elif self._still_since is None:
            self._still_since = now

    def disconnect(self) -> None:
        """The cable is out: the motor turns freely. The position stays until the kernel notices."""
        self._connected = False
        self._motor.coast()

    def _attributes(self, port: str) -> dict[str, Attribute]:
        address = "ev3-ports:" + port
        constants = {
            "address": address,
            "driver_name": LARGE,
            "commands": " ".join(COMMANDS),
            "stop_actions": " ".join(STOP_ACTIONS),
            "count_per_rot": str(COUNT_PER_ROT),
            "max_speed": str(MAX_SPEED),
            "uevent": f"LEGO_ADDRESS={address}\nLEGO_DRIVER_NAME={LARGE}",
        }
        table = {
            name: Attribute(READ, partial(str, text), no_store) for name, text in constants.items()
        }
        table |= {name: self._setting(name) for name in SETTINGS}
        table["command"] = Attribute(WRITE, no_show, self._command)
        table["position"] = Attribute(BOTH, lambda: str(self._position()), self._set_position)
        table["speed"] = Attribute(READ, lambda: str(self._sign * self._tachometer.speed), no_store)
        table["duty_cycle"] = Attribute(
            READ, lambda: str(self._duty if self._running else 0), no_store
        )
        table["duty_cycle_sp"] = Attribute(BOTH, lambda: str(self._duty), self._set_duty)
        table["polarity"] = Attribute(BOTH, lambda: self._polarity, self._set_polarity)
        table["stop_action"] = Attribute(BOTH, lambda: self._stop_action, self._set_stop_action)
        table["state"] = Attribute(READ, self._state, no_store)
        return table

    def _setting(self, name: str) -> Attribute:
        least, most, _ = SETTINGS[name]

        def store(text: str) -> None:
            self._settings[name] = whole_number(text, least, most)

        return Attribute(BOTH, lambda: str(self._settings[name]), store)

    @property
    def _sign(self) -> int:
        return POLARITIES[self._polarity]

    def _position(self) -> int:
        return self._sign * (self._tachometer.degrees + self._offset)

    def _set_position(self, text: str) -> None:
        self._offset = (
            self._sign * whole_number(text, -(2**31), 2**31 - 1) - self._tachometer.degrees
        )

    def _set_duty(self, text: str) -> None:
        self._duty = whole_number(text, -100, 100)
        if self._running:
            self._drive()

    def _set_polarity(self, text: str) -> None:
        self._polarity = _one_of(POLARITIES, text)

    def _set_stop_action(self, text: str) -> None:
        self._stop_action = _one_of(STOP_ACTIONS, text)

    def _state(self) -> str:
        if not self._running:
            return ""
        stalled = self._still_since is not None and self._now - self._still_since > STALLED_S
        return "running stalled" if stalled else "running"

    def _command(self, text: str) -> None:
        command = _one_of(COMMANDS, text)
        if command == "run-direct":
            self._running = True
            self._drive()
        elif command == "stop":
            self._stop(self._stop_action)
        elif command == "reset":
            self._stop("coast")
            self._duty = 0
            self._polarity = "normal"
            self._stop_action = "coast"
            self._offset = -self._tachometer.degrees
            self._settings = {name: after_reset for name, (_, _, after_reset) in SETTINGS.items()}
        else:
            raise failure(errno.EOPNOTSUPP)

    def _drive(self) -> None:
        if self._connected:
            self._motor.write_duty(self._sign * self._duty)

    def _stop(self, action: str) -> None:
        self._running = False
        self._still_since = None
        if self._connected:
            if action == "coast":
                self._motor.coast()
            else:
                self._motor.stop()


def _one_of(names: "tuple[str, ...] | dict[str, int]", text: str) -> str:
    name = text.removesuffix("\n")
    if name not in names:
        raise failure(errno.EINVAL)
    return name
