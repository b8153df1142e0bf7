"""Where chaos begins or ceases to last along a constant: its crisis, by bisection.

On one side of the crisis the chaotic set attracts; on the other side chaos is a transient, and
wheels leave it sooner or later, the later the closer to the crisis
(host.theory.analysis.transients). No finite time shows the crisis itself; what is located is where
chaos has a mean life of LIFE_S. At each value WHEELS chaotic wheels are followed for LASTING_S. If
none leaves chaos, its mean life is longer, and if MANY leave, it is shorter, each with 95 %
confidence. The interval between the closest values of either kind is the uncertainty.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.attractors import random_starts, settle
from host.theory.analysis.bisection import last_alike
from host.theory.analysis.deciding import settle_beside_close
from host.theory.model.wheel import Array, Wheel

Side = Literal["lower", "upper"]
# How long chaotic wheels are followed, s, and how many. Of 32 whose chaos lives for LIFE_S, s, on
# average, 4 % of samples have none that leaves, and 3 % have MANY.
LASTING_S, WHEELS, MANY, LIFE_S = 1000.0, 32, 7, 1e4
# How closely (relative) the ends of the interval are located.
_WITHIN = 1e-3
# A wheel is chaotic if a close one parts from it in one of these times, s. Near its crisis a
# chaotic wheel may roll for a minute, and close ones do not part then.
_PART_S = (50.0, 200.0)
# Wheels first come to the chaotic set, s. So many more begin than are followed.
_ENTRY_S, _MORE = 100.0, 2
# The values of the first search, with random states at each, and how long they are followed, s.
_VALUES, _STARTS, _SEARCH_S = 40, 8, 200.0
# At this share of random states chaos is taken for found.
_FOUND = 0.25
# How many values further inside are tried for lasting chaos, and from how close values, in steps
# of the search, wheels take their first chaotic states.
_INWARD, _NEAR = 8, 3.5
_FINENESS = 0.6
_DISTURBANCE = 1e-3


class ChaosEdge(NamedTuple):
    """A crisis.

    Attributes:
        side: lower if chaos lasts above it, upper if below.
        value: of the constant, halfway between the other two.
        leaves: the closest value at which MANY wheels leave chaos within LASTING_S.
        stays: the closest value at which none does.
    """

    side: Side
    value: float
    leaves: float
    stays: float


def _chaotic(states: Array, parameters: Array) -> tuple[NDArray[np.bool_], Array]:
    """Whether wheels are chaotic, (wheels,), and their states after that, (4, wheels)."""
    found, ended = np.zeros(states.shape[1], dtype=bool), states.copy()
    left = np.arange(states.shape[1])
    for seconds in _PART_S:
        own, apart = settle_beside_close(ended[:, left], parameters[:, left], seconds)
        ended[:, left], found[left] = own, apart
        left = left[~apart]
        if not len(left):
            break
    return found, ended


def chaos_edges(wheel: Wheel, field: str, high: float, rng: np.random.Generator) -> list[ChaosEdge]:
    """The outermost crises of chaos between 0 and a value.

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        field: The field of Wheel that varies.
        high: The greatest value.
        rng: The source of chance.

    Returns:
        The lower and the upper one, as far as they lie between.

    Raises:
        WrongUse: A wheel is too stiff to be followed.
    """
    step = high / _VALUES
    values: Array = step * np.arange(1.0, _VALUES + 1)
    every = np.repeat(values, _STARTS)
    parameters = wheel.columns(len(every), **{field: every})
    states = settle(random_starts(len(every), rng), parameters, _SEARCH_S, _FINENESS)
    chaotic, states = _chaotic(states, parameters)
    found = np.flatnonzero(chaotic.reshape(_VALUES, _STARTS).mean(axis=1) >= _FOUND).tolist()
    if not found:
        return []
    sides: tuple[tuple[Side, int], ...] = (("lower", found[0]), ("upper", found[-1]))
    edges: list[ChaosEdge] = []
    for side, place in sides:
        begin = states[:, chaotic & (np.abs(every - values[place]) < _NEAR * step)]

        @cache
        def leaving(value: float, begin: Array = begin) -> int:
            return _leaving(wheel._replace(**{field: value}), begin, rng)

        edge = crisis_beside(side, leaving, values.tolist(), place)
        if edge is not None:
            edges.append(edge)
    return edges


def crisis_beside(
    side: Side, leaving: Callable[[float], int], values: Sequence[float], place: int
) -> ChaosEdge | None:
    """The crisis beside a value; None if there is none.

    Args:
        side: Whether it lies below or above the value.
        leaving: How many wheels leave chaos at a value.
        values: The values of the first search, ascending.
        place: The place of the value among them.
    """
    if side == "lower":
        values, place = values[::-1], len(values) - 1 - place
    if place + 1 == len(values):
        return None
    inward = range(place, max(place - _INWARD, -1), -1)
    inner = next((number for number in inward if leaving(values[number]) == 0), None)
    if inner is None:
        return None
    outer = next((value for value in values[inner + 1 :] if leaving(value) >= MANY), None)
    if outer is None:
        return None
    within = _WITHIN * values[inner]
    stays = last_alike(lambda value: leaving(value) == 0, values[inner], outer, within)
    leaves = last_alike(lambda value: leaving(value) >= MANY, outer, stays, within)
    return ChaosEdge(side, (leaves + stays) / 2, leaves, stays)


def _leaving(wheel: Wheel, begin: Array, rng: np.random.Generator) -> int:
    """How many of WHEELS wheels leave chaos within LASTING_S; all if too few come to it.

    Args:
        wheel: The wheel.
        begin: Chaotic states of wheels with other constants, (4, states).
        rng: The source of chance.
    """
    states = begin[:, rng.integers(begin.shape[1], size=_MORE * WHEELS)]
    states = states + _DISTURBANCE * rng.standard_normal(states.shape)
    states = settle(states, wheel.columns(_MORE * WHEELS), _ENTRY_S, _FINENESS)
    chaotic, states = _chaotic(states, wheel.columns(_MORE * WHEELS))
    if chaotic.sum() < WHEELS:
        return WHEELS
    parameters = wheel.columns(WHEELS)
    states = settle(states[:, chaotic][:, :WHEELS], parameters, LASTING_S, _FINENESS)
    return WHEELS - int(_chaotic(states, parameters)[0].sum())
