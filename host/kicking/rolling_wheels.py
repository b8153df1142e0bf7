"""Simulated wheels that roll, at the moment before a kick: which kick reverses which of them.

All kicks meet the same wheels, with the published motor and ticks on time, so that kicks can be
compared. A robot's wheels look the same after a quarter turn, with one rod after half a turn: the
phase of a wheel is its angle within that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.kicking.kick_map import period_rad, settle_ticks, watch_ticks
from robot.kick_requests import parse
from robot.params import Params
from sim_motor.arrays import Array
from sim_motor.batch import Start, random_start, run
from sim_motor.constants import Constants
from sim_motor.replay import replay

# About half of them roll each way: at 2 turns a second, eight of those meet a kick in each tick.
WHEELS = 64
# A kick begins in this tick: the first one has no reading before it, which older rods need.
BEGIN = 1
_SEED = 1


@dataclass(frozen=True)
class Window:
    """The phases of a wheel at which a kick reverses it.

    Attributes:
        first_rad: Where they begin, rad.
        width_rad: How far they go, rad; the whole period if the kick reverses at any phase.
    """

    first_rad: float
    width_rad: float

    def holds(self, phases: Array, period_rad: float, part: float = 1.0) -> NDArray[np.bool_]:
        """Which phases (rad) lie in the window, or in its inner part."""
        aside = (1.0 - part) / 2 * self.width_rad
        past = (phases - self.first_rad - aside) % period_rad
        return np.asarray(past <= part * self.width_rad)


@dataclass(frozen=True)
class RollingWheels:
    """Wheels that roll one way.

    Attributes:
        params: The robot's parameters.
        motor: The motor's constants.
        battery_v: The battery's voltage, V.
        start: Where they are in the tick before the kick.
        way: The direction in which they roll, 1 or -1.
        step_rad: How far they turn in a tick, rad.
    """

    params: Params
    motor: Constants
    battery_v: float
    start: Start
    way: int
    step_rad: float

    @property
    def period_rad(self) -> float:
        """The turn after which a wheel looks the same, rad."""
        return period_rad(self.params.rods)

    def kicked(self, request: Mapping[str, Any]) -> tuple[Array, NDArray[np.bool_]]:
        """What a kick does to them.

        Args:
            request: The kick, as robot.kick_requests.parse takes it, without its id.

        Returns:
            The phases at which it began, rad, and whether it reversed the wheel, (wheels,),
            in the order of the phases.
        """
        kick = parse({"id": "search", **request}, (self.way,) * 2, self.params, BEGIN)
        whole = BEGIN + kick.ticks + watch_ticks(self.params)
        result = run(
            len(self.start.states),
            whole,
            0,
            params=self.params,
            kick=kick,
            motors=(self.motor,),
            battery_v=self.battery_v,
            start=self.start,
            times=self.params.tick_s * np.arange(whole),
        )
        phases = result.kick_phi_rad % self.period_rad
        order = np.argsort(phases)
        return phases[order], (result.after == -self.way)[order]

    def window(self, request: Mapping[str, Any]) -> Window | None:
        """The longest run of phases at which a kick reverses all wheels that it meets.

        Returns:
            The window; None if the kick reverses no two neighbours.
        """
        phases, reverses = self.kicked(request)
        if reverses.all():
            return Window(0.0, self.period_rad)
        # From a wheel that is not reversed, once around.
        begin = int(np.argmin(reverses))
        phases, reverses = np.roll(phases, -begin), np.roll(reverses, -begin)
        edges = np.flatnonzero(np.diff(np.concatenate([reverses, [False]]).astype(int)))
        runs = [
            Window(float(phases[first + 1]), float((phases[last] - phases[first + 1]) % period))
            for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
            for period in (self.period_rad,)
        ]
        widest = max(runs, key=lambda found: found.width_rad, default=None)
        return widest if widest and widest.width_rad > 0.0 else None


def roll(
    params: Params, motor: Constants, way: int, battery_v: float | None = None
) -> RollingWheels | None:
    """Wheels that have settled and roll this way.

    Args:
        params: The robot's parameters.
        motor: The motor's constants.
        way: 1 forward, -1 backward.
        battery_v: The battery's voltage, V; None for the motor's nominal one.

    Returns:
        The wheels; None if at most one of WHEELS rolls this way.

    Raises:
        WrongUse: Nobody can simulate this motor with this control period.
    """
    rng = np.random.default_rng(_SEED)
    start = random_start(WHEELS, rng, motor)
    ticks = settle_ticks(params)
    times = params.tick_s * np.arange(ticks)
    volts = motor.battery_v if battery_v is None else battery_v
    try:
        settled = run(
            WHEELS,
            ticks,
            0,
            params=params,
            motors=(motor,),
            battery_v=volts,
            start=start,
            times=times,
            record=WHEELS,
        )
    except ValueError as error:
        raise WrongUse(
            f"this robot's kicks cannot be simulated: {error}", "take a longer tick_s"
        ) from error
    rows = np.flatnonzero(settled.after == way)
    if len(rows) < 2:
        return None
    phi, x1, x2, _, _, duty = np.moveaxis(settled.records[rows], 2, 0)
    duties = duty.astype(np.int64)
    # A tick at rest before the first one: `replay` takes the first duty to act from the beginning.
    ends, _ = replay(
        start.states[rows],
        np.concatenate([[-params.tick_s], times]),
        np.pad(duties, ((0, 0), (1, 0))),
        ticks * params.tick_s,
        (motor,),
        np.full(len(rows), volts),
    )
    turns = np.abs(phi[:, -1] - phi[:, ticks // 2]) / (ticks - 1 - ticks // 2)
    return RollingWheels(
        params,
        motor,
        volts,
        Start(ends, np.stack([x1[:, -1], x2[:, -1]], axis=1), duties[:, -1]),
        way,
        float(turns.mean()),
    )
