"""A motor's constants from what a log shows of it.

The duties that were written, and the angles that were read.

The motor's own model is driven with the logged duties at their logged times, and its constants are
varied until its angles are the logged ones. Duties and angles alone cannot tell all constants
apart, for no torque is measured: a motor twice as strong in a robot twice as heavy moves the same.
What they do tell is the Traits; what they do not is taken from a published motor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import t as student

from host.errors import NotDone
from host.util.intervals import CONFIDENCE
from sim_motor.compiled import jit
from sim_motor.motor import (
    ANGLE,
    LAST_ANGLE,
    SAMPLE_SUBSTEPS,
    Array,
    Constants,
    advance,
    substep_at,
    substep_from,
)

Interval = tuple[float, float]
# Kg m2; of a lighter motor, the wheel and its share of the robot would have been taken too heavy
_LEAST_INERTIA = 1e-5


class Traits(NamedTuple):
    """What can be told of a motor with its wheel from duties and angles, at a known voltage of the battery.

    speed_per_v: no-load speed in rad/s for each volt, without friction that does not grow with
    speed. time_constant_s: in which speed settles while the motor is shorted; the coil's own, L/R,
    makes it shorter by as much, to first order. viscous_part: of the damping, the rest is the
    motor's as a generator. static_pct, kinetic_pct: friction of the gearing and on the floor
    together, in % duty. sag: 2 source resistance / resistance. delay_ms: from the tick in which an
    angle is read until the duty that follows from it acts, and then L/R, from which it cannot be
    told apart. backlash_deg: as it shows by the wheel's part in the inertia, which is published.
    """

    speed_per_v: float
    time_constant_s: float
    viscous_part: float
    static_pct: float
    kinetic_pct: float
    sag: float
    delay_ms: float
    backlash_deg: float


def traits(constants: Constants, battery_v: float) -> Traits:
    """The traits of a motor with these constants."""
    c = constants
    slope = c.torque_constant / c.resistance  # N m/V
    damping = slope * c.emf_constant + c.viscous
    pct = 100 / (slope * battery_v)
    return Traits(
        speed_per_v=slope / damping,
        time_constant_s=(c.motor_inertia + c.wheel_inertia) / damping - c.inductance / c.resistance,
        viscous_part=c.viscous / damping,
        static_pct=(c.static + c.rolling) * pct,
        kinetic_pct=(c.kinetic + c.rolling) * pct,
        sag=2 * c.source_resistance / c.resistance,
        delay_ms=1000 * (c.latency_s + c.inductance / c.resistance),
        backlash_deg=degrees(c.backlash),
    )


def constants_of(found: Traits, published: Constants, battery_v: float) -> Constants:
    """The motor of these traits; what they leave open is as published.

    Torque constant, coil, and the robot's body.
    """
    p = published
    slope = p.torque_constant / p.resistance
    damping = slope / found.speed_per_v
    newton_metre = slope * battery_v / 100
    return replace(
        p,
        emf_constant=damping * (1 - found.viscous_part) / slope,
        viscous=damping * found.viscous_part,
        motor_inertia=max(
            _LEAST_INERTIA,
            (found.time_constant_s + p.inductance / p.resistance) * damping - p.wheel_inertia,
        ),
        static=max(0.0, found.static_pct * newton_metre - p.rolling),
        kinetic=max(0.0, found.kinetic_pct * newton_metre - p.rolling),
        source_resistance=found.sag * p.resistance / 2,
        latency_s=max(0.0, found.delay_ms / 1000 - p.inductance / p.resistance),
        backlash=radians(found.backlash_deg),
        battery_v=battery_v,
    )


@dataclass(frozen=True)
class Drive:
    """A wheel's log from rest on, one value a tick.

    Time (s), angle (rad, see `middle`), duty (%), and the number of its stretch.

    A stretch begins and ends at rest. Only how the wheel moves within it counts, not where it
    stands.
    """

    times: Array
    angles: Array
    duties: NDArray[np.int64]
    stretches: NDArray[np.int64]


def middle(reading_rad: Array, polarity: int) -> Array:
    """Where in the range that gives this reading the angle is to be expected (rad).

    See sim_motor.motor.encoder.
    """
    count = np.rint(polarity * np.degrees(reading_rad))
    return np.asarray(
        polarity * np.radians(count + np.select([count > 0, count == 0], [0.5, 0.25], 0.0))
    )


@jit
def _follow(
    times: Array, latency_s: float, duties: NDArray[np.int64], volts: float, tables: Array, c: Array
) -> Array:
    """The motor's angle (rad) as the encoder samples it at these times, from rest at angle 0."""
    angles = np.empty(len(times))
    state = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    substep, duty, pending = substep_at(times[0]), 0, 0
    for tick in range(len(times)):
        present = substep_at(times[tick])
        while pending < tick and substep_from(times[pending] + latency_s) <= present:
            turn = substep_from(times[pending] + latency_s)
            state = advance(turn - substep, duty, volts, 0.0, *state, tables, c)
            substep, duty = turn, duties[pending]
            pending += 1
        state = advance(present - substep, duty, volts, 0.0, *state, tables, c)
        substep = present
        angles[tick] = state[ANGLE] if substep % SAMPLE_SUBSTEPS == 0 else state[LAST_ANGLE]
    return angles


# The traits that are fitted; the static friction is not, see `break_away`. How far each is moved to
# see what it does, and its bounds.
_FITTED = (
    "speed_per_v",
    "time_constant_s",
    "viscous_part",
    "kinetic_pct",
    "sag",
    "delay_ms",
    "backlash_deg",
)
_STEPS = np.array([0.005, 0.002, 0.01, 0.2, 0.02, 0.5, 0.5])
_LOWEST, _HIGHEST = (
    np.array([0.2, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0]),
    np.array([20.0, 2.0, 0.9, 60.0, 2.0, 30.0, 20.0]),
)
_COUNT = radians(1)
LEAST_STRETCHES = 2 * len(_FITTED)


@dataclass(frozen=True)
class Found:
    """Traits, where each lies with a confidence of 95 %, and how far (rms, degrees) the fitted model is from the readings."""

    traits: Traits
    intervals: dict[str, Interval]
    rms_deg: float


def follow(drive: Drive, constants: Constants) -> Array:
    """The angles (rad) of a motor with these constants that is driven so, level with the logged ones in the mean of each stretch."""
    c = constants
    angles = _follow(drive.times, c.latency_s, drive.duties, c.battery_v, c.tables(), c.scalars())
    return np.asarray(angles + _stretch_means(drive.angles - angles, drive.stretches))


def _stretch_means(values: Array, stretches: NDArray[np.int64]) -> Array:
    """For each value the mean over its stretch."""
    place = np.unique(stretches, return_inverse=True)[1]
    return np.asarray((np.bincount(place, values) / np.bincount(place))[place])


def break_away(drive: Drive, ramps: Sequence[int]) -> Interval:
    """Between which duties (%) a wheel that rests begins to move.

    In these stretches the duty rises slowly from nothing.

    The lowest duty that no longer held the wheel is at most one step above the highest that did;
    where the stretches differ, all that they found. Raises NotDone.
    """
    if not ramps:
        raise NotDone(
            "the drive was over before the duty was raised slowly even once",
            "drive for longer: --seconds",
        )
    held, moved = [], []
    for number in ramps:
        rows = drive.stretches == number
        angles, duties = drive.angles[rows], np.abs(drive.duties[rows])
        first = int(np.argmax(np.abs(angles - angles[0]) > _COUNT / 2))
        if first == 0:
            raise NotDone(
                "a wheel did not move at all while its duty was raised",
                "is it free, and is the battery charged?",
            )
        moved.append(float(duties[first - 1]))
        held.append(float(max(duties[:first][duties[:first] < duties[first - 1]], default=0.0)))
    return min(held), max(moved)


def identify(
    drive: Drive, steps: NDArray[np.bool_], static: Interval, published: Constants, battery_v: float
) -> Found:
    """Fit a wheel's traits to the ticks marked in `steps`.

    The static friction is known from `break_away`.

    Intervals are those of the linearized fit, in which each stretch of the log counts as one
    observation, as what disturbs a wheel disturbs its neighbouring ticks too. Raises NotDone.
    """
    stretches = drive.stretches[steps]
    numbers = np.unique(stretches)
    if len(numbers) < LEAST_STRETCHES:
        raise NotDone(
            f"{len(numbers)} stretches of motion are too few to calibrate from",
            "drive for longer: --seconds",
        )
    start = traits(published, battery_v)._replace(static_pct=sum(static) / 2)

    def errors(x: Array) -> Array:
        moved = start._replace(**dict(zip(_FITTED, x.tolist(), strict=True)))
        return np.degrees(follow(drive, constants_of(moved, published, battery_v)) - drive.angles)[
            steps
        ]

    def slopes(x: Array) -> Array:
        return np.stack(
            [(errors(x + step) - errors(x - step)) / (2 * step.sum()) for step in np.diag(_STEPS)],
            axis=1,
        )

    guess = np.array([getattr(start, name) for name in _FITTED])
    fit = least_squares(errors, guess, slopes, bounds=(_LOWEST, _HIGHEST), x_scale=_STEPS)
    scores = np.stack(
        [fit.jac[stretches == number].T @ fit.fun[stretches == number] for number in numbers]
    )
    inverse = np.linalg.pinv(fit.jac.T @ fit.jac)
    spare = len(numbers) - len(_FITTED)
    variance = inverse @ (scores.T @ scores) @ inverse * len(numbers) / spare
    half = student.ppf((1 + CONFIDENCE) / 2, spare) * np.sqrt(np.diag(variance))
    low, high = (
        np.maximum(fit.x - half, _LOWEST).tolist(),
        np.minimum(fit.x + half, _HIGHEST).tolist(),
    )
    intervals = {
        "static_pct": static,
        **dict(zip(_FITTED, zip(low, high, strict=True), strict=True)),
    }
    found = start._replace(**dict(zip(_FITTED, fit.x.tolist(), strict=True)))
    return Found(
        found,
        {name: intervals[name] for name in Traits._fields},
        float(np.sqrt(np.mean(fit.fun**2))),
    )
