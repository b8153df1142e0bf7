"""The simulated pieces of the experiment `chaos`: wheels with k = 15 and tau = 1 s, and the model.

Each function does one cell and returns its rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import cos, pi, sin
from typing import TypedDict

import numpy as np

from host.experiments.robot.chaos_rows import (
    Distance,
    Life,
    LivesCell,
    MapCell,
    MapWheel,
    ModelCell,
    ModelRun,
    Sample,
    SeriesCell,
    Speed,
    SpeedCell,
    TwinsCell,
)
from host.experiments.robot.switching import (
    ALL_HOLD,
    CONDITIONS,
    DELAYED,
    OLDER,
    ORDINARY,
    Array,
    Condition,
    Jump,
    ending,
    switches,
    wheels_run,
)
from host.kicking.modes import CHAOS, MODES
from host.runs.contract import Options, Setting
from host.runs.presets import OPTION, PAPER
from host.runs.robot_options import params_of
from host.theory.model.wheel import acceleration
from robot.controller import actual_positions, step_wheel
from robot.params import Params
from sim_motor.batch import CHANNELS
from sim_motor.scene import Scene

K, TAU_S = (MODES[CHAOS].params[name] for name in ("k", "tau_s"))
# The jumps that make twins: one that is lost between the steps of duty and encoder, and one of
# several steps.
UNSEEN, SEEN = 1e-6, 1e-3
TWIN_TICK, TWIN_S, TWIN_STEP_S = 300, 12.0, 0.25
# For the map: how long a run is, when its twin jumps, and over which last seconds twins must be
# apart by the share PARTED of the distance of unrelated moments.
MAP_S, MAP_JUMP_S, PARTED_S, PARTED = 60.0, 40.0, 10.0, 1 / 3
SPEED_S = 10.0
# How many wheels, pairs of twins or runs make one piece.
LIVES_WHEELS, LIVES_WHEELS_OTHERS, LIVES_WHEELS_DELAYED = 100, 40, 16
TWIN_PAIRS, MAP_WHEELS, SPEED_WHEELS, MODEL_RUNS = 64, 4, 8, 4
# Under these conditions a wheel is compared with its twins, and its course is kept.
SHOWN = (ORDINARY, OLDER)


def claimed_in(options: Options) -> str:
    """The condition for which a run with these options judges R14."""
    return ALL_HOLD if options.get(OPTION.name) == PAPER else ORDINARY


MODEL_S, MODEL_STEP_S = 60.0, 0.002

_PHI, _X1, _X2, _FORCE, _TORQUE = (
    CHANNELS.index(name) for name in ("phi_rad", "x1", "x2", "force", "torque")
)


class WheelConstants(TypedDict):
    """A wheel of the paper's model: moment of inertia I and friction f in the model's units."""

    moment: float
    friction: float


# The paper, section 'Analytic modelling'.
PAPER_WHEEL: WheelConstants = {"moment": 0.05, "friction": 0.5}


def chaotic(options: Options) -> dict[str, float]:
    """The parameters of wheels that may be chaotic, by the robot's names, but for the tick."""
    own = {"k": K, "tau_s": TAU_S, "a": Params().a, **params_of(options)}
    return {name: own[name] for name in own if name != "tick_s"}


def condition_of(name: str, setting: Setting) -> Condition:
    """The condition of this name, at the run's control period if it has none of its own."""
    found = CONDITIONS[name]
    own = found.tick_s != Condition.tick_s
    return found if own else replace(found, tick_s=setting.params().tick_s)


def _chaotic_run(
    condition: Condition,
    setting: Setting,
    wheels: int,
    seconds: float,
    seed: int,
    jump: Jump | None = None,
) -> Iterator[Array]:
    changes = chaotic(setting.options)
    return wheels_run(condition, setting, wheels, seconds, seed, jump, **changes)


def _gather(records: Iterator[Array]) -> Array:
    """The records of all wheels in one array, (wheels, ticks, CHANNELS)."""
    return np.concatenate(list(records))


def series(cell: SeriesCell, setting: Setting) -> list[Sample]:
    """One wheel, tick by tick."""
    condition = condition_of(cell["condition"], setting)
    seconds, seed = 60 * setting.options["minutes"], setting.seed_of(cell)
    records = _gather(_chaotic_run(condition, setting, 2, seconds, seed))[0]
    samples = records[:, [_PHI, _FORCE, _TORQUE]].tolist()
    return [
        {
            "side": "left",
            "t_s": tick * condition.tick_s,
            "phi_rad": phi_rad,
            "force": force,
            "torque": torque,
        }
        for tick, (phi_rad, force, torque) in enumerate(samples)
    ]


def lives(cell: LivesCell, setting: Setting) -> list[Life]:
    """How long each of many wheels switches, and what it does then."""
    condition = condition_of(cell["condition"], setting)
    wheels = (
        LIVES_WHEELS
        if cell["condition"] in (*SHOWN, ALL_HOLD)
        else LIVES_WHEELS_DELAYED
        if cell["condition"] == DELAYED
        else LIVES_WHEELS_OTHERS
    )
    seconds, seed = 60 * setting.options["minutes"], setting.seed_of(cell)
    rows: list[Life] = []
    for records in _chaotic_run(condition, setting, wheels, seconds, seed):
        for phi in records[:, :, _PHI]:
            until_s, end = ending(phi, condition.tick_s)
            rows.append({"switches": len(switches(phi)), "until_s": until_s, "end": end})
    return rows


def speed(cell: SpeedCell, setting: Setting) -> list[Speed]:
    """Turns per second at the default parameters, over the second half of each run."""
    condition = condition_of(cell["condition"], setting)
    records = _gather(wheels_run(condition, setting, SPEED_WHEELS, SPEED_S, setting.seed_of(cell)))
    phi = records[:, len(records[0]) // 2 :, _PHI]
    seconds = (phi.shape[1] - 1) * condition.tick_s
    turns_per_s = np.abs(phi[:, -1] - phi[:, 0]) / (2 * pi * seconds)
    return [{"turns_per_s": float(turns)} for turns in turns_per_s]


def _distances(first: Array, second: Array) -> Array:
    """How far apart the potentials of twins are, (wheels, ticks)."""
    apart = first - second
    return np.asarray(np.hypot(apart[:, :, _X1], apart[:, :, _X2]))


def twins(cell: TwinsCell, setting: Setting) -> list[Distance]:
    """The distance of each pair of twins, from the jump on."""
    condition, seed = condition_of(cell["condition"], setting), setting.seed_of(cell)
    tick_s = condition.tick_s
    seconds = TWIN_TICK * tick_s + TWIN_S + 1.0
    jump = Jump(TWIN_TICK, cell["jump"])
    plain = _gather(_chaotic_run(condition, setting, TWIN_PAIRS, seconds, seed))
    other = _gather(_chaotic_run(condition, setting, TWIN_PAIRS, seconds, seed, jump))
    apart = _distances(plain, other)
    times = np.arange(0.0, TWIN_S + TWIN_STEP_S / 2, TWIN_STEP_S)
    return [
        {
            "start": start,
            "since_s": float(since),
            "distance": float(apart[start, TWIN_TICK + round(since / tick_s)]),
        }
        for start in range(TWIN_PAIRS)
        for since in times
    ]


def map_wheels(cell: MapCell, setting: Setting) -> list[MapWheel]:
    """What wheels at this lag and voltage do in the end, and whether their twins parted."""
    condition = Condition(
        tick_s=setting.params().tick_s,
        rod_lag_s=cell["rod_lag_s"],
        battery_v=cell["battery_v"],
        scene=Scene(),
    )
    seed, tick_s = setting.seed_of(cell), condition.tick_s
    jump = Jump(round(MAP_JUMP_S / tick_s), SEEN)
    plain = _gather(_chaotic_run(condition, setting, MAP_WHEELS, MAP_S, seed))
    other = _gather(_chaotic_run(condition, setting, MAP_WHEELS, MAP_S, seed, jump))
    last = round(PARTED_S / tick_s)
    unrelated = np.sqrt(2 * plain[:, -2 * last :, [_X1, _X2]].var(axis=1).sum(axis=1))
    apart = _distances(plain, other)[:, -last:].mean(axis=1)
    return [
        {"end": ending(phi, tick_s)[1], "parted": bool(distance > PARTED * scale)}
        for phi, distance, scale in zip(plain[:, :, _PHI], apart, unrelated, strict=True)
    ]


def model_runs(cell: ModelCell, setting: Setting) -> list[ModelRun]:
    """Runs of the paper's model, each from potentials of its own."""
    rng = np.random.default_rng(setting.seed_of(cell))
    constants = PAPER_WHEEL if cell["wheel"] == "paper" else model_constants(setting)
    tick_s = setting.params().tick_s
    stride = round(tick_s / MODEL_STEP_S)
    rows: list[ModelRun] = []
    for _ in range(MODEL_RUNS):
        remembered = float(rng.uniform(-pi, pi))
        phi = model_run(
            **constants,
            remembered=remembered,
            bounded=cell["bounded"],
            **chaotic(setting.options),
        )
        until_s, end = ending(phi[::stride], tick_s)
        rows.append({**constants, "until_s": until_s, "end": end})
    return rows


def model_constants(setting: Setting) -> WheelConstants:
    """The simulated brick's wheel in the model's units: M = 1 is the motor's greatest torque."""
    condition = CONDITIONS[ORDINARY]
    motor, duty = condition.constants(setting), condition.max_duty_pct / 100
    volts = condition.supply_v(setting) * duty
    resistance = motor.resistance + 2 * motor.source_resistance * duty**2
    greatest = motor.torque_constant * volts / resistance
    return {
        "moment": (motor.motor_inertia + motor.wheel_inertia) / greatest,
        "friction": motor.emf_constant / volts,
    }


def model_run(
    moment: float,
    friction: float,
    remembered: float,
    *,
    bounded: bool,
    a: float,
    tau_s: float,
    k: float,
) -> Array:
    """Follow the paper's model of a wheel from rest at angle 0.

    Args:
        moment: moment of inertia I, in the model's units.
        friction: friction f, in the model's units.
        remembered: the angle (rad) that the potentials begin with.
        bounded: whether the torque M drives the wheel; otherwise the force F_tan does.
        a: gain of the neurons (1).
        tau_s: time constant of the potentials (s).
        k: spring constant (1).

    Returns:
        Its angles (rad), one every MODEL_STEP_S.
    """
    x1, x2, angle, omega = cos(remembered), sin(remembered), 0.0, 0.0
    angles = []
    for _ in range(round(MODEL_S / MODEL_STEP_S)):
        at_1, at_2 = actual_positions(angle)
        x1, x2, force, torque = step_wheel(
            x1, x2, at_1, at_2, at_1, at_2, at_1, at_2, MODEL_STEP_S, a, tau_s, k, 2
        )
        drive = torque if bounded else force
        omega += MODEL_STEP_S * acceleration(drive, omega, moment, friction, 0.0)
        angle += MODEL_STEP_S * omega
        angles.append(angle)
    return np.array(angles)
