"""Many robots at once, each with both wheels on its body, compiled and on all cores.

Each runs as in robot.loop on a SimBrick with a Scene, from the same functions: same readings, same
arithmetic, same latency. sim_motor.batch has wheels alone, which is a tenth of the work. They stand
for this robot where both wheels do the same or move steadily, but not where they switch at
different times, as in chaos: then each takes the other along through the body, and out of traps.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan, nan, pi

import numpy as np
from numpy.typing import NDArray

from robot.kicks import DIRECTION_TICKS, WHEELS, Kick
from robot.params import Params
from sim_motor.arrays import Array, scalars, tables
from sim_motor.batch import (
    CHANNELS,
    VALUE,
    KickNumbers,
    ParamNumbers,
    control,
    kick_numbers,
    param_numbers,
    random_start,
    random_times,
    signed,
    time_step,
)
from sim_motor.compiled import inner_jit, over_cores, unlocked_jit
from sim_motor.compiled_motor import encoder, substep_at, substep_from
from sim_motor.constants import SUBSTEP_S, Constants, load
from sim_motor.motor import ANGLE, LAST_ANGLE
from sim_motor.scene import Scene
from sim_motor.world import (
    BodyNumbers,
    TyreNumbers,
    WallNumbers,
    advance,
    alone,
    no_stretches,
    numbers,
)


@dataclass(frozen=True)
class Start:
    """Where robots begin, at rest halfway between the walls.

    Attributes:
        states: The motors', as in sim_motor.motor, (robots, 2, 6).
        potentials: Membrane potentials, (robots, 2, 2).
        headings: Where the bodies point, rad; 0 faces the wall at positive x, (robots,).
    """

    states: Array
    potentials: Array
    headings: Array


@dataclass(frozen=True)
class Course:
    """What the robots did. Wheels are left and right.

    Attributes:
        times: When ticks began, s, (1 or robots, ticks).
        records: sim_motor.batch.CHANNELS in each tick, (robots, 2, ticks, channels).
        places: x (m), y (m) and heading (rad) in each tick, (robots, ticks, 3).
    """

    times: Array
    records: Array
    places: Array


def random_robots(robots: int, rng: np.random.Generator, constants: Constants) -> Start:
    """Robots at rest that point anywhere. Their wheels begin as in sim_motor.batch."""
    wheels = random_start(2 * robots, rng, constants)
    return Start(
        wheels.states.reshape(robots, 2, 6),
        wheels.potentials.reshape(robots, 2, 2),
        rng.uniform(-pi, pi, robots),
    )


def run(
    robots: int,
    ticks: int,
    seed: int,
    scene: Scene,
    *,
    params: Params | None = None,
    then: Sequence[tuple[int, Params]] = (),
    kick: Kick | None = None,
    motors: Sequence[Constants] | None = None,
    battery_v: float | None = None,
    start: Start | None = None,
    times: Array | None = None,
) -> Course:
    """Run robots for some ticks, each on a floor of its own.

    Args:
        robots: How many.
        ticks: For how many control periods.
        seed: Random seed of what is not given.
        scene: The floor and its walls.
        params: The robots' parameters; the defaults if None.
        then: Other parameters from a tick on: (tick, parameters), in their order. The control
            period stays that of `params`.
        kick: A kick of all robots, or None. A pulse of the shift with the value
            sim_motor.batch.PHASE_SHIFT gets for each wheel the sign that reverses it; such a kick
            begins after tick DIRECTION_TICKS.
        motors: Robot number i has the motors 2 i and 2 i + 1, modulo their number, which is even;
            the default motor if None. Their wheels carry no share of the body. Latency, encoder
            and battery are those of the first.
        battery_v: Open-circuit voltage, V.
        start: Where the robots begin; random if None.
        times: When ticks begin, s, (1 or robots, ticks); random if None.

    Raises:
        ValueError: The arguments do not fit each other.
    """
    params = params or Params()
    motors = motors or (alone(load()),) * 2
    rng = np.random.default_rng(seed)
    start = start or random_robots(robots, rng, motors[0])
    times = (
        random_times(robots, ticks, params.tick_s, rng)
        if times is None
        else np.ascontiguousarray(np.atleast_2d(times))
    )
    if (
        start.states.shape != (robots, 2, 6)
        or start.potentials.shape != (robots, 2, 2)
        or start.headings.shape != (robots,)
        or times.shape not in {(1, ticks), (robots, ticks)}
        or len(motors) % 2
    ):
        raise ValueError(f"start, times or motors do not fit {robots} robots and {ticks} ticks")
    if np.diff(times).min() < motors[0].latency_s + 2 * SUBSTEP_S:
        raise ValueError(
            f"a duty acts {motors[0].latency_s} s after it is written, which is past the next tick:"
            " use longer ticks"
        )
    left_kick, right_kick = (
        kick_numbers(kick if kick is not None and name in kick.wheels else None, side)
        for side, name in enumerate(WHEELS)
    )
    if (
        kick is not None
        and (isnan(left_kick[VALUE]) or isnan(right_kick[VALUE]))
        and kick.begin <= DIRECTION_TICKS
    ):
        raise ValueError(f"in tick {kick.begin} the wheels have no direction yet: kick later")
    changes = [(0, params), *then]
    records = np.empty((robots, 2, ticks, len(CHANNELS)))
    places = np.empty((robots, ticks, 3))
    given = (
        start.states,
        start.potentials,
        start.headings,
        times,
        np.array([tick for tick, _ in changes]),
        np.array([param_numbers(those) for _, those in changes], dtype=float),
        left_kick,
        right_kick,
        tables(tuple(motors)),
        scalars(motors),
        motors[0].battery_v if battery_v is None else battery_v,
        (motors[0].latency_s, motors[0].encoder_counts, motors[0].dither),
        np.array([motor.dither_seed for motor in motors]),
        *numbers(scene),
        records,
        places,
    )
    over_cores(lambda core, cores: _run_some(*given, core, cores), robots)
    return Course(times, records, places)


@inner_jit
def _params_at(row: Array, tick_s: float) -> ParamNumbers:
    return row[0], row[1], row[2], int(row[3]), row[4], row[5], row[6], tick_s


@inner_jit
def _run_robot(
    states: tuple[Array, Array],
    x: Array,
    place: Array,
    times: Array,
    begins: NDArray[np.int64],
    params: Array,
    left_kick: KickNumbers,
    right_kick: KickNumbers,
    tables: tuple[Array, Array],
    scalars: tuple[Array, Array],
    battery_v: float,
    hardware: tuple[float, float, float],
    dither_seeds: NDArray[np.int64],
    body: BodyNumbers,
    tyre: TyreNumbers,
    walls: WallNumbers,
    record: Array,
    places: Array,
) -> None:
    """Run one robot, with states, potentials and place changed in place."""
    latency_s, counts, dither = hardware
    stretches = no_stretches()
    tick_s = params[0, 7]
    substep = 0
    turn, row = 0, 0
    left, right, next_left, next_right = 0, 0, 0, 0
    for tick in range(len(times)):
        now = times[tick]
        present = substep_at(now)
        for until in (turn, present):
            advance(
                until - substep,
                place,
                stretches,
                states,
                ((left, battery_v, 0.0), (right, battery_v, 0.0)),
                (1, 1),
                tables,
                scalars,
                body,
                tyre,
                walls,
            )
            substep, left, right = until, next_left, next_right
        while row + 1 < len(begins) and begins[row + 1] <= tick:
            row += 1
        dt_s = time_step(times, tick, tick_s)
        for side in range(2):
            state = states[side]
            phis = record[side, :, 0]
            position = encoder(
                substep, state[ANGLE], state[LAST_ANGLE], counts, dither, dither_seeds[side]
            )
            phi = position * pi / 180
            phis[tick] = phi
            kick = signed(right_kick if side else left_kick, tick, phis)
            if side:
                right_kick = kick
            else:
                left_kick = kick
            x[side, 0], x[side, 1], force, torque, duty = control(
                tick,
                phi,
                phis[tick - 1] if tick else nan,
                dt_s,
                x[side, 0],
                x[side, 1],
                kick,
                _params_at(params[row], tick_s),
            )
            if side:
                next_right = duty
            else:
                next_left = duty
            record[side, tick, 1], record[side, tick, 2] = x[side, 0], x[side, 1]
            record[side, tick, 3], record[side, tick, 4] = force, torque
            record[side, tick, 5] = duty
        places[tick, 0], places[tick, 1], places[tick, 2] = place[0], place[1], place[2]
        turn = substep_from(now + latency_s)


@unlocked_jit
def _run_some(
    states: Array,
    potentials: Array,
    headings: Array,
    times: Array,
    begins: NDArray[np.int64],
    params: Array,
    left_kick: KickNumbers,
    right_kick: KickNumbers,
    tables: Array,
    scalars: Array,
    battery_v: float,
    hardware: tuple[float, float, float],
    dither_seeds: NDArray[np.int64],
    body: BodyNumbers,
    tyre: TyreNumbers,
    walls: WallNumbers,
    records: Array,
    places: Array,
    first: int,
    every: int,
) -> None:
    """One of `every` robots, from the first on."""
    for robot in range(first, len(states), every):
        left, right = (2 * robot) % len(tables), (2 * robot + 1) % len(tables)
        place = np.zeros(6)
        place[2] = headings[robot]
        _run_robot(
            (states[robot, 0].copy(), states[robot, 1].copy()),
            potentials[robot].copy(),
            place,
            times[robot % len(times)],
            begins,
            params,
            left_kick,
            right_kick,
            (tables[left], tables[right]),
            (scalars[left], scalars[right]),
            battery_v,
            hardware,
            np.array([dither_seeds[left], dither_seeds[right]]) + 2 * robot // len(tables),
            body,
            tyre,
            walls,
            records[robot],
            places[robot],
        )
