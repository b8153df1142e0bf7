"""Which kicks bring a robot out of chaos, by themselves or with other parameters afterwards.

Each kick is tried on many robots in the mode `chaos` on a floor without walls, KICK_S after a
random start: each of them is in another phase and has another speed when the kick begins. What both
wheels do in the last OUTCOME_S of AFTER_S counts.

Afterwards the robot is still in chaos (`stay`), has its default parameters (`default`), or its
default parameters with k = 0.3, at which it can only rest (`rest`).
"""

from __future__ import annotations

from typing import NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.experiments.robot.explore import DITHER_DEG
from host.kicking.modes import CHAOS, MODES
from host.logs.motion import directions
from host.runs.contract import Findings, Options, Setting
from host.runs.robot_options import params_with
from host.util.intervals import wilson
from robot.kicks import (
    DIRECTION_TICKS,
    MEMBRANE,
    NO_PULSE,
    PHASE,
    POSITION,
    PULSE,
    PULSE_BETA,
    PULSE_K,
    PULSE_SHIFT,
    PULSE_TAU,
    WHEELS,
    Kick,
)
from robot.params import Params
from sim_motor.batch import PHASE_SHIFT
from sim_motor.robots import run
from sim_motor.scene import Scene
from sim_motor.world import alone

NONE, STAY, DEFAULT, REST_SET = "no kick", "stay", "default", "rest"
AFTERWARDS = (STAY, DEFAULT, REST_SET)
KICK_S, AFTER_S, OUTCOME_S = 12.0, 12.0, 4.0
TICKS = (3, 10, 33)
FAST_RAD_S = 9.0


class Way(NamedTuple):
    """A kick's mode, the parameter that it pulses, and the pulse's value; mode None: no kick."""

    mode: str | None
    pulse: int = NO_PULSE
    value: float = 0.0


KICKS = {
    NONE: Way(None),
    "membrane": Way(MEMBRANE),
    "position": Way(POSITION, PULSE_BETA, -1.0),
    "phase": Way(PHASE, PULSE_SHIFT, PHASE_SHIFT),
    "k = 0": Way(PULSE, PULSE_K, 0.0),
    "k = 2": Way(PULSE, PULSE_K, 2.0),
    "tau = 0.1 s": Way(PULSE, PULSE_TAU, 0.1),
}
# What a robot does in the end, by the directions of its wheels.
STRAIGHT, TURNS, RESTS, CHAOTIC = "straight", "turns", "rests", "still switches"
ENDS = (STRAIGHT, TURNS, RESTS, CHAOTIC)


class Cell(TypedDict):
    """One kick.

    Attributes:
        kick: one of KICKS.
        ticks: length of the kick in ticks; 0 for no kick.
        afterwards: what is done after the kick: one of AFTERWARDS.
    """

    kick: str
    ticks: int
    afterwards: str


class Outcome(TypedDict):
    """One robot: how its wheels moved when the kick began, and what it did in the end.

    Attributes:
        left_rad_s: speed of the left wheel when the kick began (rad/s).
        right_rad_s: that of the right wheel (rad/s).
        phase_rad: the left wheel's angle then, modulo 2 pi (rad).
        end: one of ENDS.
        kept: whether both wheels turn in the end as they did at the kick.
    """

    left_rad_s: float
    right_rad_s: float
    phase_rad: float
    end: str
    kept: bool


class Row(Cell, Outcome):
    """A row of the table."""


class Share(Cell):
    """How many of the robots ended so, and the 95 % interval of that share."""

    end: str
    robots: int
    of: int
    interval: tuple[float, float]


class Kept(TypedDict):
    """How many robots turn both wheels in the end as they did at the kick, of those in one speed.

    Attributes:
        fast: whether both wheels were at least FAST_RAD_S fast when the kick began.
    """

    kick: str
    ticks: int
    fast: bool
    robots: int
    of: int
    interval: tuple[float, float]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each kick, of each length, with each choice of parameters afterwards."""
    if not batch:
        raise WrongUse(
            "leave-chaos runs only on the simulated robot: it tries each kick on hundreds",
            "leave --brick out",
        )
    return [
        {"kick": kick, "ticks": ticks, "afterwards": afterwards}
        for afterwards in AFTERWARDS
        for kick, way in KICKS.items()
        for ticks in ((0,) if way.mode is None else (1,) if way.mode == MEMBRANE else TICKS)
    ]


def simulate(cell: Cell, setting: Setting) -> list[Outcome]:
    """Kick all robots. Every kick meets the same ones in the same states."""
    seed, robots = setting.seed_of({}), setting.options["robots"]
    chaos = params_with(**MODES[CHAOS].params)
    begin = round(KICK_S / chaos.tick_s)
    way, motor = KICKS[cell["kick"]], alone(setting.constants)
    then = {STAY: None, DEFAULT: Params(), REST_SET: params_with(k=0.3)}[cell["afterwards"]]
    course = run(
        robots,
        begin + round(AFTER_S / chaos.tick_s),
        seed,
        Scene(),
        params=chaos,
        then=[(begin + cell["ticks"], then)] if then else [],
        kick=None
        if way.mode is None
        else Kick(
            "kick",
            way.mode,
            WHEELS,
            cell["ticks"],
            pulse=way.pulse,
            values=(way.value, way.value),
            begin=begin,
        ),
        motors=tuple(motor.with_dither(DITHER_DEG, seed + side * robots) for side in range(2)),
        battery_v=setting.battery_v,
    )
    phi = course.records[:, :, :, 0]
    late = phi[:, :, -round(OUTCOME_S / chaos.tick_s) :]
    before = phi[:, :, begin - 1] - phi[:, :, begin - 1 - DIRECTION_TICKS]
    speeds = before / (DIRECTION_TICKS * chaos.tick_s)
    return [
        {
            "left_rad_s": float(left),
            "right_rad_s": float(right),
            "phase_rad": float(own[0, begin - 1] % (2 * np.pi)),
            "end": end,
            "kept": end in (STRAIGHT, TURNS)
            and bool((np.sign(last[:, -1] - last[:, 0]) == np.sign((left, right))).all()),
        }
        for own, last, (left, right) in zip(phi, late, speeds, strict=True)
        for end in [end_of(last)]
    ]


def end_of(phi: NDArray[np.float64]) -> str:
    """What a robot does whose wheels have these angles (rad), (2, ticks): a value of ENDS."""
    ways = directions(phi.T)[DIRECTION_TICKS:]
    if not ways.any():
        return RESTS
    if (ways != ways[0]).any():
        return CHAOTIC
    return STRAIGHT if ways[0, 0] == ways[0, 1] else TURNS


def shares(rows: list[Row]) -> list[Share]:
    """The share of each end for each kick, in the order of the cells."""
    kicks: dict[tuple[str, int, str], list[str]] = {}
    for row in rows:
        kicks.setdefault((row["kick"], row["ticks"], row["afterwards"]), []).append(row["end"])
    return [
        {
            "kick": kick,
            "ticks": ticks,
            "afterwards": afterwards,
            "end": end,
            "robots": ends.count(end),
            "of": len(ends),
            "interval": wilson(ends.count(end), len(ends)),
        }
        for (kick, ticks, afterwards), ends in kicks.items()
        for end in ENDS
    ]


def kept(rows: list[Row]) -> list[Kept]:
    """For each kick before the default parameters: how many robots keep their wheels' ways."""
    kicks: dict[tuple[str, int, bool], list[bool]] = {}
    for row in rows:
        if row["afterwards"] == DEFAULT:
            fast = min(abs(row["left_rad_s"]), abs(row["right_rad_s"])) >= FAST_RAD_S
            kicks.setdefault((row["kick"], row["ticks"], fast), []).append(row["kept"])
    return [
        {
            "kick": kick,
            "ticks": ticks,
            "fast": fast,
            "robots": sum(own),
            "of": len(own),
            "interval": wilson(sum(own), len(own)),
        }
        for (kick, ticks, fast), own in kicks.items()
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """The shares of the ends, and of wheels that keep their ways. No claim of the paper."""
    return Findings([], {"shares": shares(rows), "kept": kept(rows)})
