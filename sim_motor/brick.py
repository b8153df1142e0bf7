"""A simulated brick: two motors under the robot, a battery, and a clock that is virtual or real.

Physics is lazy: whoever reads or writes first brings the motor up to the clock's present on its
fixed grid of substeps. What comes out does not depend on how often anybody looks, and runs the same
in virtual and in real time.
"""

from collections import deque
from collections.abc import Callable, Iterator
from itertools import repeat
from math import inf, pi, radians
from random import Random
from typing import NamedTuple, Protocol

import numpy as np

from robot.motors import Battery, Motor, MotorFault
from sim_motor.constants import COAST, Array, Constants, data, load
from sim_motor.motor import (
    ANGLE,
    CURRENT,
    GAP,
    LAST_ANGLE,
    advance_in_place,
    encoder,
    substep_at,
    substep_from,
)
from sim_motor.world import Drive, Scene, World, alone

# How late a tick begins: a record of 496 ticks of 30 ms on a brick (Python 3.5, balancing robot)
# lies on a shifted log-normal with these three numbers: median 0.66 ms, 90 % below 2.1, 99 % below
# 5.7, the longest 13.6. Nothing is claimed beyond the longest.
LATE_LEAST_S, LATE_MEDIAN_S, LATE_SPREAD, LATE_MOST_S = 0.00017, 0.00049, 1.06, 0.0136

HIGHEST_BATTERY_V = 10.0  # six fresh AA cells


def lateness_s(normal: Array) -> Array:
    """How late ticks begin, from standard normal numbers."""
    return np.minimum(LATE_LEAST_S + LATE_MEDIAN_S * np.exp(LATE_SPREAD * normal), LATE_MOST_S)


class Clock(Protocol):
    """The clock seam of robot.motors."""

    def now(self) -> float: ...
    def wait(self, deadline: float, serve: Callable[[float], object]) -> None: ...


class VirtualClock:
    """Time that passes only when it is waited for.

    Ticks begin late as on the brick, drawn from `seed`; punctually if not `jitter`.
    """

    def __init__(self, seed: int, *, jitter: bool = True) -> None:
        self._now = 0.0
        self._late = self._lateness(np.random.default_rng(seed)) if jitter else repeat(0.0)

    def now(self) -> float:
        """Seconds since the clock was made."""
        return self._now

    def wait(self, deadline: float, serve: Callable[[float], object]) -> None:
        """Let links be served once, then be at `deadline` (s), or as late as the brick would be."""
        serve(0.0)
        self._now = max(self._now, deadline) + next(self._late)

    @staticmethod
    def _lateness(rng: np.random.Generator) -> Iterator[float]:
        while True:
            yield from lateness_s(rng.standard_normal(1000)).tolist()


class Truth(NamedTuple):
    """What no sensor tells about a wheel: forward positive, in rad, rad/s and A."""

    motor_angle: float
    motor_speed: float
    current: float
    wheel_angle: float
    wheel_speed: float


class SimMotor(Motor):
    """One motor with its wheel behind robot's motor seam, from rest at a motor angle with a gap to its wheel (rad)."""

    def __init__(
        self,
        name: str,
        clock: Clock,
        constants: Constants,
        battery_v: float,
        mount: int = 1,
        angle: float = 0.0,
        gap: float = 0.0,
    ) -> None:
        if mount not in {1, -1}:
            raise ValueError(f"a motor's mount is 1 or -1 (mirrored), not {mount!r}")
        self.constants = constants
        self.mount = mount
        self.world: World | None = None
        self.state = np.zeros(6)
        self.state[[ANGLE, LAST_ANGLE]] = angle
        self.state[GAP] = gap
        self._name = name
        self._clock = clock
        self._epoch = clock.now()
        self._battery_v = battery_v
        self._tables = constants.tables()
        self._scalars = constants.scalars()
        self._counts = constants.encoder_counts
        self._latency_s = constants.latency_s
        self._substep = 0
        self._duty = 0
        self._load = 0.0
        self._pending: deque[tuple[int, int]] = deque()  # (substep from which it acts, duty)
        # No time passes in this; but compiled code is loaded here, where nobody waits for it, and
        # not in the first tick.
        advance_in_place(self.state, 0, 0, battery_v, 0.0, self._tables, self._scalars)
        self.angle_rad()

    def angle_rad(self) -> float:
        self._catch_up()
        return (
            encoder(self._substep, self.state[ANGLE], self.state[LAST_ANGLE], self._counts)
            * pi
            / 180
        )

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
        angle, _, speed, current, gap, wheel_speed = (
            self.mount * value for value in self.state.tolist()
        )
        return Truth(angle, speed, current, angle - gap, wheel_speed)

    def draw_a(self) -> float:
        """The current (A) that the motor draws from the battery now.

        Negative while it feeds back.
        """
        self._catch_up()
        return 0.0 if self._duty == COAST else float(self.state[CURRENT]) * self._duty / 100

    def drive(self) -> Drive:
        """What drives the motor now: duty (% or COAST), battery voltage, and the load (N m) on its wheel, in its own sense of turning."""
        return self._duty, self._battery_v, self._load

    def next_turn(self) -> float:
        """The substep from which the next duty acts; inf if none waits."""
        return self._pending[0][0] if self._pending else inf

    def reach(self, substep: int) -> None:
        """Take it that the state has been brought to a substep by the world, and obey the duties whose turn it is."""
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
        if substep > self._substep:
            advance_in_place(
                self.state,
                substep - self._substep,
                self._duty,
                self._battery_v,
                self._load,
                self._tables,
                self._scalars,
            )
            self._substep = substep


class SimBattery(Battery):
    """The battery under the motors' load."""

    def __init__(self, open_v: float, source_ohm: float, motors: tuple[SimMotor, ...]) -> None:
        self._open_v = open_v
        self._source_ohm = source_ohm
        self._motors = motors

    def set_open(self, open_v: float) -> None:
        """Another open-circuit voltage from now on."""
        self._open_v = open_v

    def voltage_v(self) -> float:
        return self._open_v - self._source_ohm * sum(motor.draw_a() for motor in self._motors)


class SimBrick:
    """The robot without its program: two wheels at random phases, on the floor, at rest.

    seed: fixes start phases, the small differences between the motors, and the clock's jitter.
    clock: a VirtualClock by default, robot.motors.MonotonicClock for real time. motor: which set of
    motors.toml. battery_v: open-circuit voltage, nominal by default. mount: -1 for a motor that is
    mounted mirrored. jitter: whether the default clock is late as the brick is. scene: walls, one
    of which it faces, give or take how exactly a person places it; without any it has the floor for
    itself, and its tyres never slip.
    """

    def __init__(
        self,
        seed: int,
        *,
        clock: Clock | None = None,
        motor: str = "pybricks",
        battery_v: float | None = None,
        mount: tuple[int, int] = (1, 1),
        jitter: bool = True,
        scene: Scene | None = None,
    ) -> None:
        random = Random(f"brick {seed}")
        published = load(motor)
        open_v = _checked(published.battery_v if battery_v is None else battery_v)
        self.clock: Clock = VirtualClock(seed, jitter=jitter) if clock is None else clock
        self.seed = seed

        def specimen(name: str, side: int) -> SimMotor:
            spread, half = published.spread, published.backlash / 2
            constants = published.varied(
                random.uniform(1 - spread, 1 + spread), random.uniform(1 - spread, 1 + spread)
            )
            constants = constants if scene is None else alone(constants)
            angle, gap = random.uniform(0, 2 * pi), random.uniform(-half, half)
            if scene is not None:
                angle = 0.0 if name == "left" else side * scene.apart
            return SimMotor(name, self.clock, constants, open_v, side, angle, gap)

        self.motors = (specimen("left", mount[0]), specimen("right", mount[1]))
        self.battery = SimBattery(open_v, published.source_resistance, self.motors)
        self.world: World | None = None
        if scene is not None:
            askew = radians(data()["robot"]["placement"][0])
            self.world = World(scene, self.motors, random.uniform(-askew, askew))
            for wheel in self.motors:
                wheel.world = self.world

    def set_battery(self, open_v: float) -> None:
        """Another open-circuit voltage from now on.

        Raises ValueError for one that is no battery's.
        """
        _checked(open_v)
        for motor in self.motors:
            motor.set_supply(open_v)
        self.battery.set_open(open_v)

    def truth(self) -> tuple[Truth, Truth]:
        """The state of the left and the right wheel now."""
        left, right = self.motors
        return left.truth(), right.truth()

    def set_load(self, side: int, torque: float) -> None:
        """A torque (N m, forward positive) on the wheel of side 0 (left) or 1 (right) from now on."""
        self.motors[side].set_load(torque)


def _checked(open_v: float) -> float:
    if not 0.0 < open_v <= HIGHEST_BATTERY_V:
        raise ValueError(
            f"a battery of {open_v!r} V cannot drive the brick: give more than 0 and at most"
            f" {HIGHEST_BATTERY_V} V"
        )
    return open_v
