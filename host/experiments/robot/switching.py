"""Wheels that may switch between forward and backward by themselves.

Running simulated ones under conditions, and telling what they do.

A wheel switches when its direction changes, by the robot's own rule.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.experiments.robot import unattended
from host.logs.motion import directions
from host.runs.contract import Setting
from host.runs.presets import PAPER, PRESETS
from robot.kick_requests import parse
from robot.kicks import DIRECTION_TICKS, JUMP
from robot.loop import Loop
from robot.params import Params
from sim_motor import robots
from sim_motor.batch import CHANNELS, run
from sim_motor.clock import LATE_MOST_S, VirtualClock
from sim_motor.constants import SUBSTEP_S, Constants, load
from sim_motor.scene import Scene
from sim_motor.wheel_motor import SimMotor
from sim_motor.world import alone

Array = NDArray[np.float64]

SWITCHES, ROLLS, RESTS = "switches", "rolls", "rests"
# A wheel that has not switched for this long has stopped switching: of 100 intervals between
# switches at most one is longer.
QUIET_S = 30.0
# One run of the batch keeps the records of at most this many ticks.
_MOST_TICKS = 2_000_000
_DEFAULT = Params()


@dataclass(frozen=True)
class Condition:
    """How a simulated brick differs from that of the setting; None stands for no difference.

    Attributes:
        max_duty_pct: highest duty cycle (%).
        tick_s: control period (s).
        motor: name of the motor.
        battery_v: open-circuit voltage of the battery (V).
        latency_s: latency of the motors (s).
        rod_lag_s: how much older the rods' positions are than the angle in F_tan (s).
        scene: the floor on which two wheels stand on one body; None if each wheel carries half of
            the body by itself.
    """

    max_duty_pct: float = _DEFAULT.max_duty_pct
    tick_s: float = _DEFAULT.tick_s
    motor: str | None = None
    battery_v: float | None = None
    latency_s: float | None = None
    rod_lag_s: float = 0.0
    scene: Scene | None = None

    def constants(self, setting: Setting) -> Constants:
        """The constants of motor and wheel."""
        published = load(self.motor) if self.motor else setting.constants
        latency_s = published.latency_s if self.latency_s is None else self.latency_s
        return replace(published, latency_s=latency_s)

    def supply_v(self, setting: Setting) -> float:
        """The battery's open-circuit voltage (V)."""
        return self.battery_v or setting.battery_v or self.constants(setting).battery_v

    def params(self, **changes: float) -> Params:
        """The parameters of the loop, with these changes."""
        params = Params()
        params.apply(
            params.check(
                {
                    "max_duty_pct": self.max_duty_pct,
                    "tick_s": self.tick_s,
                    "rod_lag_s": self.rod_lag_s,
                    **changes,
                }
            )
        )
        return params


class Jump(NamedTuple):
    """A jump of the first neuron's potential: in which tick, and by how much (1)."""

    tick: int
    size: float


ORDINARY = "as it is"
DELAYED = "latency of 70 ms"
OLDER_S = PRESETS[PAPER].params["rod_lag_s"]
OLDER = f"rods {1000 * OLDER_S:g} ms older"
ALL_HOLD = f"{OLDER}, on soft axles"
_AA_V = 9.0  # six cells of 1.5 V
_FLOOR = Scene()
CONDITIONS = {
    ORDINARY: Condition(),
    "on one body": Condition(scene=_FLOOR),
    "100 %, 9 V": Condition(max_duty_pct=100.0, battery_v=_AA_V),
    DELAYED: Condition(latency_s=0.07),
    f"{OLDER}, wheels alone": Condition(rod_lag_s=OLDER_S),
    "rods 4 ms older": Condition(rod_lag_s=0.004, scene=_FLOOR),
    OLDER: Condition(rod_lag_s=OLDER_S, scene=_FLOOR),
    ALL_HOLD: Condition(
        rod_lag_s=OLDER_S,
        scene=Scene(**{name: float(value) for name, value in PRESETS[PAPER].scene.items()}),
    ),
    f"{OLDER}, 7.2 V": Condition(rod_lag_s=OLDER_S, scene=_FLOOR, battery_v=7.2),
    f"{OLDER}, ticks of 40 ms": Condition(rod_lag_s=OLDER_S, scene=_FLOOR, tick_s=0.04),
    f"{OLDER}, nxt_unroller": Condition(rod_lag_s=OLDER_S, scene=_FLOOR, motor="nxt_unroller"),
}


def wheels_run(
    condition: Condition,
    setting: Setting,
    wheels: int,
    seconds: float,
    seed: int,
    jump: Jump | None = None,
    **changes: float,
) -> Iterator[Array]:
    """Run wheels from random starts, and yield their records a few wheels at a time.

    The same seed gives the same starts, motors and ticks, with any jump.

    Args:
        condition: how the brick differs from the setting's.
        setting: of the run.
        wheels: how many wheels; an even number on bodies.
        seconds: how long each runs (s).
        seed: seed of all chance.
        jump: a jump of a potential, None for no jump.
        changes: parameters of the loop.

    Yields:
        Records, (wheels, ticks, CHANNELS of sim_motor.batch).
    """
    params = condition.params(**changes)
    ticks = round(seconds / params.tick_s)
    rng = np.random.default_rng(seed)
    published = condition.constants(setting)
    motors = published.specimens(wheels, rng)
    batched = published.latency_s + LATE_MOST_S + 2 * SUBSTEP_S < params.tick_s
    group = max(2, _MOST_TICKS // ticks // 2 * 2) if batched else 2
    for first in range(0, wheels, group):
        some = motors[first : first + group]
        one_seed = int(rng.integers(2**32))
        supply_v = condition.supply_v(setting)
        if not batched:
            yield _loop_run(some, supply_v, params, ticks, one_seed, jump)
            continue
        kick = None if jump is None else parse(_request(jump), (0, 0), params, jump.tick)
        if condition.scene is not None:
            course = robots.run(
                len(some) // 2,
                ticks,
                one_seed,
                condition.scene,
                params=params,
                kick=kick,
                motors=[alone(motor) for motor in some],
                battery_v=supply_v,
            )
            yield course.records.reshape(len(some), ticks, len(CHANNELS))
        else:
            yield run(
                len(some),
                ticks,
                one_seed,
                params=params,
                kick=kick,
                motors=some,
                battery_v=supply_v,
                record=len(some),
            ).records


def _request(jump: Jump) -> dict[str, object]:
    return {"id": "jump", "mode": JUMP, "variable": "x1", "delta": jump.size}


def _loop_run(
    constants: tuple[Constants, ...],
    supply_v: float,
    params: Params,
    ticks: int,
    seed: int,
    jump: Jump | None,
) -> Array:
    """Records of one or two wheels of a robot that runs its whole loop."""
    rng = np.random.default_rng(seed)
    clock = VirtualClock(seed)
    pair = (constants * 2)[:2]
    motors = [
        SimMotor(
            side,
            clock,
            one,
            supply_v,
            1,
            float(rng.uniform(0, 2 * pi)),
            float(rng.uniform(-0.5, 0.5) * one.backlash),
        )
        for side, one in zip(("left", "right"), pair, strict=True)
    ]
    loop = Loop(motors, None, clock, seed)
    loop.set_params(dict(params.values()))
    loop.start()
    records = unattended.run(loop, ticks if jump is None else jump.tick)
    if jump is not None:
        loop.kick(_request(jump))
        records += unattended.run(loop, ticks - jump.tick)
    wheels = [record[-2 * len(CHANNELS) :] for record in records]
    return (
        np.array(wheels, dtype=float)
        .reshape(ticks, 2, len(CHANNELS))
        .swapaxes(0, 1)[: len(constants)]
    )


def switches(phi: Array) -> NDArray[np.int64]:
    """The ticks in which a wheel changed its direction, from its angles (rad), (ticks,)."""
    way = directions(phi)
    moving = np.flatnonzero(way)
    changes = np.flatnonzero(np.diff(way[moving]))
    found = []
    for before, after in zip(moving[changes], moving[changes + 1], strict=True):
        first = before - DIRECTION_TICKS
        found.append(first + int((phi[first : after + 1] * way[before]).argmax()))
    return np.array(found, dtype=np.int64)


def ending(phi: Array, tick_s: float) -> tuple[float, str]:
    """When a wheel switched last (s), and what it does then: SWITCHES, ROLLS or RESTS."""
    found = switches(phi)
    until_s = float(found[-1] * tick_s) if len(found) else 0.0
    if len(phi) * tick_s - until_s < QUIET_S:
        return until_s, SWITCHES
    return until_s, ROLLS if directions(phi)[-1] else RESTS
