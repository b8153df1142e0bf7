"""How long a quenched kick of the continuous wheel must be to reverse it at every phase."""

from __future__ import annotations

from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from host.theory.analysis.bisection import last_alike
from host.theory.analysis.outcomes import (
    BACKWARD,
    outcomes_after_kicks,
    rolling_states,
    settle_and_classify,
)
from host.theory.engine.kicked import Model, seen_in
from host.theory.model.wheel import Array, Wheel

# Near the worst phase, phases are this many times closer.
CLOSER = 8
# Ends are sought to this time, s.
TO_S = 1e-6


def sure_ranges(
    model: Model, wheel: Wheel, mode: str, sign: int, lengths_s: list[float], phases: int
) -> list[tuple[float, float]]:
    """The lengths of a kick that reverse a rolling wheel whenever it comes.

    Args:
        model: The continuous model.
        wheel: The wheel's constants.
        mode: The kick's mode, see robot/kicks.py.
        sign: Sign of a phase kick's shift; 0 for other kicks.
        lengths_s: Lengths at which ranges are looked for, s, ascending from 0.
        phases: At how many moments of a quarter turn.

    Returns:
        (from, to) of each range, s, to TO_S; one may end with the greatest length. No range if
        the wheel does not roll, or no length is sure.

    Raises:
        WrongUse: The wheel cannot be followed.
    """
    close = rolling_states(model, wheel, CLOSER * phases)
    if close is None:
        return []
    states, seen = close[:, ::CLOSER], seen_in(mode, sign)

    def reversed_by(states: Array, length_s: float) -> NDArray[np.bool_]:
        kicked = model.kicked(states, wheel.columns(states.shape[1]), length_s, seen)
        return np.asarray(settle_and_classify(model, kicked, wheel)[0] == BACKWARD)

    def last_sure(states: Array, inside_s: float, outside_s: float) -> float:
        def sure(length_s: float) -> bool:
            return bool(reversed_by(states, length_s).all())

        return last_alike(sure, inside_s, outside_s, TO_S)

    def end(inside_s: float, outside_s: float) -> float:
        """The last sure length between one that is sure and one that is not."""
        # The phases at which the longer kick fails, and of these the first to fail.
        failing = np.flatnonzero(~reversed_by(states, outside_s))
        coarse_s = last_sure(states[:, failing], inside_s, outside_s)
        beyond_s = coarse_s + 2 * TO_S * (1.0 if outside_s > inside_s else -1.0)
        worst = failing[~reversed_by(states[:, failing], beyond_s)]
        around = CLOSER * worst[:, None] + np.arange(-CLOSER, CLOSER + 1)
        return last_sure(close[:, np.unique(around % close.shape[1])], inside_s, beyond_s)

    outcomes = outcomes_after_kicks(model, wheel, states, mode, sign, lengths_s)
    sure = (outcomes == BACKWARD).all(axis=1).tolist()
    found = []
    for is_sure, group in groupby(range(len(sure)), lambda number: sure[number]):
        own = list(group)
        if not is_sure:
            continue
        first, last = own[0], own[-1]
        begin_s = end(lengths_s[first], lengths_s[first - 1])
        end_s = lengths_s[last]
        if last + 1 < len(sure):
            end_s = end(end_s, lengths_s[last + 1])
        found.append((begin_s, end_s))
    return found
