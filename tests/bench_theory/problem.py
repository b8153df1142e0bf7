"""What every engine has to compute.

Wheels at random points of the (k, tau) plane, and how far its averages may be from the truth.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from host.theory.engine.ensemble import rate_per_s
from host.theory.model.wheel import Array, Wheel

TRANSIENT_S = MEASURED_S = 100.0
START = (1.0, 0.0, 0.3, 1.0)
TAU_S, K = (0.02, 1.5), (0.0, 20.0)
WORKERS = 2


class Averages(NamedTuple):
    """abs(mean(omega)) and std(omega) in rad/s, (wheels,).

    After a chaotic transient, the mean's sign is an accident of rounding.
    """

    mean: Array
    std: Array


class Contestant(NamedTuple):
    """An engine with its setting.

    prepare: given all it will have to do, as parameters (6, wheels), compiles what it needs, and
    returns the function that does it. every: it does one of `every` points only, because it
    is slow.
    """

    name: str
    setting: str
    every: int
    prepare: Callable[[Array], Callable[[], Averages]]


def random_points(count: int, seed: int) -> Array:
    """Parameters (6, count), fastest wheels last: neighbours need about the same steps."""
    chance = np.random.default_rng(seed)
    tau_s, k = chance.uniform(*TAU_S, count), chance.uniform(*K, count)
    parameters = np.array([Wheel(tau=tau_s[i], k=k[i]) for i in range(count)]).T
    return np.ascontiguousarray(parameters[:, np.argsort(rate_per_s(parameters), kind="stable")])


def starts(count: int) -> Array:
    """The state in which all wheels begin, (4, count).

    Off the fixpoints and on no symmetry's axis.
    """
    return np.repeat(np.array(START)[:, None], count, axis=1)


def averages(at_start: Any, at_end: Any) -> Averages:
    """Averages, from states (4, wheels) before and (5, wheels) after measuring.

    The fifth is the integral of (omega - omega at the beginning)^2: with that of omega^2 every
    engine would lose digits of std(omega).
    """
    at_start, at_end = np.asarray(at_start), np.asarray(at_end)
    mean = (at_end[2] - at_start[2]) / MEASURED_S
    variance = at_end[4] / MEASURED_S - (mean - at_start[3]) ** 2
    return Averages(
        np.abs(mean).astype(np.float64), np.sqrt(np.maximum(variance, 0.0)).astype(np.float64)
    )


def difference(one: Averages, other: Averages) -> Array:
    """How far apart they are, (2, wheels): in the mean, in the standard deviation."""
    return np.abs(np.array(one) - np.array(other))
