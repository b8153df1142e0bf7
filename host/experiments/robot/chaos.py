"""k = 15, tau = 1 s: whether the wheels switch irregularly and for how long, and what that depends on (R14).

Kinds of pieces, told apart by `part`; a robot does the first, the others are for the simulated one:

- series: angle, force and torque of a wheel, tick by tick.
- lives: how long many wheels switch until they roll steadily or rest, under a condition.
- twins: pairs of runs, the same but for a small jump of a potential, and how far apart the
  potentials are afterwards.
- map: wheels under a latency and a moment of inertia. If they switch in the end, and twins end up
  apart, it is chaotic there.
- speed: turns per second at k = 8, tau = 0.25 s, by which a condition can be held against R2.
- model: the paper's four equations of a wheel, driven by the unbounded force as in the paper, or by
  the bounded torque of the robot.
"""

from __future__ import annotations

from math import cos, log, pi, sin
from typing import Any

import numpy as np

from host.client.robot import Robot
from host.experiments.robot.switching import (
    CONDITIONS,
    DELAYED,
    ORDINARY,
    RESTS,
    ROLLS,
    SWITCHES,
    Array,
    Condition,
    Jump,
    ending,
    switches,
    wheels_run,
)
from host.kicking.outcome import require_running
from host.logs.log import Log
from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.theory.analysis.series_exponents import Exponent, from_series, from_twins, of_noise
from host.theory.model.wheel import acceleration
from host.util.intervals import wilson
from robot.controller import actual_positions, step_wheel
from robot.kicks import WHEELS
from robot.params import Params
from robot.safety import RUNNING
from sim_motor.batch import CHANNELS

PARTS = ("series", "lives", "speed", "twins", "map", "model")
K, TAU_S = 15.0, 1.0
SUSTAINED = 0.95
CLAIMED_MIN = 10.0
# Twins: a jump that is lost between the steps of duty and encoder, and one of some steps.
UNSEEN, SEEN = 1e-6, 1e-3
TWIN_TICK, TWIN_S, TWIN_STEP_S, GROWTH_S = (
    300,
    12.0,
    0.25,
    2.0,
)  # they grow for about a period of the motion
# The map: latencies, factors on the motor's moment of inertia, and when twins are apart: at this
# part of what unrelated moments are.
LATENCIES_S = (0.003, 0.015, 0.03, 0.045, 0.06, 0.075, 0.09, 0.12)
INERTIAS = (0.25, 0.5, 1.0, 2.0, 4.0)
MAP_S, MAP_JUMP_S, PARTED_S, PARTED = 60.0, 40.0, 10.0, 1 / 3
# The paper's model of a wheel (section 'Analytic modelling'): its moment of inertia and friction,
# and how long to follow it.
PAPER_WHEEL = {"moment": 0.05, "friction": 0.5}
MODEL_S, MODEL_STEP_S = 60.0, 0.002
_LIVES, _LIVES_DELAYED, _TWINS, _MAPPED, _PACED, _MODELLED = 100, 16, 64, 4, 8, 4
APART_S = 2.0  # in the series; longer than there and back again
_PHI, _X1, _X2, _FORCE, _TORQUE = (
    CHANNELS.index(name) for name in ("phi_rad", "x1", "x2", "force", "torque")
)


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """The series; for simulated bricks also what explains it."""
    if not batch:
        return [{"part": "series", "condition": ORDINARY}]
    series: list[Cell] = [{"part": "series", "condition": name} for name in (ORDINARY, DELAYED)]
    lives: list[Cell] = [
        {"part": part, "condition": name} for part in ("lives", "speed") for name in CONDITIONS
    ]
    twins: list[Cell] = [
        {"part": "twins", "condition": name, "jump": jump}
        for name in (ORDINARY, DELAYED)
        for jump in (SEEN, UNSEEN)
    ]
    maps: list[Cell] = [
        {"part": "map", "latency_s": latency_s, "inertia": inertia}
        for latency_s in LATENCIES_S
        for inertia in INERTIAS
    ]
    models: list[Cell] = [
        {"part": "model", "wheel": wheel, "bounded": bounded}
        for wheel in ("paper", "robot")
        for bounded in (False, True)
    ]
    return series + lives + twins + maps + models


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor, with room to move about."""
    return {}


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """One of the pieces."""
    parts = {
        "series": _series,
        "lives": _lives,
        "speed": _speed,
        "twins": _twins,
        "map": _map,
        "model": _model,
    }
    return parts[cell["part"]](cell, setting)


def _runs(
    condition: Condition,
    setting: Setting,
    wheels: int,
    seconds: float,
    seed: int,
    jump: Jump | None = None,
) -> Array:
    """Records of all wheels under a condition in the chaotic mode."""
    return np.concatenate(
        list(wheels_run(condition, setting, wheels, seconds, seed, jump, k=K, tau_s=TAU_S))
    )


def _series(cell: Cell, setting: Setting) -> list[Row]:
    condition = CONDITIONS[cell["condition"]]
    records = _runs(condition, setting, 1, 60 * setting.options["minutes"], setting.seed_of(cell))[
        0
    ]
    tick_s = condition.tick_s
    return [
        _sample("left", tick * tick_s, *record[[_PHI, _FORCE, _TORQUE]].tolist())
        for tick, record in enumerate(records)
    ]


def _sample(side: str, t_s: float, phi_rad: float, force: float, torque: float) -> Row:
    return {"side": side, "t_s": t_s, "phi_rad": phi_rad, "force": force, "torque": torque}


def _lives(cell: Cell, setting: Setting) -> list[Row]:
    condition = CONDITIONS[cell["condition"]]
    wheels = _LIVES_DELAYED if cell["condition"] == DELAYED else _LIVES
    tick_s = condition.tick_s
    rows = []
    for records in wheels_run(
        condition,
        setting,
        wheels,
        60 * setting.options["minutes"],
        setting.seed_of(cell),
        k=K,
        tau_s=TAU_S,
    ):
        for phi in records[:, :, _PHI]:
            until_s, end = ending(phi, tick_s)
            rows.append({"switches": len(switches(phi)), "until_s": until_s, "end": end})
    return rows


def _speed(cell: Cell, setting: Setting) -> list[Row]:
    condition = CONDITIONS[cell["condition"]]
    records = np.concatenate(
        list(wheels_run(condition, setting, _PACED, 10.0, setting.seed_of(cell)))
    )
    phi = records[:, len(records[0]) // 2 :, _PHI]
    seconds = (phi.shape[1] - 1) * condition.tick_s
    return [
        {"turns_per_s": float(turns)}
        for turns in np.abs(phi[:, -1] - phi[:, 0]) / (2 * pi * seconds)
    ]


def _distances(first: Array, second: Array) -> Array:
    """How far apart the potentials of twins are, (wheels, ticks)."""
    return np.asarray(
        np.hypot(*(first[:, :, channel] - second[:, :, channel] for channel in (_X1, _X2)))
    )


def _twins(cell: Cell, setting: Setting) -> list[Row]:
    condition, seed = CONDITIONS[cell["condition"]], setting.seed_of(cell)
    tick_s = condition.tick_s
    seconds = TWIN_TICK * tick_s + TWIN_S + 1.0
    plain, other = (
        _runs(condition, setting, _TWINS, seconds, seed, jump)
        for jump in (None, Jump(TWIN_TICK, cell["jump"]))
    )
    apart = _distances(plain, other)
    since_s = np.arange(0.0, TWIN_S + TWIN_STEP_S / 2, TWIN_STEP_S)
    return [
        {
            "start": start,
            "since_s": float(since),
            "distance": float(apart[start, TWIN_TICK + round(since / tick_s)]),
        }
        for start in range(_TWINS)
        for since in since_s
    ]


def _map(cell: Cell, setting: Setting) -> list[Row]:
    condition = Condition(latency_s=cell["latency_s"], inertia=cell["inertia"])
    seed, tick_s = setting.seed_of(cell), condition.tick_s
    plain, other = (
        _runs(condition, setting, _MAPPED, MAP_S, seed, jump)
        for jump in (None, Jump(round(MAP_JUMP_S / tick_s), SEEN))
    )
    last = round(PARTED_S / tick_s)
    unrelated = np.sqrt(2 * plain[:, -2 * last :, [_X1, _X2]].var(axis=1).sum(axis=1))
    apart = _distances(plain, other)[:, -last:].mean(axis=1)
    return [
        {"end": ending(phi, tick_s)[1], "parted": bool(distance > PARTED * scale)}
        for phi, distance, scale in zip(plain[:, :, _PHI], apart, unrelated, strict=True)
    ]


def model_constants(setting: Setting) -> dict[str, float]:
    """The brick's moment of inertia and friction in units of the paper's model, where the torque M = 1 is the motor's greatest at rest."""
    condition = CONDITIONS[ORDINARY]
    motor, duty = condition.constants(setting), condition.max_duty_pct / 100
    volts = condition.supply_v(setting) * duty
    greatest = (
        motor.torque_constant * volts / (motor.resistance + 2 * motor.source_resistance * duty**2)
    )
    return {
        "moment": (motor.motor_inertia + motor.wheel_inertia) / greatest,
        "friction": motor.emf_constant / volts,
    }


def _model(cell: Cell, setting: Setting) -> list[Row]:
    rng = np.random.default_rng(setting.seed_of(cell))
    constants = PAPER_WHEEL if cell["wheel"] == "paper" else model_constants(setting)
    rows = []
    for _ in range(_MODELLED):
        phi = model_run(
            constants["moment"],
            constants["friction"],
            float(rng.uniform(-pi, pi)),
            bounded=cell["bounded"],
        )
        stride = round(Params().tick_s / MODEL_STEP_S)
        until_s, end = ending(phi[::stride], Params().tick_s)
        rows.append({**constants, "until_s": until_s, "end": end})
    return rows


def model_run(moment: float, friction: float, remembered: float, *, bounded: bool) -> Array:
    """Angles (rad), one every MODEL_STEP_S, of the paper's model of a wheel (eq.

    dot_x_phi) from rest at angle 0.

    remembered: the angle (rad) that the potentials begin with. bounded: it is driven by M instead
    of F_tan.
    """
    a = Params().a
    x1, x2, angle, speed = cos(remembered), sin(remembered), 0.0, 0.0
    angles = []
    for _ in range(round(MODEL_S / MODEL_STEP_S)):
        seen_1, seen_2 = actual_positions(angle)
        x1, x2, force, torque = step_wheel(
            x1, x2, seen_1, seen_2, seen_1, seen_2, MODEL_STEP_S, a, TAU_S, K, 2
        )
        speed += MODEL_STEP_S * acceleration(
            torque if bounded else force, speed, moment, friction, 0.0
        )
        angle += MODEL_STEP_S * speed
        angles.append(angle)
    return np.array(angles)


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """Both wheels of a robot, from a start of their own."""
    robot.stop()
    robot.set(k=K, tau_s=TAU_S)
    first = robot.start()
    seconds = 60 * setting.options["minutes"]
    robot.wait(
        seconds,
        until=lambda: (
            robot.newest is not None and robot.newest.tick > first and robot.newest.state != RUNNING
        ),
    )
    require_running(robot)
    records = [record for record in log.records if record.tick >= first and record.state == RUNNING]
    return [
        _sample(
            side,
            record.t_s - records[0].t_s,
            *(getattr(record, f"{side}_{name}") for name in ("phi_rad", "force", "torque")),
        )
        for side in WHEELS
        for record in records
    ]


def chosen(rows: list[Row], **fields: Any) -> list[Row]:
    """The rows with these values."""
    return [row for row in rows if all(row.get(name) == value for name, value in fields.items())]


def by_part(rows: list[Row]) -> dict[str, list[Row]]:
    """The rows of each part."""
    parts: dict[str, list[Row]] = {part: [] for part in PARTS}
    for row in rows:
        parts[row["part"]].append(row)
    return parts


def column(rows: list[Row], name: str) -> Array:
    """One field of rows."""
    return np.array([row[name] for row in rows], dtype=float)


def intervals_s(series: list[Row]) -> Array:
    """How long (s) a wheel went one way, again and again."""
    return np.diff(column(series, "t_s")[switches(column(series, "phi_rad"))])


def is_chaotic(row: Row) -> bool:
    """Whether a wheel of the map is."""
    return bool(row["end"] == SWITCHES and row["parted"])


def growth(rows: list[Row]) -> Exponent:
    """The rate at which twins part, just after the jump."""
    first, last = (column(chosen(rows, since_s=since_s), "distance") for since_s in (0.0, GROWTH_S))
    return from_twins(first, last, GROWTH_S)


def report(rows: list[Row], setting: Setting) -> Findings:
    """R14, judged by the brick as it is.

    With what was found under other conditions, if that was looked at.
    """
    parts = by_part(rows)
    series = {
        key: _of_series(*key, parts["series"])
        for key in dict.fromkeys((row["condition"], row["side"]) for row in parts["series"])
    }
    numbers: dict[str, Any] = {
        "series": {f"{name}, {side}": found for (name, side), found in series.items()}
    }
    ends = chosen(parts["lives"], condition=ORDINARY) or [
        found for (name, _), found in series.items() if name == ORDINARY
    ]
    own = _tally(ends)
    rates = [found["exponent"] for (name, _), found in series.items() if name == ORDINARY]
    chaotic = all(rate is not None and rate["interval"][0] > of_noise() for rate in rates)
    notes = [
        (
            f"{own['to_the_end']} of {own['wheels']} wheels switch to the end, the median until"
            f" {own['median_until_s']:.1f} s"
        )
    ]
    found = ", ".join(
        f"{rate['per_s']:.2f}/s" if rate else "none (too short, or still in part)" for rate in rates
    )
    notes += [f"exponent of the series {found}, where noise alone makes {of_noise():.2f}/s"]
    if parts["lives"]:
        numbers |= _explanations(parts)
        notes += _why(numbers)
    long_enough = setting.options["minutes"] >= CLAIMED_MIN
    if not long_enough:
        notes.append(
            f"{setting.options['minutes']:g} min decide nothing: the claim is of {CLAIMED_MIN:g}"
        )
    claim = Claim(
        "R14",
        "k = 15, tau = 1000 ms: chaotic, irregular switching of the motors",
        "sustained irregular switching over 10 min; positive largest Lyapunov exponent estimate",
        own["to_the_end"] / own["wheels"],
        "1",
        wilson(own["to_the_end"], own["wheels"]),
        own["to_the_end"] >= SUSTAINED * own["wheels"] and chaotic and long_enough,
        "; ".join(notes),
    )
    return Findings([claim], numbers)


def _of_series(condition: str, side: str, rows: list[Row]) -> dict[str, Any]:
    """How a wheel switched, and the exponent of its force, of which M is the bounded image."""
    own = chosen(rows, condition=condition, side=side)
    phi, t_s = column(own, "phi_rad"), column(own, "t_s")
    tick_s = float(t_s[-1] / (len(t_s) - 1))
    until_s, end = ending(phi, tick_s)
    between = intervals_s(own)
    found = from_series(column(own, "force"), tick_s, APART_S)
    return {
        "switches": len(switches(phi)),
        "until_s": until_s,
        "end": end,
        "interval_quartiles_s": (
            np.quantile(between, (0.25, 0.5, 0.75)).tolist() if len(between) else None
        ),
        "exponent": (
            None
            if found is None
            else {
                **_plain(found[0]),
                "lag_s": found[1].lag * tick_s,
                "dimension": found[1].dimension,
            }
        ),
    }


def _plain(exponent: Exponent) -> dict[str, Any]:
    return {"per_s": exponent.rate, "interval": exponent.interval}


def _tally(ends: list[Row]) -> dict[str, Any]:
    """What became of wheels. half_life_s.

    The time in which half of those that switch stop, if that is a matter of chance only.
    """
    counts = {end: len(chosen(ends, end=end)) for end in (SWITCHES, ROLLS, RESTS)}
    until_s = column(ends, "until_s")
    stopped = counts[ROLLS] + counts[RESTS]
    return {
        "wheels": len(ends),
        "to_the_end": counts[SWITCHES],
        "roll": counts[ROLLS],
        "rest": counts[RESTS],
        "median_until_s": float(np.median(until_s)),
        "longest_until_s": float(until_s.max()),
        "half_life_s": float(log(2) * until_s.sum() / stopped) if stopped else None,
    }


def _explanations(parts: dict[str, list[Row]]) -> dict[str, Any]:
    """What the conditions, the twins, the map and the model have come to."""
    twins = {(row["condition"], row["jump"]): None for row in parts["twins"]}
    places = dict.fromkeys((row["latency_s"], row["inertia"]) for row in parts["map"])
    shares = [
        (*place, chosen(parts["map"], latency_s=place[0], inertia=place[1])) for place in places
    ]
    models = dict.fromkeys((row["wheel"], row["bounded"]) for row in parts["model"])
    return {
        "conditions": {
            name: {
                **_tally(chosen(parts["lives"], condition=name)),
                "turns_per_s_at_k_8": float(
                    np.median(column(chosen(parts["speed"], condition=name), "turns_per_s"))
                ),
            }
            for name in CONDITIONS
        },
        "twins": [
            {
                "condition": name,
                "jump": jump,
                **_plain(growth(chosen(parts["twins"], condition=name, jump=jump))),
            }
            for name, jump in twins
        ],
        "map": [
            {
                "latency_s": latency_s,
                "inertia": inertia,
                "chaotic": sum(map(is_chaotic, found)),
                "of": len(found),
            }
            for latency_s, inertia, found in shares
        ],
        "model": [
            {
                "wheel": wheel,
                "bounded": bounded,
                **{name: found[0][name] for name in PAPER_WHEEL},
                **_tally(found),
            }
            for wheel, bounded in models
            for found in [chosen(parts["model"], wheel=wheel, bounded=bounded)]
        ],
    }


def _why(numbers: dict[str, Any]) -> list[str]:
    """Why it does not last, and where it would."""
    models = {(model["wheel"], model["bounded"]): model for model in numbers["model"]}
    free, bounded, robot = (
        models[key] for key in (("paper", False), ("paper", True), ("robot", True))
    )
    twins = {(row["condition"], row["jump"]): row["per_s"] for row in numbers["twins"]}
    delayed = numbers["conditions"][DELAYED]
    found = next(
        found["exponent"] for name, found in numbers["series"].items() if name.startswith(DELAYED)
    )
    from_data = f"{found['per_s']:.2f}/s" if found else "none"
    cause = (
        f"M being bounded is why: for {MODEL_S:g} s the paper's model (I = {free['moment']:g}, f ="
        f" {free['friction']:g}) switches in {free['to_the_end']} of {free['wheels']} runs driven"
        f" by F_tan, in {bounded['to_the_end']} driven by M, and driven by M with this motor's I ="
        f" {robot['moment']:.2g}, f = {robot['friction']:.2g} in {robot['to_the_end']}"
    )
    delay = (
        f"with a {DELAYED}, for which there is no source, {delayed['to_the_end']} of"
        f" {delayed['wheels']} switch to the end, exponent {from_data} from the series,"
        f" {twins[DELAYED, SEEN]:.2f}/s from twins, and {delayed['turns_per_s_at_k_8']:.1f} Hz at"
        " k = 8"
    )
    others = [
        f"{name}: {found['to_the_end']} of {found['wheels']}, {found['turns_per_s_at_k_8']:.1f} Hz"
        for name, found in numbers["conditions"].items()
        if name not in (ORDINARY, DELAYED)
    ]
    return [
        cause,
        delay,
        "under other conditions, and beside it how fast at k = 8 (R2: 1.8 to 2.3 Hz): "
        + ", ".join(others),
    ]
