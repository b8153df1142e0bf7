"""Taylor's method for many wheels: each takes its own steps, eight of them by one instruction.

The series of a wheel's motion comes from the paper's equations themselves
(host.theory.engine.series). Sines and exponentials are computed once a step, and a wheel that comes
to rest takes long steps. A step is as long as keeps the last two terms of the series within the
tolerance (Jorba and Zou, Experimental Mathematics 14, 99, 2005).
"""

from __future__ import annotations

from functools import cache
from math import log2, log10
from typing import Any, NamedTuple

import numba.extending
import numpy as np
from numba.core import types

from host.theory.engine import elementary, series
from host.theory.engine.elementary import inlined, unlocked
from host.theory.engine.series import LANES, Lanes, Mathematics, Series, bits_of, float_of
from host.theory.model.laws import Law, under
from host.theory.model.wheel import OMEGA, Array, Wheel, rates
from robot.sources import fingerprint
from sim_motor.compiled import over_cores

# numba gives intrinsics another signature than the one that they are written with.
_intrinsic: Any = numba.extending.intrinsic

# A wheel's row `SQUARE` is the integral of (omega - around)^2; its parameter `AROUND` stands below
# the constants.
SQUARE, AROUND = OMEGA + 1, len(Wheel._fields)
# The rows of a wheel's memory: its state, what rounding has taken from that, the time that is left,
# what rounds a step, and the bounds of a step.
_STATES = SQUARE + 1
_LEFT, _ROUNDER, _SHORTEST, _LONGEST, _MEMORY = range(2 * _STATES, 2 * _STATES + 5)
# Bounds of a step in units of a wheel's usual time: shorter ones are those of a wheel that runs
# away, and with longer ones a wheel would not come to rest.
_BOUNDS = 1e-4, 3.0
# The bits of the float 1, and the distance of whole numbers that are the bits of 1 and 2.
_ONE, _DOUBLING = 1023 << 52, 2.0**52
_LEAST = 1e-300


class Accuracy(NamedTuple):
    """The highest power of the series, and how large its last two terms may be."""

    order: int
    tolerance: float


def accuracy_of(fineness: float) -> Accuracy:
    """The accuracy that takes about `fineness` times as many steps as 1 does.

    At 1 averages of regular motion have nine digits. The order is the one that then takes the
    least time.
    """
    tolerance = min(1e-3, max(1e-16, 3e-11 * fineness**-12.0))
    return Accuracy(2 * round(0.5 - 0.6 * log10(tolerance)), tolerance)


def _logarithm(number: Lanes) -> Lanes:
    """The logarithm to the base 2 of floats above 0, to a tenth: a line between powers of 2."""
    found: Lanes = (bits_of(number) + -_ONE).as_float() * (1.0 / _DOUBLING)
    return found


def _power_of_2(exponent: Lanes) -> Lanes:
    """The inverse of `_logarithm`."""
    return float_of((exponent * _DOUBLING).as_whole() + _ONE)


def _longest_step(state: list[Series], accuracy: Accuracy) -> Lanes:
    """How long a step may be, s."""
    exponents = []
    for power in (accuracy.order - 1, accuracy.order):
        first, *others = (row[power].magnitude() for row in state)
        for other in others:
            first = first.larger(other)
        distance = log2(accuracy.tolerance) - _logarithm(first + _LEAST)
        exponents.append(distance * (1.0 / power))
    return _power_of_2(exponents[0].smaller(exponents[1]))


class _Step:
    """A step of eight wheels, in the code that a builder writes."""

    def __init__(self, builder: Any, law: Law, accuracy: Accuracy) -> None:
        self.builder, self.law, self.accuracy = builder, law, accuracy

    def write(self, memory: Any, constants: Any) -> Any:
        """Write it. Its result is not 0 if one of the wheels has no time left.

        Args:
            memory: Where the wheels' memory is.
            constants: Where their parameters are.
        """
        own = [Lanes.load(self.builder, constants, row) for row in range(AROUND + 1)]
        kept = [Lanes.load(self.builder, memory, row) for row in range(_MEMORY)]
        state = self._motion(kept[:_STATES], own)
        # Steps are multiples of the last digit of the whole time, so that exactly 0 is left.
        step = _longest_step(state[:SQUARE], self.accuracy)
        step = ((step + kept[_ROUNDER]) - kept[_ROUNDER]).larger(kept[_SHORTEST])
        step = step.smaller(kept[_LONGEST]).smaller(kept[_LEFT])
        for row, (found, lost) in enumerate(zip(state, kept[_STATES:], strict=False)):
            change = found[self.accuracy.order]
            for power in range(self.accuracy.order - 1, 0, -1):
                change = change * step + found[power]
            change = change * step + lost
            after = found[0] + change
            after.store(memory, row)
            (change - (after - found[0])).store(memory, _STATES + row)
        left = kept[_LEFT] - step
        left.store(memory, _LEFT)
        return left.any_is(0.0)

    def _motion(self, begin: list[Lanes], own: list[Lanes]) -> list[Series]:
        """The series of the rows of a state."""
        slopes: list[Series] = []

        def driven(row: int) -> Series:
            return series.driven(lambda: begin[row], lambda n: slopes[row][n])

        state = [driven(row) for row in range(_STATES)]
        slopes += under(self.law, rates, Mathematics().names)(*state[:SQUARE], *own[:AROUND])
        slopes.append(series.square(state[OMEGA] - own[AROUND]))
        return state


@cache
def _stepping(law: Law, accuracy: Accuracy) -> Any:
    """The compiled function that takes one step of eight wheels."""
    # What was compiled is kept under a digest of all that the function below names. A class counts
    # by its name only, so the sources that write the code are named beside it.
    written_by = [fingerprint(file) for file in (__file__, series.__file__, elementary.__file__)]
    equations = under(law, rates)

    @_intrinsic
    def one_step(context: Any, memory: Any, constants: Any) -> Any:
        _ = written_by, equations

        def write(own: Any, builder: Any, signature: Any, given: Any) -> Any:
            tables = [
                own.make_array(kind)(own, builder, value).data
                for kind, value in zip(signature.args, given, strict=True)
            ]
            return _Step(builder, law, accuracy).write(*tables)

        return types.int64(memory, constants), write

    return one_step


@inlined
def _copy(rows: int, source: Array, column: int, to: Array, lane: int) -> None:
    """Copy a column number by number: slices take the compiler ten times as long."""
    for row in range(rows):
        to[row, lane] = source[row, column]


@cache
def _following(law: Law, accuracy: Accuracy) -> Any:
    """The compiled function that follows wheels for some seconds, in place."""
    one_step = _stepping(law, accuracy)

    def follow_some(
        states: Array, parameters: Array, seconds: float, usual_s: Array, first: int, every: int
    ) -> None:
        """One of `every` wheels, from the first on. A wheel at its end makes room for the next."""
        memory, constants = np.zeros((_MEMORY, LANES)), np.zeros((AROUND + 1, LANES))
        for lane in range(LANES):
            memory[_ROUNDER, lane] = 1.5 * _DOUBLING * np.spacing(seconds)
        who = np.full(LANES, -1)
        coming, running = first, 0
        while True:
            for lane in range(LANES):
                if memory[_LEFT, lane] != 0.0:
                    continue
                if who[lane] >= 0:
                    _copy(_STATES, memory, lane, states, who[lane])
                    who[lane], running = -1, running - 1
                # A lane without a wheel repeats one of the others' for ever.
                wheel = min(coming, states.shape[1] - 1)
                _copy(len(parameters), parameters, wheel, constants, lane)
                _copy(_STATES, states, wheel, memory, lane)
                for row in range(_STATES, _LEFT):
                    memory[row, lane] = 0.0
                memory[_LEFT, lane] = np.inf
                memory[_SHORTEST, lane] = _BOUNDS[0] * usual_s[wheel]
                memory[_LONGEST, lane] = _BOUNDS[1] * usual_s[wheel]
                if wheel == coming:
                    memory[_LEFT, lane] = seconds
                    who[lane], running, coming = wheel, running + 1, coming + every
            if running == 0:
                break
            while one_step(memory, constants) == 0:
                pass

    return unlocked(follow_some)


def follow(
    states: Array,
    parameters: Array,
    seconds: float,
    usual_s: Array,
    law: Law,
    accuracy: Accuracy,
) -> None:
    """Follow wheels for some time, over all cores. A wheel does not depend on the others.

    Args:
        states: (5, wheels), in place, C-contiguous. Those that take the most steps stand first, so
            that no core waits long for the others.
        parameters: (constants and `AROUND`, wheels), C-contiguous.
        seconds: How long, s.
        usual_s: In what time a wheel changes, s, (wheels,).
        law: The wheels' equations, without functions of the user.
        accuracy: How exactly.
    """
    follow_some = _following(law, accuracy)
    # A step of a few wheels takes as long as one of LANES.
    over_cores(
        lambda core, cores: follow_some(states, parameters, float(seconds), usual_s, core, cores),
        -(-states.shape[1] // LANES),
    )
