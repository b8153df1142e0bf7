"""Thousands of wheels at once: the controller and the motor compiled into one loop, spread over all cores.

Each wheel runs as in robot.loop on a SimBrick, from the same functions: same readings, same arithmetic, same latency. It stands
alone, which the motor's model allows (see sim_motor.motor). Only a link, a lease and a fault have no place here.
"""

from dataclasses import dataclass
from math import nan, pi

import numpy as np
from numpy.typing import NDArray

from robot import kicks
from robot.controller import step_wheel
from robot.kicks import DIRECTION_TICKS, JUMP, MEMBRANE, NO_PULSE, Kick
from robot.loop import SHORTEST_STEP_TICKS
from robot.params import LONGEST_STEP_TICKS, Params
from robot.safety import limit_duty
from sim_motor.brick import lateness_s
from sim_motor.compiled import compiled, parallel_jit, prange
from sim_motor.motor import Array, Constants, advance, encoder, load, substep_at, substep_from

_step_wheel, _limit_duty = compiled(step_wheel), compiled(limit_duty)
_direction, _reversing_shift = compiled(kicks.direction), compiled(kicks.reversing_shift)
_invert_membrane, _jump = compiled(kicks.invert_membrane), compiled(kicks.jump)
_seen_positions, _pulse_weight, _pulsed = compiled(kicks.seen_positions), compiled(kicks.pulse_weight), compiled(kicks.pulsed)

CHANNELS = ("phi_rad", "x1", "x2", "force", "torque", "duty_pct")
NO_KICK, FROZEN_MEMBRANE, FROZEN_JUMP_1, FROZEN_JUMP_2, QUENCHED = range(5)
# A wheel has settled when its speed, over DIRECTION_TICKS ticks, stays within this part of what it is in the end.
SETTLED_WITHIN = 0.1
PHASE_SHIFT = nan  # a kick's value that stands for: the shift that turns this wheel around


@dataclass(frozen=True)
class Start:
    """Where wheels begin: states as in sim_motor.motor (wheels, 6), and membrane potentials (wheels, 2)."""

    states: Array
    potentials: Array


@dataclass(frozen=True)
class Result:
    """What became of each wheel. `before`, `after`: its direction when the kick began and in the end; `settled_s`: time from the
    kick's first tick until it has settled; `records`: CHANNELS of each tick of the first wheels, (recorded wheels, ticks, channel).
    """

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    settled_s: Array
    records: Array
    times: Array
    end: Start

    @property
    def reversed(self) -> NDArray[np.bool_]:
        """Which wheels ran before the kick and run the other way now."""
        return (self.before != 0) & (self.after == -self.before)


def random_start(wheels: int, rng: np.random.Generator, constants: Constants) -> Start:
    """Wheels at rest at a random phase, anywhere in their play, with potentials that remember a random angle."""
    states = np.zeros((wheels, 6))
    states[:, 0] = states[:, 1] = rng.uniform(0, 2 * pi, wheels)
    states[:, 4] = rng.uniform(-constants.backlash / 2, constants.backlash / 2, wheels)
    remembered = rng.uniform(-pi, pi, wheels)
    return Start(states, np.stack((np.cos(remembered), np.sin(remembered)), axis=1))


def random_times(rows: int, ticks: int, tick_s: float, rng: np.random.Generator) -> Array:
    """When each tick begins (s): on the grid of deadlines, late as on the brick; (rows, ticks)."""
    return np.arange(ticks) * tick_s + np.vectorize(lateness_s)(rng.standard_normal((rows, ticks)))


def run(
    wheels: int,
    ticks: int,
    seed: int,
    *,
    params: Params | None = None,
    kick: Kick | None = None,
    motors: tuple[Constants, ...] | None = None,
    battery_v: float | None = None,
    start: Start | None = None,
    times: Array | None = None,
    record: int = 0,
) -> Result:
    """Run wheels for some ticks, each by itself; `kick` acts on all of them with its value for the left wheel.

    A pulse of the shift with the value PHASE_SHIFT takes for each wheel the sign that turns it around. motors: wheel number i is
    motors[i % len(motors)]; the default motor if None. start, times (1 or `wheels`, ticks): random from `seed` if None. record:
    how many wheels to record. Raises ValueError if a kick's tick is out of range or a duty would act after the next tick.
    """
    params = params or Params()
    motors = motors or (load(),)
    rng = np.random.default_rng(seed)
    start = start or random_start(wheels, rng, motors[0])
    times = random_times(wheels, ticks, params.tick_s, rng) if times is None else np.ascontiguousarray(np.atleast_2d(times))
    if start.states.shape != (wheels, 6) or start.potentials.shape != (wheels, 2) or times.shape not in {(1, ticks), (wheels, ticks)}:
        raise ValueError(f"start and times do not fit {wheels} wheels and {ticks} ticks")
    if ticks > 1 and np.diff(times).min() <= motors[0].latency_s:
        raise ValueError(f"a duty acts {motors[0].latency_s} s after it is written, later than the next tick: use longer ticks")
    if kick is not None and not DIRECTION_TICKS < kick.begin < ticks - DIRECTION_TICKS:
        raise ValueError(f"a kick in tick {kick.begin} of {ticks} leaves no {DIRECTION_TICKS} ticks before or after it to tell directions")
    states, potentials = start.states.copy(), start.potentials.copy()
    directions = np.zeros((wheels, 2), dtype=np.int64)
    settled_s = np.zeros(wheels)
    records = np.empty((record, ticks, len(CHANNELS)))
    _run(
        states,
        potentials,
        times,
        (params.a, params.tau_s, params.k, params.rods, params.max_duty_pct, params.tick_s),
        _kick_numbers(kick),
        np.stack([motor.tables() for motor in motors]),
        np.stack([motor.scalars() for motor in motors]),
        (motors[0].battery_v if battery_v is None else battery_v, motors[0].latency_s, motors[0].encoder_counts),
        directions,
        settled_s,
        records,
    )
    return Result(directions[:, 0], directions[:, 1], settled_s, records, times, Start(states, potentials))


def _kick_numbers(kick: Kick | None) -> tuple[int, int, int, int, bool, float]:
    """(action, begin, ticks, pulse, smooth, value) of a kick, as compiled code wants it."""
    if kick is None:
        return NO_KICK, 0, 0, NO_PULSE, False, 0.0
    if kick.mode == MEMBRANE:
        return FROZEN_MEMBRANE, kick.begin, kick.ticks, NO_PULSE, False, 0.0
    if kick.mode == JUMP:
        return (FROZEN_JUMP_1 if kick.variable == "x1" else FROZEN_JUMP_2), kick.begin, kick.ticks, NO_PULSE, False, kick.delta
    return QUENCHED, kick.begin, kick.ticks, kick.pulse, kick.smooth, kick.values[0]


@parallel_jit
def _run(
    states: Array,
    potentials: Array,
    times: Array,
    params: tuple[float, float, float, int, float, float],
    kick: tuple[int, int, int, int, bool, float],
    tables: Array,
    scalars: Array,
    hardware: tuple[float, float, float],
    directions: NDArray[np.int64],
    settled_s: Array,
    records: Array,
) -> None:
    a_set, tau_set, k_set, rods, max_duty_pct, tick_s = params
    action, begin, kick_ticks, pulse, smooth, kick_value = kick
    battery_v, latency_s, counts = hardware
    ticks = times.shape[1]
    for wheel in prange(states.shape[0]):
        when = times[wheel % times.shape[0]]
        table, c = tables[wheel % tables.shape[0]], scalars[wheel % scalars.shape[0]]
        phis = np.empty(ticks)
        angle, last, speed, current, gap, wheel_speed = states[wheel]
        x1, x2 = potentials[wheel]
        value = kick_value
        substep, turn, duty, next_duty = 0, 0, 0, 0
        for tick in range(ticks):
            present = substep_at(when[tick])
            angle, last, speed, current, gap, wheel_speed = advance(
                turn - substep, duty, battery_v, 0.0, angle, last, speed, current, gap, wheel_speed, table, c
            )
            angle, last, speed, current, gap, wheel_speed = advance(
                present - turn, next_duty, battery_v, 0.0, angle, last, speed, current, gap, wheel_speed, table, c
            )
            substep, duty = present, next_duty
            phi = encoder(substep, angle, last, counts) * pi / 180
            phis[tick] = phi
            dt_s = tick_s
            if tick > 0:
                dt_s = max(SHORTEST_STEP_TICKS * tick_s, min(LONGEST_STEP_TICKS * tick_s, when[tick] - when[tick - 1]))

            a, tau_s, k, beta, shift_rad = a_set, tau_set, k_set, 0.0, 0.0
            if begin <= tick < begin + kick_ticks:
                if action == QUENCHED:
                    if tick == begin and np.isnan(value):
                        value = _reversing_shift(_direction(phis[begin - 1] - phis[begin - 1 - DIRECTION_TICKS]))
                    weight = _pulse_weight(tick - begin, kick_ticks, smooth)
                    a, tau_s, k, beta, shift_rad = _pulsed(pulse, value, weight, a, tau_s, k)
                elif action == FROZEN_MEMBRANE:
                    x1, x2 = _invert_membrane(x1, x2)
                elif action == FROZEN_JUMP_1:
                    x1 = _jump(x1, value)
                elif action == FROZEN_JUMP_2:
                    x2 = _jump(x2, value)
            seen_1, seen_2 = _seen_positions(phi, beta, shift_rad)
            x1, x2, force, torque = _step_wheel(x1, x2, phi, seen_1, seen_2, dt_s, a, tau_s, k, rods)
            next_duty = _limit_duty(torque, max_duty_pct)
            turn = max(substep_from(when[tick] + latency_s), substep)
            if wheel < records.shape[0]:
                row = records[wheel, tick]
                row[0], row[1], row[2], row[3], row[4], row[5] = phi, x1, x2, force, torque, next_duty
    ...
