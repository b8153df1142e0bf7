"""Which attractor a wheel is on: at rest, forth-and-back, rolling, or chaotic.

A time average over a window that opens and closes smoothly converges fast if the motion is regular,
periodic or quasi-periodic, and slowly if it is chaotic (Das, Sander, Yorke et al., Nonlinearity 30,
2017): two such windows, one after the other, agree or do not.
"""

from __future__ import annotations

from functools import cache
from math import pi
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.engine.elementary import sin, vectorised
from host.theory.engine.ensemble import FINE, advance, rates_under
from host.theory.model.laws import Law, law_of
from host.theory.model.wheel import OMEGA, Array

Kind = Literal["at rest", "forth-and-back", "rolling", "chaotic"]
KINDS: tuple[Kind, ...] = ("at rest", "forth-and-back", "rolling", "chaotic")
REST, BACK, ROLL, CHAOS = range(4)

# Two windows agree if their averages differ by less than this part of the motion's size.
AGREE = 3e-4
# A slower wheel (rad/s) rests.
STILL = 1e-3
# A wheel rolls one way if the mean of omega is more than this many of its standard deviations.
STEADY = 2.0
# A wheel is in its well if the mean of sin^2(2 phi) is below this. It is 1 at the saddles between
# wells, and above 0.4 for a wheel that goes to and fro over them.
IN_WELL = 0.25
# A largest exponent closer to 0 than this (1/s) counts as 0.
NEAR_ZERO = 0.05
_MEAN_SIN_6 = 5.0 / 16.0


class Watched(NamedTuple):
    """What wheels did in the later of two windows of time.

    Attributes:
        omega_mean: mean of omega, rad/s, (wheels,).
        omega_std: standard deviation of omega, rad/s, (wheels,).
        off_well: mean of sin^2(2 phi), (wheels,): how far from the middle of a well.
        apart: greatest difference to the averages of the earlier window, relative to the size of
            the motion, (wheels,).
        states: where the wheels ended, (4, wheels).
    """

    omega_mean: Array
    omega_std: Array
    off_well: Array
    apart: Array
    states: Array

    def kinds(self) -> NDArray[np.int64]:
        """The attractor of each wheel, as an index of KINDS, (wheels,).

        A wheel that still settles within its well, or rolls one way, is not chaotic.
        """
        regular, mean = self.apart < AGREE, np.abs(self.omega_mean)
        size = np.hypot(mean, self.omega_std)
        cases = (
            size < STILL,
            mean > STEADY * self.omega_std,
            self.off_well < IN_WELL,
            ~regular,
            mean > AGREE * size,
        )
        return np.select(cases, (REST, ROLL, BACK, CHAOS, ROLL), BACK)


def kinds_by_exponents(watched: Watched, exponents: Array) -> NDArray[np.int64]:
    """The attractor of each wheel, which is chaotic if its largest exponent is above 0.

    Args:
        watched: What the wheels did.
        exponents: Their largest Lyapunov exponents, 1/s, (wheels,).

    Returns:
        Indices of KINDS, (wheels,). A wheel that rolls irregularly is chaotic, too, even if it
        never turns round.
    """
    by_motion = watched.kinds()
    moves, grows = by_motion != REST, exponents > NEAR_ZERO
    mean, size = np.abs(watched.omega_mean), np.hypot(watched.omega_mean, watched.omega_std)
    regular = np.where(by_motion != CHAOS, by_motion, np.where(mean > AGREE * size, ROLL, BACK))
    return np.where(moves & grows, CHAOS, regular)


@cache
def _windowed_rates(law: Law) -> Any:
    """The compiled rates of wheels, and of weighted averages over a window.

    Rows 0 to 3 are the wheel, row 4 is the part of the window that is over, row 5 its rate; rows 6
    to 8 are the averages.
    """
    own_rates = rates_under(law)

    def windowed_rates(states: Array, parameters: Array, out: Array) -> None:
        own_rates(states[:4], parameters, out[:4])
        for i in range(states.shape[1]):
            wave, double = sin(pi * states[4, i]), sin(2.0 * states[2, i])
            weight = states[5, i] * wave * wave * wave * wave * wave * wave / _MEAN_SIN_6
            out[4, i] = states[5, i]
            out[5, i] = 0.0
            out[6, i] = weight * states[3, i]
            out[7, i] = weight * states[3, i] * states[3, i]
            out[8, i] = weight * double * double

    return vectorised(windowed_rates)


def window(
    states: Array, parameters: Array, seconds: float, fineness: float = FINE
) -> tuple[Array, Array]:
    """Averages over a window of time that opens and closes smoothly.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        seconds: Length of the window, s.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Returns:
        The averages of omega, omega^2 and sin^2(2 phi), (3, wheels), and the last states,
        (4, wheels).

    Raises:
        WrongUse: Wheels are too stiff to be followed.
    """
    extra = np.zeros((5, states.shape[1]))
    extra[1] = 1.0 / seconds
    own_rates = _windowed_rates(law_of(parameters))
    ended = advance(np.vstack([states, extra]), parameters, seconds, fineness, own_rates)
    return ended[6:], ended[: OMEGA + 1]


def watch(states: Array, parameters: Array, seconds: float, fineness: float = FINE) -> Watched:
    """Watch wheels that have settled, in two windows of time.

    Args:
        states: Where the wheels start, (4, wheels).
        parameters: Their constants, (constants, wheels).
        seconds: Length of both windows together, s.
        fineness: Steps per unit of a wheel's rate (see host.theory.engine.ensemble).

    Returns:
        What the wheels did.

    Raises:
        WrongUse: Wheels are too stiff to be followed.
    """
    first, between = window(states, parameters, seconds / 2, fineness)
    last, ended = window(between, parameters, seconds / 2, fineness)
    size = np.sqrt(np.maximum(np.maximum(first[1], last[1]), STILL**2))
    apart = np.max(np.abs(last - first) / np.array([size, size**2, np.ones_like(size)]), axis=0)
    return Watched(last[0], np.sqrt(np.maximum(last[1] - last[0] ** 2, 0.0)), last[2], apart, ended)


def settle(states: Array, parameters: Array, seconds: float, fineness: float = FINE) -> Array:
    """The states of wheels after some time, (4, wheels).

    Does what `advance` does, with the function that `watch` compiles anyway. Raises WrongUse if
    wheels are too stiff to be followed.
    """
    return window(states, parameters, seconds, fineness)[1]


def random_starts(count: int, rng: np.random.Generator, fastest: float = 20.0) -> Array:
    """Random states.

    Args:
        count: How many.
        rng: The source of chance.
        fastest: The greatest speed, rad/s.

    Returns:
        Any angle, any speed up to `fastest`, and the potentials of rest at another angle,
        (4, count).
    """
    remembered, phi = rng.uniform(-pi, pi, (2, count))
    return np.array(
        [np.cos(remembered), np.sin(remembered), phi, rng.uniform(-fastest, fastest, count)]
    )
