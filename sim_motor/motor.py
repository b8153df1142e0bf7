"""The EV3 large motor, its gear train's play and the wheel with its share of the robot, as compiled scalar functions.

Electrical: L di/dt = V - R i - Ke w. Mechanical: J dw/dt = Kt i - B w - friction - contact. Between
events this is linear, so every substep of 1 ms applies the exact solution for constant V and
torque, tabulated for each duty cycle. Events are resolved to the substep: a stop, a break-away, a
separation or an impact of the two sides of the backlash.

- The battery's sag is a resistance in the motor's circuit. A motor at duty d draws d i from the
  battery, and the other is taken to
  draw as much; so a wheel can be computed alone, exactly as long as both wheels work equally hard.
- The body's mass is taken to sit over the wheels, half at each (radius of gyration = half the
  track): then driving and turning
  decouple, and each wheel carries wheel inertia + mass/2 radius^2 by itself.
- The gearing sticks with a static torque above its kinetic (Coulomb) friction; the wheel's rolling
  friction is the same at rest.
- Motor and wheel touch at either end of the backlash. A touching pair moves as one while the
  contact pushes; impacts are plastic.
- Duty 0 shorts the motor (brake); COAST opens the circuit.
"""

import tomllib
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from math import copysign, floor, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim_motor.compiled import inlined_jit
from sim_motor.own_motors import own_motor

Array = NDArray[np.float64]
State = tuple[float, float, float, float, float, float]

SUBSTEPS_PER_S = 1000
SUBSTEP_S = 1.0 / SUBSTEPS_PER_S
SAMPLE_SUBSTEPS = 2  # the kernel samples the encoder at 500 Hz
COAST = 101  # in place of a duty cycle
GRAVITY = 9.81

# A wheel's state, as the fields of an array or as the arguments and the result of `advance`: motor
# angle, motor angle one substep before, motor speed, current, gap (motor angle - wheel angle,
# within half the backlash), wheel speed. rad, rad/s, A.
ANGLE, LAST_ANGLE, SPEED, CURRENT, GAP, WHEEL_SPEED = range(6)
# The array of constants beside it, see Constants.scalars.
TORQUE_CONSTANT, VISCOUS, KINETIC, STATIC, ROLLING, WHEEL_INERTIA, WHEEL_SHARE, HALF_PLAY = range(8)


@dataclass(frozen=True)
class Constants:
    """One motor with its wheel and its share of the robot.

    SI units, torques and inertias at the output shaft.
    """

    torque_constant: float
    emf_constant: float
    resistance: float
    inductance: float
    motor_inertia: float
    viscous: float
    kinetic: float
    static: float
    wheel_inertia: float  # of the wheel and of half the body, which the wheel carries
    rolling: float
    backlash: float
    source_resistance: float
    battery_v: float
    latency_s: float
    encoder_counts: float
    wheel_radius: float
    spread: float

    def bare(self) -> "Constants":
        """The motor alone on a stiff supply: no wheel to speak of, no floor, no backlash."""
        return replace(self, wheel_inertia=1e-9, rolling=0.0, backlash=0.0, source_resistance=0.0)

    def with_wheel(self, inertia: float) -> "Constants":
        """With a wheel of this moment of inertia (kg m2), which then carries nothing else."""
        return replace(self, wheel_inertia=inertia)

    def varied(self, strength: float, friction: float) -> "Constants":
        """Another specimen: torque and friction by these factors.

        What starts to move at which duty stays as it is.
        """
        return replace(
            self,
            torque_constant=self.torque_constant * strength,
            kinetic=self.kinetic * friction,
            static=self.static * strength,
        )

    def specimens(self, count: int, rng: np.random.Generator) -> "tuple[Constants, ...]":
        """So many specimens at random, within the published spread."""
        factors = rng.uniform(1 - self.spread, 1 + self.spread, (count, 2))
        return tuple(self.varied(*pair) for pair in factors.tolist())

    def scalars(self) -> Array:
        """What `advance` needs besides the tables."""
        share = self.wheel_inertia / (self.motor_inertia + self.wheel_inertia)
        half = self.backlash / 2
        return np.array(
            [
                self.torque_constant,
                self.viscous,
                self.kinetic,
                self.static,
                self.rolling,
                self.wheel_inertia,
                share,
                half,
            ]
        )

    def tables(self) -> Array:
        """Exact solutions over one substep.

        (motor alone or with wheel, |duty| in % or COAST, coefficient).

        Coefficients: new speed from speed, current, voltage, torque; new current from the same;
        turned angle from the same; and the new current of a locked motor from current and voltage.
        """
        duty = np.arange(COAST) / 100
        ohms = self.resistance + 2 * self.source_resistance * duty**2
        out = np.zeros((2, COAST + 1, 14))
        for side, inertia in enumerate(
            (self.motor_inertia, self.motor_inertia + self.wheel_inertia)
        ):
            system = np.zeros(
                (COAST + 1, 5, 5)
            )  # of speed, current, angle and the constant voltage and torque
            system[:, 0, 0] = -self.viscous / inertia
            system[:, 0, 4] = 1 / inertia
            system[:, 2, 0] = 1
            system[:COAST, 0, 1] = self.torque_constant / inertia
            system[:COAST, 1, 0] = -self.emf_constant / self.inductance
            system[:COAST, 1, 1] = -ohms / self.inductance
            system[:COAST, 1, 3] = 1 / self.inductance
            solution = _exponential(system * SUBSTEP_S)
            out[side, :, :12] = solution[:, :3][:, :, (0, 1, 3, 4)].reshape(-1, 12)
            out[side, :COAST, 12] = np.exp(-ohms / self.inductance * SUBSTEP_S)
            out[side, :COAST, 13] = (1 - out[side, :COAST, 12]) / ohms
        return out


def _exponential(matrices: Array) -> Array:
    """exp of each matrix in a stack, by its series at a 256th of the size, squared eight times."""
    small = matrices / 256
    term, out = small, np.eye(small.shape[-1]) + small
    order = 1
    while True:
        order += 1
        term = term @ small / order
        before, out = out, out + term
        # From the sixth power on every entry that can differ from 0 does, and terms only shrink.
        if order > 6 and np.array_equal(out, before):
            break
    for _ in range(8):
        out = out @ out
    return out


@cache
def data() -> dict[str, dict[str, list[Any]]]:
    """The data file: tables of name -> [value, unit, source]. Not to be changed."""
    return tomllib.loads((files("sim_motor") / "motors.toml").read_text())


def names() -> list[str]:
    """The published motors there are; the first is the default."""
    return [table for table in data() if table != "robot"]


def load(name: str = "pybricks") -> Constants:
    """The motor `name` in the robot.

    A published one, or a user's own, whose values of the robot come before the published ones.

    Raises ValueError, in words, for a name that nobody has, and for an own one that is not as it
    should be.
    """
    published = data()
    entry = published[name] if name in names() else own_motor(name, published)
    values = {key: float(row[0]) for key, row in {**published["robot"], **entry}.items()}
    share = values["mass"] / 2
    rolling = values["rolling_resistance"] * share * GRAVITY * values["wheel_radius"]
    start_v = values["break_away_duty"] / 100 * values["battery_voltage"]
    return Constants(
        torque_constant=values["torque_constant"],
        emf_constant=values["emf_constant"],
        resistance=values["resistance"],
        inductance=values["inductance"],
        motor_inertia=values["inertia"],
        viscous=values["viscous_friction"],
        kinetic=values["coulomb_friction"],
        static=values["torque_constant"] * start_v / values["resistance"] - rolling,
        wheel_inertia=values["wheel_inertia"] + share * values["wheel_radius"] ** 2,
        rolling=rolling,
        backlash=values["backlash"] * pi / 180,
        source_resistance=values["source_resistance"],
        battery_v=values["battery_voltage"],
        latency_s=values["latency"],
        encoder_counts=values["encoder_counts"],
        wheel_radius=values["wheel_radius"],
        spread=values["spread"],
    )


@inlined_jit
def substep_at(time_s: float) -> int:
    """The number of whole substeps up to a time; one that is missing by rounding counts."""
    return floor(time_s * SUBSTEPS_PER_S + 1e-6)


@inlined_jit
def substep_from(time_s: float) -> int:
    """The first substep that begins at a time or after it."""
    return -floor(1e-6 - time_s * SUBSTEPS_PER_S)


@inlined_jit
def encoder(substep: int, angle: float, last_angle: float, counts: float) -> int:
    """The tacho position in degrees that the kernel reports.

    Counts of the latest sample, halved with C's truncation.
    """
    sampled = angle if substep % SAMPLE_SUBSTEPS == 0 else last_angle
    raw = floor(sampled * counts / (2 * pi))
    return raw // 2 if raw >= 0 else -(-raw // 2)


@inlined_jit
def _sense(speed: float, torque: float, static: float) -> float:
    """The sign of the motion that friction opposes.

    0 for what is at rest and stays so under this torque.
    """
    if speed != 0.0:
        return copysign(1.0, speed)
    return copysign(1.0, torque) if abs(torque) > static else 0.0


@inlined_jit
def _leaves(sense: float, speed: float, drive: float, load: float, end: float, c: Array) -> bool:
    """Whether a touching pair parts: its contact, at this end of the play, would have to pull."""
    side = copysign(1.0, end)
    if sense == 0.0:
        leaves: bool = -side * drive > c[STATIC] or side * load > c[ROLLING]
    else:
        net = drive + load - c[VISCOUS] * speed - (c[KINETIC] + c[ROLLING]) * sense
        leaves = side * (c[WHEEL_SHARE] * net + c[ROLLING] * sense - load) < 0.0
    return leaves


@inlined_jit
def _turn_motor(
    sense: float, speed: float, current: float, volts: float, torque: float, row: Array
) -> tuple[float, float, float]:
    """(turned angle, speed, current) after a substep.

    Friction, part of the torque, cannot reverse it: it stops instead.
    """
    new_speed = row[0] * speed + row[1] * current + (row[2] * volts + row[3] * torque)
    if new_speed * sense > 0.0:
        turned = row[8] * speed + row[9] * current + (row[10] * volts + row[11] * torque)
        return (
            turned,
            new_speed,
            row[4] * speed + row[5] * current + (row[6] * volts + row[7] * torque),
        )
    turned = 0.5 * SUBSTEP_S * speed * speed / (speed - new_speed) if speed != 0.0 else 0.0
    return turned, 0.0, row[12] * current + row[13] * volts


@inlined_jit
def _turn_wheel(sense: float, speed: float, acceleration: float) -> tuple[float, float]:
    """(turned angle, speed) of a wheel within the play after a substep.

    Friction cannot reverse it either.
    """
    new_speed = speed + SUBSTEP_S * acceleration
    if new_speed * sense > 0.0:
        return 0.5 * SUBSTEP_S * (speed + new_speed), new_speed
    return (0.5 * SUBSTEP_S * speed * speed / (speed - new_speed) if speed != 0.0 else 0.0), 0.0


@inlined_jit
def advance(
    substeps: int,
    duty: int,
    battery_v: float,
    load: float,
    angle: float,
    last_angle: float,
    speed: float,
    current: float,
    gap: float,
    wheel_speed: float,
    tables: Array,
    c: Array,
) -> State:
    """The state of one wheel after some substeps at a constant duty (% or COAST), battery voltage and load torque (N m) on the wheel.

    tables, c: of the wheel's Constants. A touching pair at rest starts at the gearing's static plus
    the rolling friction.
    """
    volts = battery_v * duty / 100
    if duty == COAST:
        current = 0.0  # and the tables leave it there
    half = c[HALF_PLAY]
    while substeps > 0:
        drive = c[TORQUE_CONSTANT] * current
        sense = _sense(speed, drive + load, c[STATIC] + c[ROLLING])
        if (
            speed == wheel_speed
            and abs(gap) >= half
            and not _leaves(sense, speed, drive, load, gap, c)
        ):
            torque = load - (c[KINETIC] + c[ROLLING]) * sense
            together = True
            while together:
                last_angle = angle
                turned, speed, current = _turn_motor(
                    sense, speed, current, volts, torque, tables[1, abs(duty)]
                )
                angle += turned
                substeps -= 1
                drive = c[TORQUE_CONSTANT] * current
                together = (
                    substeps > 0 and speed != 0.0 and not _leaves(sense, speed, drive, load, gap, c)
                )
            wheel_speed = speed
            continue
        last_angle = angle
        substeps -= 1
        sense = _sense(speed, drive, c[STATIC])
        turned, speed, current = _turn_motor(
            sense, speed, current, volts, -c[KINETIC] * sense, tables[0, abs(duty)]
        )
        sense = _sense(wheel_speed, load, c[ROLLING])
        wheel_turned, wheel_speed = _turn_wheel(
            sense, wheel_speed, (load - c[ROLLING] * sense) / c[WHEEL_INERTIA]
        )
        angle += turned
        gap += turned - wheel_turned
        if abs(gap) >= half:
            # The impact came within the substep: since then the pair's common centre of inertia has
            # moved on, and only that.
            end = copysign(half, gap)
            angle -= c[WHEEL_SHARE] * (gap - end)
            gap = end
            if copysign(1.0, gap) * (speed - wheel_speed) > 0.0:
                speed = wheel_speed = speed + c[WHEEL_SHARE] * (wheel_speed - speed)
    return angle, last_angle, speed, current, gap, wheel_speed


@inlined_jit
def advance_in_place(
    state: Array, substeps: int, duty: int, battery_v: float, load: float, tables: Array, c: Array
) -> None:
    """`advance` for a state kept in an array."""
    state[0], state[1], state[2], state[3], state[4], state[5] = advance(
        substeps,
        duty,
        battery_v,
        load,
        state[0],
        state[1],
        state[2],
        state[3],
        state[4],
        state[5],
        tables,
        c,
    )
