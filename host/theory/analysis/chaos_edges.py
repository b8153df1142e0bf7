"""Where lasting chaos begins and ends along a constant.

Wheels that are chaotic at one value go on at others, and some leave chaos. Close to a crisis they
do so late (host.theory.analysis.transients): for the edge, half of them are still chaotic after
LASTING_S. The interval in which the share falls from MOST to FEW is its uncertainty.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.attractors import CHAOS, random_starts, settle, watch
from host.theory.model.wheel import Array, Wheel

# Chaos lasts if it does so for this time, s; in the second part of it wheels are watched.
LASTING_S, _WATCHED_S = 300.0, 100.0
MOST, FEW = 0.9, 0.1
# Values of the first search with random states at each; values and wheels of the second.
_VALUES, _STARTS, _FINE_VALUES, _WHEELS = 40, 8, 25, 32
# At this share of random states chaos is taken for found.
_FOUND = 0.25


class ChaosEdge(NamedTuple):
    """Where lasting chaos begins or ends.

    Attributes:
        value: of the constant; half of the wheels are chaotic there after LASTING_S.
        few: FEW of them are.
        most: MOST of them are.
    """

    value: float
    few: float
    most: float


def _follow(states: Array, parameters: Array) -> tuple[NDArray[np.bool_], Array]:
    """Whether wheels are chaotic after LASTING_S, and their states then."""
    settled = settle(states, parameters, LASTING_S - _WATCHED_S)
    found = watch(settled, parameters, _WATCHED_S)
    return found.kinds() == CHAOS, found.states


def chaos_edges(wheel: Wheel, field: str, high: float, rng: np.random.Generator) -> list[ChaosEdge]:
    """The outermost edges of lasting chaos between 0 and a value.

    Args:
        wheel: The wheel; its own value of the constant does not matter.
        field: The field of Wheel that varies.
        high: The greatest value.
        rng: The source of chance.

    Returns:
        The lower and the upper edge, as far as they lie between.

    Raises:
        WrongUse: A wheel is too stiff to be followed.
    """
    step = high / _VALUES
    values = step * np.arange(1, _VALUES + 1)
    every = np.repeat(values, _STARTS)
    parameters = wheel.columns(len(every), **{field: every})
    chaotic, states = _follow(random_starts(len(every), rng), parameters)
    shares = chaotic.reshape(_VALUES, _STARTS).mean(axis=1)
    found = np.flatnonzero(shares >= _FOUND).tolist()
    if not found:
        return []
    edges = []
    for place, outward in ((found[0], -1), (found[-1], 1)):
        if place + outward in range(_VALUES):
            inner = max(0, min(_VALUES - 1, place - 2 * outward))
            own = (every == values[inner]) & chaotic
            if not own.any():
                own = (every == values[place]) & chaotic
            outer = min(high, max(step / 2, values[place] + 3 * outward * step))
            tried = np.linspace(values[inner], outer, _FINE_VALUES)
            edges += _edge(wheel, field, tried, states[:, own], rng)
    return edges


def _edge(
    wheel: Wheel, field: str, tried: Array, states: Array, rng: np.random.Generator
) -> list[ChaosEdge]:
    """The edge among values that go out of chaos, from chaotic states; none if it is not there."""
    every = np.repeat(tried, _WHEELS)
    begin = states[:, rng.integers(states.shape[1], size=len(every))].copy()
    begin[:2] *= 1 + 1e-3 * rng.standard_normal((2, len(every)))
    lasts, _ = _follow(begin, wheel.columns(len(every), **{field: every}))
    shares = np.minimum.accumulate(lasts.reshape(len(tried), _WHEELS).mean(axis=1))
    if shares[0] < MOST or shares[-1] > FEW:
        return []
    # np.interp wants what rises.
    return [ChaosEdge(*(float(np.interp(-share, -shares, tried)) for share in (0.5, FEW, MOST)))]
