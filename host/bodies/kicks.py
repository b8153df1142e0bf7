"""Kicks of a simulated body at set times: read them from words, and run the body with them."""

from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from host.errors import NotDone, WrongUse
from host.util.angles import parse_angle
from robot.errors import Refused
from robot.kick_requests import parse
from robot.kicks import FROZEN_MODES, WAVEFORM, Kick
from robot.params import Params

if TYPE_CHECKING:
    from sim_motor.bodies.body import Body

ALL = "all"
# How long (s) a quenched kick acts by default.
KICK_S = 0.1

_NUMBERS: dict[str, Callable[[str], float]] = {
    "t": float,
    "seconds": float,
    "value": float,
    "delta": float,
    "shift": parse_angle,
}
_WORDS = ("mode", "wheel", "shape", "param", "variable")
_NAMES = (*_NUMBERS, *_WORDS)


class ScheduledKick(NamedTuple):
    """A kick at a set time.

    Attributes:
        t_s: when it begins (s).
        wheels: the names of its wheels.
        seconds: how long it acts (s); None for a frozen kick.
        request: what else robot/kicks.py takes.
    """

    t_s: float
    wheels: tuple[str, ...]
    seconds: float | None
    request: dict[str, Any]

    def kicks(self, step: int, step_s: float, omega: Sequence[float]) -> list[Kick]:
        """The kick of each of its wheels, which begins in this step.

        Args:
            step: number of the step.
            step_s: length of a step (s).
            omega: speed of each of its wheels (rad/s).

        Returns:
            One kick for each of its wheels.

        Raises:
            WrongUse: if the kick is impossible.
        """
        ticks = {} if self.seconds is None else {"ticks": max(1, round(self.seconds / step_s))}
        kicks = []
        for name, speed in zip(self.wheels, omega, strict=True):
            request = {"id": name, **self.request, **ticks}
            try:
                kick = parse(request, (int(np.sign(speed)),) * 2, Params(), step)
            except Refused as refusal:
                raise WrongUse(
                    f"this kick is impossible: {refusal.message}", refusal.hint
                ) from refusal
            kick.wheels = (name,)
            kicks.append(kick)
        return kicks


def parse_kick(text: str, wheels: Sequence[str]) -> ScheduledKick:
    """Read a kick from words such as "t=5,mode=membrane,wheel=all".

    Args:
        text: NAME=VALUE parts, separated by commas, with any of t, mode, wheel, seconds, shift,
            shape, param, value, variable and delta.
        wheels: names of the body's wheels. A kick's wheel is one of them ("car2_left"), a part of
            their names ("car2", "left"), or "all".

    Returns:
        The kick, checked as far as it can be before the body runs.

    Raises:
        WrongUse: if the kick or the wheel does not exist.
    """
    fields = _parse_fields(text)
    time_s, wheel = fields.pop("t", None), fields.pop("wheel", ALL)
    if time_s is None:
        raise WrongUse(f"the kick '{text}' has no time", "add t=SECONDS, for example t=5")
    if not 0.0 <= time_s < float("inf"):
        raise WrongUse(f"the time of a kick cannot be {time_s}", "write t=SECONDS, 0 or more")
    if not 0.0 < fields.get("seconds", KICK_S) < float("inf"):
        raise WrongUse(f"a kick cannot last {fields['seconds']} s", "write seconds=..., above 0")
    chosen = tuple(name for name in wheels if wheel == ALL or wheel in (name, *name.split("_")))
    if not chosen:
        raise WrongUse(
            f"there is no wheel '{wheel}'",
            f"write wheel={ALL}, left, right, car0, or one of {', '.join(wheels)}",
        )
    if fields.get("mode") == WAVEFORM:
        raise WrongUse(
            "a waveform is made for a robot's ticks, and a body has none",
            "write mode=pulse with shape=rectangular or shape=smooth",
        )
    default_s = None if fields.get("mode") in FROZEN_MODES else KICK_S
    scheduled = ScheduledKick(time_s, chosen, fields.pop("seconds", default_s), fields)
    # Find out now, with any step and speeds, what is wrong with the kick.
    scheduled.kicks(0, 0.001, [1.0] * len(chosen))
    return scheduled


def _parse_fields(text: str) -> dict[str, Any]:
    fields: dict[str, Any] = {}
    for part in text.split(","):
        name, _, value = part.strip().partition("=")
        if name not in _NAMES or not value:
            raise WrongUse(
                f"'{part.strip()}' in the kick '{text}' means nothing",
                f"write NAME=VALUE, separated by commas; the names are {', '.join(_NAMES)}",
            )
        if name in fields:
            raise WrongUse(f"the kick '{text}' has more than one {name}", "write it once")
        try:
            fields[name] = _NUMBERS[name](value) if name in _NUMBERS else value
        except (ValueError, ArgumentTypeError) as error:
            raise WrongUse(
                f"{name} of a kick cannot be '{value}'",
                "write a number, and a comma before the next name",
            ) from error
    return fields


def run_with_kicks(
    body: Body,
    seconds: float,
    scheduled: Sequence[ScheduledKick],
    watch: Callable[[float], None],
) -> None:
    """Let a body run, and kick it at the set times.

    Args:
        body: runs on from where it is.
        seconds: for how long (s).
        scheduled: its kicks, in any order.
        watch: called with the body's time (s) as it runs.

    Raises:
        NotDone: if the simulation becomes unstable.
    """
    from sim_motor.bodies.body import Unstable

    end = body.time_s + seconds
    waiting = sorted(scheduled, key=lambda kick: kick.t_s)
    step_s = float(body.model.opt.timestep)
    try:
        while body.time_s < end - step_s / 2:
            while waiting and waiting[0].t_s <= body.time_s + step_s / 2:
                due = waiting.pop(0)
                omega = body.omega[[body.wheels.index(name) for name in due.wheels]]
                for kick in due.kicks(body.step, step_s, omega.tolist()):
                    body.kick(kick)
            until = min([end, *(kick.t_s for kick in waiting[:1])])
            body.run(until - body.time_s, watch)
    except Unstable as error:
        raise NotDone(
            str(error), "try a smaller k, drag or torque, or fewer cars where there are walls"
        ) from error
