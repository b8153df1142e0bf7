"""The EV3 large motor, its gear train's play and its wheel, as pure scalar functions.

Electrical: L di/dt = V - R i - Ke w. Mechanical: J dw/dt = Kt i - B w - friction - contact. Between
events this is linear, so every substep of 1 ms applies the exact solution for constant V and
torque, tabulated for each duty cycle (sim_motor.exact_step). Events are resolved to the substep: a
stop, a break-away, a separation or an impact of the two sides of the backlash.

- The gearing sticks with a static torque above its kinetic (Coulomb) friction; the wheel's rolling
  friction is the same at rest.
- Motor and wheel touch at either end of the backlash. A touching pair moves as one while the
  contact pushes; impacts are plastic.
- Duty 0 shorts the motor (brake); COAST opens the circuit.

They run as they stand here, and compiled (sim_motor.compiled_motor), with the same bits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import copysign, floor, pi, sqrt
from typing import TYPE_CHECKING

from sim_motor.constants import SUBSTEP_S, SUBSTEPS_PER_S
from sim_motor.exact_step import COAST

if TYPE_CHECKING:
    from sim_motor.arrays import Array

    Row = Sequence[float] | Array
    # A motor's own of sim_motor.arrays.tables, or sim_motor.constants.Steps, which plain Python
    # reads fast.
    Tables = Array | Mapping[tuple[int, int], Row]

State = tuple[float, float, float, float, float, float]

SAMPLE_SUBSTEPS = 2  # the kernel samples the encoder at 500 Hz

# A wheel's state, as the fields of an array or as the arguments and the result of `advance`: motor
# angle, motor angle one substep before, motor speed, current, gap (motor angle - wheel angle,
# within half the backlash), wheel speed. rad, rad/s, A.
ANGLE, LAST_ANGLE, SPEED, CURRENT, GAP, WHEEL_SPEED = range(6)
# The array of constants beside it, see Constants.scalars.
TORQUE_CONSTANT, VISCOUS, KINETIC, STATIC, ROLLING, WHEEL_INERTIA, WHEEL_SHARE, HALF_PLAY = range(8)


def substep_at(time_s: float) -> int:
    """The number of whole substeps up to a time; rounding errors of the time do not count."""
    return floor(time_s * SUBSTEPS_PER_S + 1e-6)


def substep_from(time_s: float) -> int:
    """The first substep that begins at a time or after it."""
    return -floor(1e-6 - time_s * SUBSTEPS_PER_S)


def _mixed(number: int) -> int:
    """32 bits that look random, from 32 bits: multiplications and shifts, as in MurmurHash3."""
    number = ((number ^ number >> 16) * 0x85EBCA6B) & 0xFFFFFFFF
    number = ((number ^ number >> 13) * 0xC2B2AE35) & 0xFFFFFFFF
    return number ^ number >> 16


def _deviate(sample: int, seed: int) -> float:
    """A nearly normal random number (mean 0, deviation 1) that belongs to a sample.

    A generator's state would depend on who looks how often; this does not. It is the sum of four
    uniform numbers.
    """
    first = _mixed(sample & 0xFFFFFFFF ^ _mixed(seed & 0xFFFFFFFF))
    second = _mixed(first)
    parts = (first & 0xFFFF) + (first >> 16) + (second & 0xFFFF) + (second >> 16)
    return (parts / 65536 + 2.0 / 65536 - 2.0) * sqrt(3.0)


def encoder(
    substep: int,
    angle: float,
    last_angle: float,
    counts: float,
    dither: float = 0.0,
    seed: int = 0,
) -> int:
    """The tacho position in degrees that the kernel reports.

    It is half of the latest sample's counts, rounded towards zero as in C.

    Args:
        substep: Now.
        angle: The motor's angle, rad.
        last_angle: Its angle one substep ago, rad.
        counts: Of the encoder in a turn.
        dither: Standard deviation of the random error of a sample, rad.
        seed: Random seed of these errors.

    Returns:
        The position, degrees.
    """
    sampled = angle if substep % SAMPLE_SUBSTEPS == 0 else last_angle
    if dither > 0.0:
        sampled += dither * _deviate(substep // SAMPLE_SUBSTEPS, seed)
    raw = floor(sampled * counts / (2 * pi))
    return raw // 2 if raw >= 0 else -(-raw // 2)


def _sense(speed: float, torque: float, static: float) -> float:
    """The sign of the motion that friction opposes.

    It is 0 for what rests and stays at rest under this torque.
    """
    if speed != 0.0:
        return copysign(1.0, speed)
    return copysign(1.0, torque) if abs(torque) > static else 0.0


def _leaves(sense: float, speed: float, drive: float, load: float, end: float, c: Row) -> bool:
    """Whether a touching pair parts: its contact, at this end of the play, would have to pull."""
    side = copysign(1.0, end)
    if sense == 0.0:
        leaves: bool = -side * drive > c[STATIC] or side * load > c[ROLLING]
    else:
        net = drive + load - c[VISCOUS] * speed - (c[KINETIC] + c[ROLLING]) * sense
        leaves = side * (c[WHEEL_SHARE] * net + c[ROLLING] * sense - load) < 0.0
    return leaves


def _turn_motor(
    sense: float, speed: float, current: float, volts: float, torque: float, row: Row
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


def _turn_wheel(sense: float, speed: float, acceleration: float) -> tuple[float, float]:
    """(turned angle, speed) of a wheel within the play after a substep.

    Friction cannot reverse it: it stops instead.
    """
    new_speed = speed + SUBSTEP_S * acceleration
    if new_speed * sense > 0.0:
        return 0.5 * SUBSTEP_S * (speed + new_speed), new_speed
    return (0.5 * SUBSTEP_S * speed * speed / (speed - new_speed) if speed != 0.0 else 0.0), 0.0


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
    tables: Tables,
    c: Row,
) -> State:
    """The state of one wheel after some substeps.

    A touching pair at rest starts at the gearing's static plus the rolling friction.

    Args:
        substeps: How many.
        duty: Duty cycle in all of them, % or COAST.
        battery_v: Open-circuit voltage of the battery, V.
        load: Torque on the wheel, N m.
        angle: The motor's angle, rad.
        last_angle: Its angle one substep ago, rad.
        speed: Its speed, rad/s.
        current: Its current, A.
        gap: How far the motor is ahead of the wheel, rad.
        wheel_speed: The wheel's speed, rad/s.
        tables: The motor's steps.
        c: Constants.scalars of the motor.

    Returns:
        The last six before the tables, after the substeps.
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
