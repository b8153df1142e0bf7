"""Simulated bodies for people.

A car or a train from what was asked for, its kicks from words, errors in words.
"""

from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from host.errors import NotDone, WrongUse
from host.util.angles import parse_angle
from host.util.extras import need
from robot.errors import Refused
from robot.kicks import FROZEN_MODES, Kick, parse
from robot.params import Params

if TYPE_CHECKING:
    import mujoco

    from sim_motor.bodies.body import Body
    from sim_motor.bodies.presets import Preset

CARS_OF_A_TRAIN = 5
# How wheels stand at the start: where the rods pull all of them forward, or at random.
PUSHED_FORWARD, RANDOM = "pushed", "random"
ALL = "all"
# How long (s) a quenched kick acts if nothing is said.
KICK_S = 0.1


class Asked(NamedTuple):
    """What a body is to be, in SI units; None is the preset's own.

    K is in N, drag in the preset's unit, torque in N m.

    start: of the wheels, PUSHED_FORWARD or RANDOM; by default a car is pushed, as one that starts
    at random mostly comes to rest, and a train is not.
    """

    cars: int = 1
    scene: str = "flat"
    preset: str = "paper"
    seed: int = 1
    a: float | None = None
    k: float | None = None
    tau: float | None = None
    drag: float | None = None
    angle: float | None = None
    bouncy: bool = False
    torque: float | None = None
    start: str | None = None
    timestep: float = 0.001


def preset_of(asked: Asked) -> Preset:
    """The preset with the numbers that were given instead. Raises WrongUse."""
    from sim_motor.bodies.presets import NAMES, preset

    if asked.preset not in NAMES:
        raise WrongUse(f"there is no preset '{asked.preset}'", f"there are {', '.join(NAMES)}")
    own = preset(asked.preset)
    if asked.drag is not None:
        own = own.with_drag(asked.drag)
    given = {"a": asked.a, "tau": asked.tau, "k": asked.k}
    with worded():
        return own._replace(
            **{name: value for name, value in given.items() if value is not None}
        ).checked()


def spec_of(asked: Asked) -> mujoco.MjSpec:
    """The scene with the cars in it, not yet compiled. Raises WrongUse."""
    need("mujoco", "bodies")
    from sim_motor.bodies.model import compose

    for name, value in (
        ("angle", asked.angle),
        ("torque", asked.torque),
        ("timestep", asked.timestep),
    ):
        if value is not None and not isfinite(value):
            raise WrongUse(f"{name} cannot be {value!r}", "give a finite number")
    own = preset_of(asked)
    with worded():
        shape: Any = {
            "seed": asked.seed,
            "angle": asked.angle,
            "bouncy": asked.bouncy,
            "timestep": asked.timestep,
        }
        return compose(own, asked.scene, asked.cars, **shape)


def body_of(asked: Asked, spec: mujoco.MjSpec | None = None) -> Body:
    """The body, at rest. spec: as `spec_of` has made it for the same. Raises WrongUse."""
    model = compiled(spec_of(asked) if spec is None else spec)
    from sim_motor.bodies.body import Body
    from sim_motor.bodies.presets import PUSHED

    start = asked.start or (PUSHED_FORWARD if asked.cars == 1 else RANDOM)
    phases = np.full(2 * asked.cars, PUSHED) if start == PUSHED_FORWARD else None
    return Body(model, preset_of(asked), seed=asked.seed, torque=asked.torque, phases=phases)


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """The model of a spec. Raises WrongUse if MuJoCo cannot make one."""
    with worded():
        return spec.compile()


@contextmanager
def worded() -> Iterator[None]:
    """Have what sim_motor finds wrong told as this host tells it."""
    try:
        yield
    except ValueError as error:
        raise WrongUse(str(error), "kickctl body --help tells what there is") from error


class Push(NamedTuple):
    """A kick that was asked for: when (s), on which wheels, how long (s.

    None of a frozen kick), and what else robot/kicks.py takes.
    """

    t_s: float
    wheels: tuple[str, ...]
    seconds: float | None
    request: dict[str, Any]

    def kicks(self, step: int, step_s: float, omega: Sequence[float]) -> list[Kick]:
        """The kick of each of its wheels, which turn at omega (rad/s), to begin in this step.

        Raises WrongUse.
        """
        ticks = {} if self.seconds is None else {"ticks": max(1, round(self.seconds / step_s))}
        found = []
        for name, speed in zip(self.wheels, omega, strict=True):
            request = {"id": name, **self.request, **ticks}
            try:
                kick = parse(request, (int(np.sign(speed)),) * 2, Params(), step)
            except Refused as refusal:
                raise WrongUse(f"no such kick: {refusal.message}", refusal.hint) from refusal
            kick.wheels = (name,)
            found.append(kick)
        return found


_NUMBERS: dict[str, Callable[[str], float]] = {
    "t": float,
    "seconds": float,
    "value": float,
    "delta": float,
    "shift": parse_angle,
}
_WORDS = ("mode", "wheel", "shape", "param", "variable")


def push_of(text: str, wheels: Sequence[str]) -> Push:
    """A kick from "t=5,mode=membrane,wheel=all".

    Any of t, mode, wheel, seconds, shift, shape, param, value, variable, delta.

    wheels: the body's; a kick's wheel is one of them, all of those whose names it is a part of
    (car2, left), or "all". Raises WrongUse.
    """
    fields: dict[str, Any] = {}
    for part in text.split(","):
        name, _, value = part.strip().partition("=")
        if name not in (*_NUMBERS, *_WORDS) or not value:
            raise WrongUse(
                f"'{part.strip()}' is no part of a kick",
                f"write NAME=VALUE with {', '.join((*_NUMBERS, *_WORDS))}",
            )
        if name in fields:
            raise WrongUse(f"a kick has one {name}, and '{text}' has more", "write it once")
        try:
            fields[name] = _NUMBERS[name](value) if name in _NUMBERS else value
        except (ValueError, ArgumentTypeError) as error:
            raise WrongUse(f"{name} of a kick cannot be '{value}'", "give a number") from error
    time_s, wheel = fields.pop("t", None), fields.pop("wheel", ALL)
    if time_s is None or not 0.0 <= time_s < float("inf"):
        raise WrongUse(f"a kick's time cannot be {time_s}", "write t=SECONDS, 0 or more")
    if not 0.0 < fields.get("seconds", KICK_S) < float("inf"):
        raise WrongUse(f"a kick cannot last {fields['seconds']} s", "write seconds=..., above 0")
    chosen = tuple(name for name in wheels if wheel == ALL or wheel in (name, *name.split("_")))
    if not chosen:
        raise WrongUse(
            f"there is no wheel '{wheel}'",
            f"write wheel={ALL}, left, right, car0, or one of {', '.join(wheels)}",
        )
    frozen = fields.get("mode") in FROZEN_MODES
    push = Push(time_s, chosen, fields.pop("seconds", None if frozen else KICK_S), fields)
    push.kicks(0, 0.001, [1.0] * len(chosen))  # refuses what can be refused before anything runs
    return push


def run(body: Body, seconds: float, pushes: Sequence[Push], watch: Any) -> None:
    """Let a body run, kicked at its times; `watch` is told the time as it goes.

    Raises NotDone if it cannot be followed to the end.
    """
    from sim_motor.bodies.body import Unstable

    end = body.time_s + seconds
    waiting = sorted(pushes, key=lambda push: push.t_s)
    step_s = float(body.model.opt.timestep)
    try:
        while body.time_s < end - step_s / 2:
            while waiting and waiting[0].t_s <= body.time_s + step_s / 2:
                push = waiting.pop(0)
                omega = body.omega[[body.wheels.index(name) for name in push.wheels]]
                for kick in push.kicks(body.step, step_s, omega.tolist()):
                    body.kick(kick)
            until = min([end, *(push.t_s for push in waiting[:1])])
            body.run(until - body.time_s, watch)
    except Unstable as error:
        raise NotDone(
            str(error),
            "with a smaller k, drag or torque, or fewer cars where there are walls, it can be",
        ) from error
