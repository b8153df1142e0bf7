"""A simulated brick: two motors under the robot, and a battery."""

from __future__ import annotations

from math import degrees, isfinite, pi, radians
from random import Random
from typing import TYPE_CHECKING

from robot.motors import Battery
from sim_motor.clock import Clock, VirtualClock
from sim_motor.constants import Constants, data, load
from sim_motor.scene import Scene
from sim_motor.wheel_motor import SimMotor, Truth

if TYPE_CHECKING:
    from sim_motor.world import World

HIGHEST_BATTERY_V = 10.0  # six fresh AA cells
HIGHEST_DITHER_DEG = 5.0


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

    Args:
        seed: Random seed of the start phases, of the small differences between the motors, and of
            the clock's jitter.
        clock: A VirtualClock by default; robot.motors.MonotonicClock for real time.
        motor: A table of motors.toml or of the user's own file, or a motor's constants.
        battery_v: Open-circuit voltage, V; nominal by default.
        mount: For each motor, -1 if it is mounted mirrored, else 1.
        jitter: Whether the default clock is late as the brick is.
        dither_deg: Standard deviation of an encoder's reading, degrees; the motor's own if None.
        scene: Two walls. The robot faces one, as exactly as a person places it. Without a scene it
            has the floor for itself, and its tyres never slip.
    """

    def __init__(
        self,
        seed: int,
        *,
        clock: Clock | None = None,
        motor: str | Constants = "pybricks",
        battery_v: float | None = None,
        mount: tuple[int, int] = (1, 1),
        jitter: bool = True,
        dither_deg: float | None = None,
        scene: Scene | None = None,
    ) -> None:
        random = Random(f"brick {seed}")
        model, published = (motor, load(motor)) if isinstance(motor, str) else ("", motor)
        open_v = _checked(published.battery_v if battery_v is None else battery_v)
        if scene is not None:  # only who has walls waits for compiled code
            from sim_motor.world import World, alone
        self.clock: Clock = VirtualClock(seed, jitter=jitter) if clock is None else clock
        self.seed = seed

        errors = Random(f"encoders {seed}")
        dither = degrees(published.dither) if dither_deg is None else dither_deg
        if not 0.0 <= dither <= HIGHEST_DITHER_DEG:
            raise ValueError(
                f"an encoder cannot dither by {dither!r} degrees: give a number from 0 to"
                f" {HIGHEST_DITHER_DEG:g}"
            )

        def specimen(name: str, side: int) -> SimMotor:
            spread, half = published.spread, published.backlash / 2
            constants = published.varied(
                random.uniform(1 - spread, 1 + spread), random.uniform(1 - spread, 1 + spread)
            )
            constants = constants.with_dither(dither, errors.getrandbits(32))
            constants = constants if scene is None else alone(constants)
            angle, gap = random.uniform(0, 2 * pi), random.uniform(-half, half)
            if scene is not None:
                angle = 0.0 if name == "left" else side * scene.apart
            return SimMotor(name, self.clock, constants, open_v, side, angle, gap, model)

        self.motors = (specimen("left", mount[0]), specimen("right", mount[1]))
        self.battery = SimBattery(open_v, published.source_resistance, self.motors)
        self.world: World | None = None
        if scene is not None:
            askew = radians(data()["robot"]["placement"][0])
            self.world = World(scene, self.motors, random.uniform(-askew, askew))
            for wheel in self.motors:
                wheel.world = self.world

    def set_battery(self, open_v: float) -> None:
        """Another open-circuit voltage (V) from now on.

        Raises:
            ValueError: No battery has this voltage.
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
        """A torque on a wheel from now on.

        Args:
            side: 0 for the left wheel, 1 for the right one.
            torque: In N m, forward positive.

        Raises:
            ValueError: It is no finite number.
        """
        if not isfinite(torque):
            raise ValueError(f"a load of {torque!r} N m cannot be: give a finite number")
        self.motors[side].set_load(torque)


def _checked(open_v: float) -> float:
    if not 0.0 < open_v <= HIGHEST_BATTERY_V:
        raise ValueError(
            f"a battery of {open_v!r} V cannot drive the brick: give more than 0 and at most"
            f" {HIGHEST_BATTERY_V} V"
        )
    return float(open_v)
