"""Thousands of wheels at once: controller and motor compiled into one loop, on all cores.

Each wheel runs as in robot.loop on a SimBrick, from the same functions: same readings, same
arithmetic, same latency. It runs alone, which the motor's model allows (see sim_motor.constants).
sim_motor.robots has pairs of wheels on a body. Here are no links, leases and faults.
"""

from dataclasses import dataclass
from math import isnan, nan, pi

import numpy as np
from numpy.typing import NDArray

from robot import kicks
from robot.controller import actual_positions, lagging_angle, step_wheel
from robot.kicks import DIRECTION_TICKS, NO_ACTION, NO_KICK, Kick
from robot.loop import clamp_step
from robot.params import Params
from robot.safety import limit_duty
from sim_motor.arrays import Array, scalars, tables
from sim_motor.clock import lateness_s
from sim_motor.compiled import compiled, inner_jit, over_cores, unlocked_jit
from sim_motor.compiled_motor import advance, encoder, substep_at, substep_from
from sim_motor.constants import SUBSTEP_S, Constants, load
from sim_motor.motor import ANGLE, LAST_ANGLE
from sim_motor.settling import settling_s

_actual_positions, _lagging_angle = compiled(actual_positions), compiled(lagging_angle)
_step_wheel, _limit_duty = compiled(step_wheel), compiled(limit_duty)
_direction, _reversing_shift = compiled(kicks.direction), compiled(kicks.reversing_shift)
_settling_s = compiled(settling_s)
_apply_kick, _seen_positions = compiled(kicks.apply_kick), compiled(kicks.seen_positions)
_clamp_step = compiled(clamp_step)

CHANNELS = ("phi_rad", "x1", "x2", "force", "torque", "duty_pct")
ParamNumbers = tuple[float, float, float, int, float, float, float, float]
KickNumbers = tuple[int, int, int, int, bool, float, Array]
VALUE = 5  # where a kick's value stands in its numbers
PHASE_SHIFT = nan  # as a kick's value: the shift that reverses this wheel


@dataclass(frozen=True)
class Start:
    """Where wheels begin.

    Attributes:
        states: As in sim_motor.motor, (wheels, 6).
        potentials: Membrane potentials, (wheels, 2).
        duties: The duty cycles in force, %, (wheels,), of wheels that run already; None for wheels
            at rest. A kick may begin at once where wheels run already. Their first tick has no
            rod_lag_s, as there is no reading before it.
    """

    states: Array
    potentials: Array
    duties: NDArray[np.int64] | None = None

    def of(self, rows: slice) -> "Start":
        """Where some of these wheels begin."""
        duties = None if self.duties is None else self.duties[rows]
        return Start(self.states[rows], self.potentials[rows], duties)


@dataclass(frozen=True)
class Result:
    """What the wheels did.

    Attributes:
        before: Each wheel's direction when the kick began, (wheels,); 0 if it began in one of the
            first DIRECTION_TICKS ticks, which do not tell.
        after: Each wheel's direction in the end, (wheels,).
        settled_s: When the wheel had settled after the kick's first tick, s, as sim_motor.settling
            defines it; NaN if it had not, (wheels,).
        kick_phi_rad: The angle in the kick's first tick, rad; NaN without a kick, (wheels,).
        times: When ticks began, s, (1 or wheels, ticks).
        records: CHANNELS in each tick of the recorded wheels, (wheels, ticks, channels).
    """

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    settled_s: Array
    kick_phi_rad: Array
    times: Array
    records: Array

    @property
    def reversed(self) -> NDArray[np.bool_]:
        """Which wheels ran before the kick and run the other way now."""
        return np.asarray((self.before != 0) & (self.after == -self.before))


def random_start(wheels: int, rng: np.random.Generator, constants: Constants) -> Start:
    """Wheels at rest at random phases and anywhere in their play.

    Their potentials are those that belong to another random angle.
    """
    states = np.zeros((wheels, 6))
    states[:, 0] = states[:, 1] = rng.uniform(0, 2 * pi, wheels)
    states[:, 4] = rng.uniform(-constants.backlash / 2, constants.backlash / 2, wheels)
    remembered = rng.uniform(-pi, pi, wheels)
    return Start(states, np.stack((np.cos(remembered), np.sin(remembered)), axis=1))


def random_times(rows: int, ticks: int, tick_s: float, rng: np.random.Generator) -> Array:
    """When each tick begins, s, (rows, ticks): late as on the brick.

    For ticks of 20 ms or more; shorter ones would be missed.
    """
    return np.arange(ticks) * tick_s + lateness_s(rng.standard_normal((rows, ticks)))


def param_numbers(params: Params) -> ParamNumbers:
    """The parameters of a tick, as `control` takes them."""
    return (
        params.a,
        params.tau_s,
        params.k,
        params.rods,
        params.rod_lag_s,
        params.duty_scale,
        params.max_duty_pct,
        params.tick_s,
    )


def kick_numbers(kick: Kick | None, index: int = 0) -> KickNumbers:
    """The numbers of a kick, or of none, for compiled code; its value is that of this wheel."""
    numbers = NO_KICK if kick is None else kick.numbers(index)
    action, begin, ticks, pulse, smooth, value, waveform = numbers
    return action, begin, ticks, pulse, smooth, value, np.array(waveform, dtype=float)


def run(
    wheels: int,
    ticks: int,
    seed: int,
    *,
    params: Params | None = None,
    kick: Kick | None = None,
    motors: tuple[Constants, ...] | None = None,
    battery_v: float | Array | None = None,
    start: Start | None = None,
    times: Array | None = None,
    record: int = 0,
) -> Result:
    """Run wheels for some ticks, each by itself.

    Args:
        wheels: How many.
        ticks: For how many control periods.
        seed: Random seed of what is not given.
        params: The robot's parameters; the defaults if None.
        kick: A kick that acts on all wheels, with its value for the left wheel, or None. A pulse
            of the shift with the value PHASE_SHIFT gets for each wheel the sign that reverses it.
        motors: Wheel number i has motors[i % len(motors)]; the default motor if None. Battery,
            latency and encoder are those of the first.
        battery_v: Open-circuit voltage, V; one for all or (wheels,).
        start: Where the wheels begin; random if None.
        times: When ticks begin, s, (1 or wheels, ticks); random if None.
        record: How many wheels to record, from the first.

    Raises:
        ValueError: The arguments do not fit each other.
    """
    params = params or Params()
    motors = motors or (load(),)
    latency_s = motors[0].latency_s
    rng = np.random.default_rng(seed)
    start = start or random_start(wheels, rng, motors[0])
    times = (
        random_times(wheels, ticks, params.tick_s, rng)
        if times is None
        else np.ascontiguousarray(np.atleast_2d(times))
    )
    if (
        start.states.shape != (wheels, 6)
        or start.potentials.shape != (wheels, 2)
        or times.shape not in {(1, ticks), (wheels, ticks)}
    ):
        raise ValueError(f"start and times do not fit {wheels} wheels and {ticks} ticks")
    volts = np.full(wheels, motors[0].battery_v if battery_v is None else battery_v, dtype=float)
    duties = np.zeros(wheels, dtype=np.int64) if start.duties is None else start.duties
    if not all(np.isfinite(part).all() for part in (start.states, start.potentials, times, volts)):
        raise ValueError("start, times and battery must be finite numbers")
    if ticks <= DIRECTION_TICKS:
        raise ValueError(
            f"{ticks} ticks are too few to tell a direction: run more than {DIRECTION_TICKS}"
        )
    if np.diff(times).min() < latency_s + 2 * SUBSTEP_S:
        raise ValueError(
            f"a duty acts {latency_s} s after it is written, which is past the next tick: use"
            " longer ticks"
        )
    numbers = kick_numbers(kick)
    at_once = start.duties is not None and not isnan(numbers[VALUE])
    earliest = 0 if at_once else DIRECTION_TICKS + 1
    if kick is not None and not earliest <= kick.begin < ticks - DIRECTION_TICKS:
        raise ValueError(
            f"a kick in tick {kick.begin} of {ticks} leaves no {DIRECTION_TICKS} ticks before or"
            " after it to tell directions"
        )
    result = Result(
        before=np.zeros(wheels, dtype=np.int64),
        after=np.zeros(wheels, dtype=np.int64),
        settled_s=np.full(wheels, np.nan),
        kick_phi_rad=np.full(wheels, np.nan),
        times=times,
        records=np.empty((min(record, wheels), ticks, len(CHANNELS))),
    )
    given = (
        start.states,
        start.potentials,
        np.ascontiguousarray(duties),
        times,
        param_numbers(params),
        numbers,
        tables(motors),
        scalars(motors),
        volts,
        (latency_s, motors[0].encoder_counts, motors[0].dither),
        np.array([motor.dither_seed for motor in motors]),
        result.before,
        result.after,
        result.settled_s,
        result.kick_phi_rad,
        result.records,
    )
    over_cores(lambda core, cores: _run_some(*given, core, cores), wheels)
    return result


@inner_jit
def control(
    tick: int,
    phi: float,
    phi_before: float,
    dt_s: float,
    x1: float,
    x2: float,
    kick: KickNumbers,
    params: ParamNumbers,
) -> tuple[float, float, float, float, int]:
    """A tick of one wheel's controller.

    Args:
        tick: Its number.
        phi: The angle read in it, rad.
        phi_before: The angle read in the tick before, rad; NaN if there was none.
        dt_s: Its time step, s.
        x1: First membrane potential, 1.
        x2: Second membrane potential, 1.
        kick: As `kick_numbers` returns it.
        params: As `param_numbers` returns them.

    Returns:
        (x1, x2, force, torque, duty cycle in %) after the tick.
    """
    a, tau_s, k, rods, rod_lag_s, duty_scale, max_duty_pct, _ = params
    x1, x2, a, tau_s, k, beta, shift_rad = _apply_kick(kick, tick, x1, x2, a, tau_s, k)
    actual_1, actual_2 = rod_1, rod_2 = _actual_positions(phi)
    if rod_lag_s > 0.0 and not isnan(phi_before):
        rod_1, rod_2 = _actual_positions(_lagging_angle(phi, phi_before, dt_s, rod_lag_s))
    seen_1, seen_2 = _seen_positions(phi, beta, shift_rad)
    x1, x2, force, torque = _step_wheel(
        x1, x2, actual_1, actual_2, rod_1, rod_2, seen_1, seen_2, dt_s, a, tau_s, k, rods
    )
    return x1, x2, force, torque, _limit_duty(duty_scale * torque, max_duty_pct)


@inner_jit
def time_step(times: Array, tick: int, tick_s: float) -> float:
    """The time step of a tick, s, as the robot's loop measures it."""
    return _clamp_step(times[tick] - times[tick - 1], tick_s) if tick else tick_s


@inner_jit
def _travel(phis: Array, tick: int) -> float:
    """How far (rad) a wheel went in the DIRECTION_TICKS ticks up to this one."""
    travel: float = phis[tick] - phis[tick - DIRECTION_TICKS]
    return travel


@inner_jit
def signed(kick: KickNumbers, tick: int, phis: Array) -> KickNumbers:
    """The kick in its first tick, with the sign that reverses this wheel if it has none."""
    action, begin, ticks, pulse, smooth, value, waveform = kick
    if tick == begin and isnan(value):
        value = _reversing_shift(_direction(_travel(phis, tick - 1)))
    return action, begin, ticks, pulse, smooth, value, waveform


@inner_jit
def _run_wheel(
    phis: Array,
    start: Array,
    x1: float,
    x2: float,
    duty: int,
    times: Array,
    params: ParamNumbers,
    kick: KickNumbers,
    table: Array,
    scalars: Array,
    battery_v: float,
    hardware: tuple[float, float, float],
    dither_seed: int,
    record: Array,
) -> None:
    """Run one wheel.

    Its angle (rad) in each tick goes into `phis`, and its CHANNELS into `record` unless that is
    empty.
    """
    tick_s = params[-1]
    latency_s, counts, dither = hardware
    state = (start[0], start[1], start[2], start[3], start[4], start[5])
    substep = 0
    turn, next_duty = 0, duty  # the duty that was written last, and the substep from which it acts
    for tick in range(len(times)):
        now = times[tick]
        present = substep_at(now)
        state = advance(turn - substep, duty, battery_v, 0.0, *state, table, scalars)
        state = advance(present - turn, next_duty, battery_v, 0.0, *state, table, scalars)
        substep, duty = present, next_duty
        position = encoder(substep, state[ANGLE], state[LAST_ANGLE], counts, dither, dither_seed)
        phi = position * pi / 180
        phis[tick] = phi
        kick = signed(kick, tick, phis)
        x1, x2, force, torque, next_duty = control(
            tick,
            phi,
            phis[tick - 1] if tick else nan,
            time_step(times, tick, tick_s),
            x1,
            x2,
            kick,
            params,
        )
        turn = substep_from(now + latency_s)
        if len(record):
            record[tick, 0], record[tick, 1], record[tick, 2] = phi, x1, x2
            record[tick, 3], record[tick, 4], record[tick, 5] = force, torque, next_duty


@unlocked_jit
def _run_some(
    states: Array,
    potentials: Array,
    duties: NDArray[np.int64],
    times: Array,
    params: ParamNumbers,
    kick: KickNumbers,
    tables: Array,
    scalars: Array,
    volts: Array,
    hardware: tuple[float, float, float],
    dither_seeds: NDArray[np.int64],
    before: NDArray[np.int64],
    after: NDArray[np.int64],
    settled_s: Array,
    kick_phi_rad: Array,
    records: Array,
    first: int,
    every: int,
) -> None:
    """One of `every` wheels, from the first on."""
    ticks = times.shape[1]
    kicked, begin = kick[0] != NO_ACTION, kick[1]
    for wheel in range(first, len(states), every):
        phis = np.empty(ticks)
        when = times[wheel % len(times)]
        variant = wheel % len(tables)
        record = records[wheel] if wheel < len(records) else np.empty((0, len(CHANNELS)))
        x1, x2 = potentials[wheel, 0], potentials[wheel, 1]
        _run_wheel(
            phis,
            states[wheel],
            x1,
            x2,
            duties[wheel],
            when,
            params,
            kick,
            tables[variant],
            scalars[variant],
            volts[wheel],
            hardware,
            dither_seeds[variant] + wheel // len(tables),
            record,
        )
        after[wheel] = _direction(_travel(phis, ticks - 1))
        if kicked:
            if begin > DIRECTION_TICKS:
                before[wheel] = _direction(_travel(phis, begin - 1))
            settled_s[wheel] = _settling_s(phis, when, when[begin])
            kick_phi_rad[wheel] = phis[begin]
