"""The kick map: how many simulated wheels a kick reverses.

It depends on the kick's kind and length, and on the wheel's direction and phase when the kick
begins.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from math import degrees, pi, radians
from typing import TYPE_CHECKING, Any, TypedDict

from robot.kick_requests import parse
from robot.kicks import DEFAULT_SHIFT_RAD, PHASE, POSITION
from robot.params import Params
from sim_motor.constants import Constants, load

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sim_motor.batch import Result


class KickCell(TypedDict):
    """A kick.

    Attributes:
        mode: membrane, position or phase.
        sign: sign of the phase shift; 0 for other kicks.
        ticks: length in ticks.
    """

    mode: str
    sign: int
    ticks: int


class Counts(TypedDict):
    """Kicks that met wheels of one direction in one bin of phases.

    Attributes:
        before: direction of the wheels, 1 forward or -1 backward.
        phase: number of the bin, from 0; see `phase_bin`.
        tried: how many kicks.
        reversed: how many of them reversed the wheel.
    """

    before: int
    phase: int
    tried: int
    reversed: int


class Row(KickCell, Counts):
    """A row of the map: a kick and what it did."""


# Mode, and sign of the shift. For phase kicks, the paper names the sign of the wheel's direction.
KINDS = ((POSITION, 0), (PHASE, 1), (PHASE, -1))
# A bin has ten counts of the encoder: half of what a wheel at 2 Hz turns in a tick. A kick cannot
# be timed better than to a tick.
PHASE_BINS = 36
_BIN_DEG = 360 / PHASE_BINS
# Lengths worth trying. The longest lasts three quarters of a turn at 2 Hz. Inverted positions and
# shifts of 3/4 pi act against the motion for about half a turn; then the wheel has turned around.
LENGTHS = tuple(range(1, 13))
_LENGTH_STEP_S = 0.03
# How long a wheel takes from rest into its cycle, and back into it after a kick: a part for
# friction and inertia, and one for the memory of the potentials.
_SETTLE_S, _WATCH_S, _MEMORY_TAU = 3.0, 2.0, 8.0
_PATIENCE_S = 15.0
# With a shorter tick than this, a tick as late as on the brick would be missed. Wheels are then
# computed without delays.
_LEAST_LATE_TICK_S = 0.02
# How many specimens of the motor are kicked at most, and how many wheels share one before that.
_SPECIMENS, _WHEELS_OF_A_SPECIMEN = 64, 20


def request(mode: str, ticks: int, shift_rad: float | None) -> dict[str, Any]:
    """A kick as robot.kick_requests.parse takes it, without its id."""
    return {"mode": mode, "ticks": ticks} | ({} if shift_rad is None else {"shift": shift_rad})


def shift_of(sign: int) -> float | None:
    """The shift (rad) of a phase kick of this sign; None for 0, a position kick."""
    return sign * DEFAULT_SHIFT_RAD if sign else None


def phase_bin(phi_rad: float) -> int:
    """The bin of an angle (rad). Edges lie between counts of the encoder, where no angle is."""
    return int((degrees(phi_rad) + 0.5) % 360 // _BIN_DEG)


def bin_edges_rad(number: int) -> tuple[float, float]:
    """The angles between which a bin lies."""
    return radians(number * _BIN_DEG - 0.5), radians((number + 1) * _BIN_DEG - 0.5)


def period_rad(rods: int) -> float:
    """The turn (rad) after which a robot's wheel looks the same."""
    return pi / 2 if rods == 2 else pi


def lengths(tick_s: float) -> list[int]:
    """Lengths of kicks (ticks) worth trying at this control period."""
    return sorted({max(1, round(number * _LENGTH_STEP_S / tick_s)) for number in LENGTHS})


def settle_ticks(params: Params) -> int:
    """How many ticks a wheel takes from rest into its cycle."""
    return span_ticks(_SETTLE_S, params)


def watch_ticks(params: Params) -> int:
    """How many ticks a wheel takes back into a cycle after a kick."""
    return span_ticks(_WATCH_S, params)


def span_ticks(least_s: float, params: Params) -> int:
    """How many ticks a wheel takes to settle: some time (s), and the potentials' memory."""
    ticks: int = round(min(_PATIENCE_S, least_s + _MEMORY_TAU * params.tau_s) / params.tick_s)
    return ticks


def times_of(ticks: int, params: Params) -> NDArray[np.float64] | None:
    """When ticks begin (s), (ticks,): exactly in time if they are short; None for by chance."""
    import numpy as np

    return None if params.tick_s >= _LEAST_LATE_TICK_S else np.arange(ticks) * params.tick_s


def kick_specimens(
    kick: Mapping[str, Any],
    wheels: int,
    seed: int,
    *,
    params: Params,
    motor: Constants | None = None,
    battery_v: float | None = None,
) -> Result:
    """Kick simulated wheels that have settled, each at a phase by chance.

    Args:
        kick: The kick, as robot.kick_requests.parse takes it, without its id.
        wheels: How many wheels.
        seed: The random seed.
        params: The robot's parameters.
        motor: The wheels have specimens of this motor, within its published spread; by default of
            the published one.
        battery_v: The battery's voltage, V; None for the motor's nominal one.
    """
    import numpy as np

    from sim_motor.batch import run

    rng = np.random.default_rng(seed)
    specimens = min(_SPECIMENS, 1 + wheels // _WHEELS_OF_A_SPECIMEN)
    motors = (motor or load()).specimens(specimens, rng)
    own = parse({"id": "map", **kick}, (0, 0), params, settle_ticks(params))
    whole = own.begin + own.ticks + watch_ticks(params)
    chance = int(rng.integers(2**32))
    return run(
        wheels,
        whole,
        chance,
        params=params,
        kick=own,
        motors=motors,
        battery_v=battery_v,
        times=times_of(whole, params),
    )


def tally(
    mode: str,
    sign: int,
    ticks: int,
    wheels: int,
    seed: int,
    *,
    params: Params,
    motor: Constants | None = None,
    battery_v: float | None = None,
) -> list[Counts]:
    """Kick simulated wheels that have settled, each at a phase by chance, and count.

    Args:
        mode: The kick's mode.
        sign: The sign of a phase shift; 0 for other kicks.
        ticks: The kick's length.
        wheels: How many wheels. Those that rest before the kick do not count.
        seed: The random seed.
        params: The robot's parameters.
        motor: The wheels have specimens of this motor, within its published spread; by default of
            the published one.
        battery_v: The battery's voltage, V; None for the motor's nominal one.

    Returns:
        A row for each direction and bin of phases in which a wheel met the kick.
    """
    result = kick_specimens(
        request(mode, ticks, shift_of(sign)),
        wheels,
        seed,
        params=params,
        motor=motor,
        battery_v=battery_v,
    )
    met = [
        (before, phase_bin(phi))
        for before, phi in zip(result.before.tolist(), result.kick_phi_rad.tolist(), strict=True)
    ]
    tried = Counter(met)
    reverses = Counter(
        place for place, reverse in zip(met, result.reversed.tolist(), strict=True) if reverse
    )
    return [
        {"before": before, "phase": phase, "tried": number, "reversed": reverses[before, phase]}
        for (before, phase), number in sorted(tried.items())
        if before
    ]


def count(rows: Iterable[Counts]) -> tuple[int, int]:
    """(reversed, tried) of some rows together."""
    done = tried = 0
    for row in rows:
        done, tried = done + row["reversed"], tried + row["tried"]
    return done, tried
