"""Fits a motor to a log: to the duties that were written and the angles that were read.

The motor's own model is driven with the logged duties at their logged times. Its traits are varied
until its angles are the logged ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import stdtrit

from host.errors import NotDone
from host.experiments.robot.motor_traits import Traits, constants_of, traits
from host.util.intervals import CONFIDENCE
from sim_motor.arrays import Array, scalars, tables
from sim_motor.compiled import jit
from sim_motor.compiled_motor import advance, substep_at, substep_from
from sim_motor.constants import Constants
from sim_motor.motor import ANGLE, LAST_ANGLE, SAMPLE_SUBSTEPS

Interval = tuple[float, float]


@dataclass(frozen=True)
class Drive:
    """A wheel's log from rest on, one value a tick.

    Only the motion within a stretch counts, not where the wheel stands.

    Attributes:
        times: time (s), (ticks,).
        angles: angle (rad), (ticks,); see `middle`.
        duties: duty cycle (%), (ticks,).
        stretches: number of the stretch, (ticks,). A stretch begins and ends at rest.
    """

    times: Array
    angles: Array
    duties: NDArray[np.int64]
    stretches: NDArray[np.int64]


def middle(reading_rad: Array, polarity: int) -> Array:
    """The angles (rad) to expect where the encoder reads these: the middles of their ranges.

    Args:
        reading_rad: readings (rad), (ticks,).
        polarity: 1, or -1 for a motor that is mounted mirrored; see sim_motor.motor.encoder.
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


# The traits that are fitted; `break_away` finds the static friction. For each: how far it is moved
# to see its effect, and its bounds.
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
_LOWEST = np.array([0.2, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0])
_HIGHEST = np.array([20.0, 2.0, 0.9, 60.0, 2.0, 30.0, 20.0])
_COUNT = radians(1)
# Sums of traits with less effect than this are not seen; a trait with this share in one is not.
_LEAST_SIZE, _LEAST_SHARE = 1e-10, 1e-4
LEAST_STRETCHES = 2 * len(_FITTED)


@dataclass(frozen=True)
class Found:
    """What was found of one wheel.

    Attributes:
        traits: the motor's traits.
        intervals: where each trait lies with a confidence of 95 %.
        rms_deg: rms difference between the fitted model and the readings (degrees).
    """

    traits: Traits
    intervals: dict[str, Interval]
    rms_deg: float


def follow(drive: Drive, constants: Constants) -> Array:
    """The angles (rad), (ticks,), of a motor with these constants that gets the logged duties.

    In each stretch their mean is that of the logged angles.
    """
    c = constants
    (own_tables,), (own_scalars,) = tables([c]), scalars([c])
    angles = _follow(drive.times, c.latency_s, drive.duties, c.battery_v, own_tables, own_scalars)
    return np.asarray(angles + _stretch_means(drive.angles - angles, drive.stretches))


def _stretch_means(values: Array, stretches: NDArray[np.int64]) -> Array:
    """For each value the mean over its stretch."""
    place = np.unique(stretches, return_inverse=True)[1]
    return np.asarray((np.bincount(place, values) / np.bincount(place))[place])


def break_away(drive: Drive, ramps: Sequence[int]) -> Interval:
    """Find between which duties (%) a wheel that rests begins to move.

    The lowest duty that no longer held the wheel is at most one step above the highest that did.
    Where the stretches differ, the interval covers them all.

    Args:
        drive: the wheel's drive.
        ramps: numbers of the stretches in which the duty rises slowly from 0.

    Raises:
        NotDone: There are no stretches of this kind, or the wheel did not move in one of them.
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
    """Fit a wheel's traits.

    The intervals are those of the linearized fit. Each stretch counts as one observation in it, as
    what disturbs a wheel disturbs its neighbouring ticks too.

    Args:
        drive: the wheel's drive.
        steps: marks the ticks to fit, (ticks,).
        static: the static friction (% duty), from `break_away`.
        published: the motor that gives what the traits leave open, and the first guess.
        battery_v: voltage of the battery (V).

    Raises:
        NotDone: There are too few stretches.
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
        angles = follow(drive, constants_of(moved, published, battery_v))
        return np.degrees(angles - drive.angles)[steps]

    def slopes(x: Array) -> Array:
        columns = [
            (errors(x + step) - errors(x - step)) / (2 * step.sum()) for step in np.diag(_STEPS)
        ]
        return np.stack(columns, axis=1)

    guess = np.array([getattr(start, name) for name in _FITTED])
    fit = least_squares(errors, guess, slopes, bounds=(_LOWEST, _HIGHEST), x_scale=_STEPS)
    half = half_intervals(fit.jac, fit.fun, stretches)
    low = np.maximum(fit.x - half, _LOWEST).tolist()
    high = np.minimum(fit.x + half, _HIGHEST).tolist()
    intervals = dict(zip(_FITTED, zip(low, high, strict=True), strict=True))
    intervals["static_pct"] = static
    return Found(
        start._replace(**dict(zip(_FITTED, fit.x.tolist(), strict=True))),
        {name: intervals[name] for name in Traits._fields},
        float(np.sqrt(np.mean(fit.fun**2))),
    )


def half_intervals(jacobian: Array, errors: Array, stretches: NDArray[np.int64]) -> Array:
    """How far each trait may be from what was fitted, with a confidence of 95 %.

    Args:
        jacobian: effect of each trait on the errors, (ticks, traits).
        errors: what the fit leaves, (ticks,).
        stretches: number of the stretch, (ticks,). There are more of them than traits.

    Returns:
        Half the width of each interval, (traits,). It is infinite for a trait without any effect,
        as friction below that of rolling alone, and for traits whose effects are the same.
    """
    numbers = np.unique(stretches)
    spare = len(numbers) - jacobian.shape[1]
    effect = np.linalg.norm(jacobian, axis=0)
    # Each in its own unit, as traits of large effect would drown the others in rounding.
    unit = np.where(effect > 0.0, effect, 1.0)
    left, sizes, right = np.linalg.svd(jacobian / unit, full_matrices=False)
    seen = sizes > _LEAST_SIZE * sizes[0]
    influence = right[seen].T / sizes[seen] @ left[:, seen].T
    moved = [influence[:, rows] @ errors[rows] for rows in (stretches == n for n in numbers)]
    deviation = np.sqrt(np.sum(np.square(moved), axis=0) * len(numbers) / spare) / unit
    half = stdtrit(spare, (1 + CONFIDENCE) / 2) * deviation
    return np.where((np.abs(right[~seen]) > _LEAST_SHARE).any(axis=0), np.inf, half)
