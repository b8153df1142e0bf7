"""A simulated motor behind the robot's motor seam, on a clock that is virtual or real.

Whoever reads or writes first brings the motor up to the clock's present, on a fixed grid of
substeps. So the result does not depend on how often anybody looks, and is the same in virtual and
in real time.
"""

from __future__ import annotations

import sys
from array import array
from collections import deque
from collections.abc import Callable
from functools import cached_property
from math import inf, pi
from time import monotonic
from typing import TYPE_CHECKING, NamedTuple

from robot.motors import Motor, MotorFault
from sim_motor.clock import Clock
from sim_motor.constants import SUBSTEPS_PER_S, Constants, Steps
from sim_motor.exact_step import COAST
from sim_motor.motor import (
    CURRENT,
    advance,
    encoder,
    substep_at,
    substep_from,
)

if TYPE_CHECKING:
    from sim_motor.world import Drive, World

# In plain Python this takes about as long as compiled code takes to load. Browsers have none.
PLAIN_SUBSTEPS = inf if sys.platform == "emscripten" else 1_000_000
COMPILED = "sim_motor.compiled_motor"


class Truth(NamedTuple):
    """What no sensor measures of a wheel: forward positive, in rad, rad/s and A."""

    motor_angle: float
    motor_speed: float
    current: float
    wheel_angle: float
    wheel_speed: float


class SimMotor(Motor):
    """One motor with its wheel, from rest.

    Args:
        name: What messages call it.
        clock: Virtual or real.
        constants: Those of its specimen.
        battery_v: The battery's open-circuit voltage, V.
        mount: -1 if it is mounted mirrored, else 1.
        angle: The motor's angle, rad.
        gap: How far the motor is ahead of its wheel, within the backlash, rad.
        model: The name of its table in a motors file; empty if it has none.
    """

    def __init__(
        self,
        name: str,
        clock: Clock,
        constants: Constants,
        battery_v: float,
        mount: int = 1,
        angle: float = 0.0,
        gap: float = 0.0,
        model: str = "",
    ) -> None:
        if mount not in {1, -1}:
            raise ValueError(f"a motor's mount is 1 or -1 (mirrored), not {mount!r}")
        self.constants = constants
        self.model = model
        self.mount = mount
        self.world: World | None = None
        self.state = array("d", (angle, angle, 0.0, 0.0, gap, 0.0))
        self._name = name
        self._clock = clock
        self._epoch = clock.now()
        self._battery_v = battery_v
        self._plain = Steps(constants), constants.scalars()
        self._began = monotonic()
        self._latency_s = constants.latency_s
        self._substep = 0
        self._duty = 0
        self._load = 0.0
        self._pending: deque[tuple[int, int]] = deque()  # (substep from which it acts, duty)

    def angle_rad(self) -> float:
        self._catch_up()
        angle, last_angle, *_ = self.state
        own = self.constants
        position = encoder(
            self._substep, angle, last_angle, own.encoder_counts, own.dither, own.dither_seed
        )
        return position * pi / 180

    def write_duty(self, duty_pct: int) -> None:
        if (
            not isinstance(duty_pct, int)
            or isinstance(duty_pct, bool)
            or not -100 <= duty_pct <= 100
        ):
            raise MotorFault(
                f"{self._name} motor: the kernel refuses the duty cycle {duty_pct!r} (EINVAL) and"
                " keeps the one before: write a whole number from -100 to 100"
            )
        self._command(duty_pct)

    def stop(self) -> None:
        self._command(0)

    def coast(self) -> None:
        """Let go: the motor turns freely, without current."""
        self._command(COAST)

    def set_load(self, torque: float) -> None:
        """A torque (N m, forward positive) on the wheel from now on."""
        self._catch_up()
        self._load = self.mount * torque

    def set_supply(self, open_v: float) -> None:
        """Another open-circuit voltage (V) of the battery from now on."""
        self._catch_up()
        self._battery_v = open_v

    def truth(self) -> Truth:
        """The wheel's state now."""
        self._catch_up()
        angle, _, speed, current, gap, wheel_speed = (self.mount * value for value in self.state)
        return Truth(angle, speed, current, angle - gap, wheel_speed)

    def draw_a(self) -> float:
        """The current (A) that the motor draws from the battery now.

        Negative while it feeds back.
        """
        self._catch_up()
        return 0.0 if self._duty == COAST else self.state[CURRENT] * self._duty / 100

    def drive(self) -> Drive:
        """What drives the motor now, in its own sense of turning.

        Returns:
            The duty cycle, % or COAST; the battery's voltage, V; and the load on its wheel, N m.
        """
        return self._duty, self._battery_v, self._load

    def next_turn(self) -> float:
        """The substep from which the next duty acts; inf if none waits."""
        return self._pending[0][0] if self._pending else inf

    def reach(self, substep: int) -> None:
        """The world has brought the state to this substep: obey the duties due by then."""
        self._substep = substep
        while self.next_turn() <= substep:
            self._duty = self._pending.popleft()[1]

    def _command(self, duty: int) -> None:
        now = self._clock.now() - self._epoch
        self._catch_up()
        self._pending.append((max(substep_from(now + self._latency_s), self._substep), duty))

    def _catch_up(self) -> None:
        present = substep_at(self._clock.now() - self._epoch)
        if self.world is not None:
            self.world.catch_up(present)
            return
        while self._pending and self._pending[0][0] <= present:
            begin, duty = self._pending.popleft()
            self._advance(begin)
            self._duty = duty
        self._advance(present)

    def _advance(self, substep: int) -> None:
        count = substep - self._substep
        if count <= 0:
            return
        self._substep = substep
        drive = count, self._duty, self._battery_v, self._load
        if self._is_compiled_code_due(count):
            self._advance_compiled(*drive)
        else:
            angle, last_angle, speed, current, gap, wheel_speed = self.state
            motion = angle, last_angle, speed, current, gap, wheel_speed
            self.state[:] = array("d", advance(*drive, *motion, *self._plain))

    @cached_property
    def _advance_compiled(self) -> Callable[[int, int, float, float], None]:
        """`advance` for this motor in compiled code."""
        import numpy as np

        from sim_motor.arrays import scalars, tables
        from sim_motor.compiled_motor import advance_in_place

        state = np.frombuffer(self.state)
        (own_tables,), (own_scalars,) = tables([self.constants]), scalars([self.constants])
        return lambda count, duty, battery_v, load: advance_in_place(
            state, count, duty, battery_v, load, own_tables, own_scalars
        )

    def _is_compiled_code_due(self, count: int) -> bool:
        """Whether the time that it takes to load compiled code is saved by it.

        In real time it never is, and no tick could wait so long. So it is due to who is ahead of
        real time, or who slept.
        """
        ahead = self._substep - SUBSTEPS_PER_S * (monotonic() - self._began)
        return max(count, ahead) > (SUBSTEPS_PER_S if COMPILED in sys.modules else PLAIN_SUBSTEPS)
