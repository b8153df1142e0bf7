"""Which attractor a wheel is on: at rest, forth-and-back, rolling, or chaotic.

A time average over a window that opens and closes smoothly converges fast if the motion is regular,
periodic or quasi-periodic, and slowly if it is chaotic (Das, Sander, Yorke et al., Nonlinearity 30,
2017): two such windows, one after the other, agree or do not.
"""

from __future__ import annotations

from math import pi
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.engine.elementary import sin, vectorised
from host.theory.engine.ensemble import FINE, advance, wheel_rates
from host.theory.model.wheel import OMEGA, Array

Kind = Literal["at rest", "forth-and-back", "rolling", "chaotic"]
KINDS: tuple[Kind, ...] = ("at rest", "forth-and-back", "rolling", "chaotic")
REST, BACK, ROLL, CHAOS = range(4)

# Two windows agree if their averages differ by less than this part of the motion's size.
AGREE = 3e-4
# Slower (rad/s) is rest. A wheel keeps its direction if omega is this much steadier than its mean.
# A wheel in its well has a mean sin^2(2 phi) below the last number: it is 1 at the saddles between
# wells, and above 0.4 for a wheel that goes to and fro over them.
STILL, STEADY, IN_WELL = 1e-3, 2.0, 0.25
_MEAN_SIN_6 = 5.0 / 16.0


class Watched(NamedTuple):
    """What wheels did in the later of two windows.

    Mean and standard deviation of omega (rad/s), mean of sin^2(2 phi), (wheels,).

    apart: by how much, in parts of the motion's size, the earlier window's averages differ. states:
    in which the wheels ended, (4, wheels).
    """

    omega_mean: Array
    omega_std: Array
    off_well: Array
    apart: Array
    states: Array

    def kinds(self) -> NDArray[np.int64]:
        """Indices of KINDS, (wheels,).

        What still settles within its well, or without turning round, is no chaos.
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


@vectorised
def _windowed_rates(states: Array, parameters: Array, out: Array) -> None:
    """The rates of wheels; of what part of the window is over, row 4, with its own rate below.

    And of the averages, rows 6 to 8.
    """
    wheel_rates(states[:4], parameters, out[:4])
    for i in range(states.shape[1]):
        wave, double = sin(pi * states[4, i]), sin(2.0 * states[2, i])
        weight = states[5, i] * wave * wave * wave * wave * wave * wave / _MEAN_SIN_6
        out[4, i] = states[5, i]
        out[5, i] = 0.0
        out[6, i] = weight * states[3, i]
        out[7, i] = weight * states[3, i] * states[3, i]
        out[8, i] = weight * double * double


def window(
    states: Array, parameters: Array, seconds: float, fineness: float = FINE
) -> tuple[Array, Array]:
    """(averages of omega, omega^2 and sin^2(2 phi), (3, wheels).

    Last states) over a smooth window of so many seconds.
    """
    extra = np.zeros((5, states.shape[1]))
    extra[1] = 1.0 / seconds
    ended = advance(np.vstack([states, extra]), parameters, seconds, fineness, _windowed_rates)
    return ended[6:], ended[: OMEGA + 1]


def watch(states: Array, parameters: Array, seconds: float, fineness: float = FINE) -> Watched:
    """Watch wheels, (4, wheels), for so many seconds, in two windows.

    They should have settled before; raises WrongUse as `advance`.
    """
    first, between = window(states, parameters, seconds / 2, fineness)
    last, ended = window(between, parameters, seconds / 2, fineness)
    size = np.sqrt(np.maximum(np.maximum(first[1], last[1]), STILL**2))
    apart = np.max(np.abs(last - first) / np.array([size, size**2, np.ones_like(size)]), axis=0)
    return Watched(last[0], np.sqrt(np.maximum(last[1] - last[0] ** 2, 0.0)), last[2], apart, ended)


def settle(states: Array, parameters: Array, seconds: float, fineness: float = FINE) -> Array:
    """The states of wheels after some time.

    As `advance`, with less to compile for those that watch them too.
    """
    return window(states, parameters, seconds, fineness)[1]


def random_starts(count: int, rng: np.random.Generator, fastest: float = 20.0) -> Array:
    """Random states: any angle, any speed (rad/s) up to `fastest`, and potentials that remember another angle, (4, count)."""
    remembered, phi = rng.uniform(-pi, pi, (2, count))
    return np.array(
        [np.cos(remembered), np.sin(remembered), phi, rng.uniform(-fastest, fastest, count)]
    )
