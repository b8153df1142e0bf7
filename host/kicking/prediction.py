"""What a kick will probably do: simulated wheels in the robot's present state get the same kick.

The robot's records leave open where exactly its wheels are: the angle is read in whole degrees, and
nobody measures currents, or where a motor is within its play. So there are many simulated wheels
for each wheel of the robot, each in another state that the last second of records allows. They run
under the robot's own program and a motor's model (sim_motor.batch).

Each wheel is computed by itself. What couples the wheels of a robot is not in it: a body that slips
or meets a wall, a battery that sags under the other motor's load, a hand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import pi
from typing import Any

import numpy as np

from host.errors import NotDone, WrongUse, from_robot
from host.kicking.outcome import RESULTS, compare
from host.logs.motion import HEADINGS, heading_of
from robot.errors import Refused
from robot.kick_requests import parse
from robot.kicks import DIRECTION_TICKS, MEMBRANE, WHEELS, Kick
from robot.params import TABLE, Params
from robot.record import STATES, Record
from sim_motor.arrays import Array
from sim_motor.batch import Start, run
from sim_motor.compiled import on_one_core
from sim_motor.constants import SUBSTEP_S, Constants, load
from sim_motor.motor import ANGLE, GAP, LAST_ANGLE, SPEED, WHEEL_SPEED
from sim_motor.replay import replay
from sim_motor.settling import COUNT_RAD

# A kick begins this many ticks after the newest record that its person has seen.
DELAYS = (1, 2, 3)
# After this time a motor has forgotten how fast it was: its time constant is about 0.13 s.
REPLAY_S = 1.0
LEAST_RECORDS = DIRECTION_TICKS + 1

_RUNNING = STATES.index("running")
# Simulated wheels for each delay, and how many specimens of the motor they share.
_EACH, _SPECIMENS = 32, 8
# The speed of a wheel that has come this far in the replayed time tells the battery's voltage,
# as far as it is within these factors.
_TELLING_RAD = pi / 2
_LEAST_FACTOR, _MOST_FACTOR = 0.7, 1.4
_CORRECTIONS = 2
_SPEED_TICKS = 4
# How long a wheel is watched after a kick: a part for friction and inertia, and one for the memory
# of the potentials.
_WATCH_S, _MEMORY_TAU, _PATIENCE_S = 2.0, 4.0, 15.0


@dataclass(frozen=True)
class Prediction:
    """What simulated wheels did under a kick.

    Attributes:
        shares: For each wheel, how many of them did what, by the words of outcome.RESULTS.
        of: How many simulated wheels there were for each wheel.
    """

    shares: dict[str, dict[str, int]]
    of: int


def predict(
    records: Sequence[Record],
    params: Mapping[str, Any],
    kick: Mapping[str, Any],
    motor: Constants,
    battery_v: float | None = None,
    *,
    delays: Sequence[int] = DELAYS,
    seed: int = 0,
) -> Prediction:
    """What a kick will probably do that a person asks for now.

    Args:
        records: The robot's newest records, oldest first; a second of them or more. Those from
            before that second tell only how late ticks are.
        params: The robot's parameters in force, by name.
        kick: The request, as robot.kick_requests.parse takes it; its id may be missing.
        motor: The robot's motors, see host.kicking.robot_motor. The simulated ones are specimens
            of it, within its spread.
        battery_v: The battery's voltage, V; None if it is not known. It matters only where a
            wheel's own speed does not tell it.
        delays: How many ticks after the newest record the kick may begin, with equal chances.
        seed: Random seed of all chance.

    Raises:
        NotDone: The robot does not run, or there are too few records.
        WrongUse: The robot would refuse this kick, or nobody can simulate its motor with its
            control period.
    """
    recent = _recent(records)
    in_force = Params()
    in_force.apply(in_force.check({name: params[name] for name in TABLE if name in params}))
    before = {side: heading_of(_column(recent, side + "_phi_rad")) for side in WHEELS}
    asked = _parse(kick, before, in_force)
    rng = np.random.default_rng(seed)
    motors = motor.specimens(_SPECIMENS, rng)
    members = _EACH * len(delays)
    shares = {side: dict.fromkeys(RESULTS, 0) for side in WHEELS}
    with on_one_core():
        start, volts = _ensemble(
            recent, motors, battery_v or motor.battery_v, in_force.tick_s, members, rng
        )
        for number, (index, side) in product(range(len(delays)), enumerate(WHEELS)):
            first = index * members + number * _EACH
            rows = slice(first, first + _EACH)
            one = Kick(**{**asked.as_dict(), "begin": delays[number] - 1})
            one.values = (one.values[index],) * 2
            own = one if side in one.wheels else None
            for way in _after(own, start.of(rows), volts[rows], motors, in_force, records, rng):
                shares[side][compare(before[side], HEADINGS[way])] += 1
    return Prediction(shares, members)


def _parse(kick: Mapping[str, Any], before: Mapping[str, str], params: Params) -> Kick:
    """The kick that a request asks for while wheels have these headings."""
    ways = {word: way for way, word in HEADINGS.items()}
    directions = [ways[before[side]] for side in WHEELS]
    try:
        asked: Kick = parse({"id": "prediction", **kick}, directions, params, 0)
    except Refused as refusal:
        raise from_robot(refusal.as_dict()) from refusal
    return asked


def warm_up(motor: Constants | None = None) -> None:
    """Compile what a prediction needs, or load it, so that the first one is as fast as others."""
    motor = motor or load()
    fields = dict.fromkeys(Record._fields, 0) | {"state": _RUNNING, "left_x1": 1.0, "right_x1": 1.0}
    records = [
        Record(**{**fields, "tick": tick, "t_s": 0.03 * tick}) for tick in range(LEAST_RECORDS)
    ]
    predict(records, Params().values(), {"mode": MEMBRANE}, motor)


def watch_s(params: Params) -> float:
    """How long a wheel needs until nearly every disturbance is over, s."""
    return min(_PATIENCE_S, _WATCH_S + _MEMORY_TAU * float(params.tau_s))


def _column(records: Sequence[Record], name: str) -> list[float]:
    return [getattr(record, name) for record in records]


def _recent(records: Sequence[Record]) -> list[Record]:
    """The records of the last REPLAY_S, as far as they have no gap. Raises NotDone."""
    first = len(records)
    while (
        first
        and records[first - 1].t_s >= records[-1].t_s - REPLAY_S
        and (first == len(records) or records[first - 1].tick == records[first].tick - 1)
    ):
        first -= 1
    recent = list(records[first:])
    if len(recent) < LEAST_RECORDS:
        raise NotDone(
            f"to predict a kick takes the robot's last {LEAST_RECORDS} records in a row, and there"
            f" are {len(recent)}",
            "wait a second, and try again",
        )
    if recent[-1].state != _RUNNING:
        raise NotDone(
            "the robot does not run, so there is no kick to predict",
            "start it first",
        )
    return recent


def _ensemble(
    records: Sequence[Record],
    motors: tuple[Constants, ...],
    battery_v: float,
    tick_s: float,
    members: int,
    rng: np.random.Generator,
) -> tuple[Start, Array]:
    """Wheels that may be those of the robot, at the deadline of its next tick.

    Returns:
        Where they start, the left ones first, and the battery's voltage for each, V. So far as a
        wheel's own speed tells a motor's strength, the voltage makes up for it.
    """
    times = np.array(_column(records, "t_s"))
    times -= times[0]
    until_s = max(times[-1], times[-1] - records[-1].late_s + tick_s)
    wheels = np.repeat(np.arange(len(WHEELS)), members)

    def channel(name: str) -> Array:
        return np.array([_column(records, f"{side}_{name}") for side in WHEELS])[wheels]

    phi, duties = channel("phi_rad"), channel("duty_pct").astype(np.int64)
    begin, end = _within_count(phi[:, 0], rng), _within_count(phi[:, -1], rng)
    states = np.zeros((len(wheels), 6))
    states[:, ANGLE] = states[:, LAST_ANGLE] = begin
    speed = (phi[:, _SPEED_TICKS] - phi[:, 0]) / times[_SPEED_TICKS]
    states[:, SPEED] = states[:, WHEEL_SPEED] = speed
    states[:, GAP] = rng.uniform(-0.5, 0.5, len(wheels)) * motors[0].backlash
    volts = np.full(len(wheels), battery_v)
    ends, angles = replay(states, times, duties, until_s, motors, volts)
    for _ in range(_CORRECTIONS):
        travel = angles[:, -1] - angles[:, 0]
        tells = (np.abs(end - begin) > _TELLING_RAD) & (travel * (end - begin) > 0.0)
        volts *= np.divide(end - begin, travel, out=np.ones(len(wheels)), where=tells)
        volts = np.clip(volts, _LEAST_FACTOR * battery_v, _MOST_FACTOR * battery_v)
        ends, angles = replay(states, times, duties, until_s, motors, volts)
    ends[:, (ANGLE, LAST_ANGLE)] += (end - angles[:, -1])[:, None]
    potentials = np.stack([channel("x1")[:, -1], channel("x2")[:, -1]], axis=1)
    return Start(ends, potentials, duties[:, -1]), volts


def _within_count(phi: Array, rng: np.random.Generator) -> Array:
    """Angles (rad) at which the encoder may stand that reads these, see sim_motor.motor.encoder."""
    least = np.where(phi > 0.0, 0.0, -0.5)
    most = np.where(phi < 0.0, 0.5, 1.0)
    return phi + COUNT_RAD * rng.uniform(least, most)


def _random_times(
    records: Sequence[Record],
    wheels: int,
    ticks: int,
    tick_s: float,
    latency_s: float,
    rng: np.random.Generator,
) -> Array:
    """When ticks begin, s, (wheels, ticks): as late as the robot's ticks were, or missed as they.

    A later one than the batch can follow is taken to be as late as it can.
    """
    late = np.array(_column(records, "late_s"))
    missed = np.array(_column(records, "missed"))
    chosen = rng.integers(len(records), size=(wheels, ticks))
    deadlines = tick_s * (np.arange(ticks) + np.cumsum(missed[chosen], axis=1))
    times: Array = deadlines + np.clip(late[chosen], 0.0, tick_s - latency_s - 3 * SUBSTEP_S)
    return times


def _after(
    kick: Kick | None,
    start: Start,
    volts: Array,
    motors: tuple[Constants, ...],
    params: Params,
    records: Sequence[Record],
    rng: np.random.Generator,
) -> list[int]:
    """The direction of each simulated wheel when it has had the time to settle."""
    ticks = (kick.begin + kick.ticks if kick else 0) + round(watch_s(params) / params.tick_s)
    wheels = len(volts)
    times = _random_times(records, wheels, ticks, params.tick_s, motors[0].latency_s, rng)
    try:
        result = run(
            wheels,
            ticks,
            0,
            params=params,
            kick=kick,
            motors=motors,
            battery_v=volts,
            start=start,
            times=times,
        )
    except ValueError as error:
        raise WrongUse(
            f"this robot's kicks cannot be predicted: {error}", "take a longer tick_s"
        ) from error
    ways: list[int] = result.after.tolist()
    return ways
