"""The multistep method of Adams, Bashforth and Moulton with fixed steps, for many systems at once.

It predicts with the polynomial through the latest ORDER rates, evaluates, corrects with the
polynomial through these and the new one, and evaluates again (Hairer, Norsett, Wanner: Solving
Ordinary Differential Equations I, III.1). For ten digits and more it needs half as many evaluations
as Runge and Kutta's method of order 8; but its steps must be short, or it is not stable.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from host.theory.engine import runge_kutta
from host.theory.engine.elementary import vectorised
from host.theory.model.wheel import Array

ORDER = 10


def weights(nodes: list[int]) -> tuple[float, ...]:
    """The weights of values at some nodes in an integral.

    Args:
        nodes: Where the values are.

    Returns:
        What the integral over [0, 1] of the polynomial through the values takes of each.
    """
    found = []
    for own in nodes:
        # Lagrange's polynomial, from the constant term up.
        polynomial = [Fraction(1)]
        for other in nodes:
            if other != own:
                shifted, same = [Fraction(0), *polynomial], [*polynomial, Fraction(0)]
                polynomial = [
                    (high - other * low) / (own - other)
                    for high, low in zip(shifted, same, strict=True)
                ]
        found.append(
            float(sum(coefficient / (power + 1) for power, coefficient in enumerate(polynomial)))
        )
    return tuple(found)


_LATEST = [-age for age in range(ORDER)]
_PREDICTING = weights(_LATEST)
_OF_NEW, *_rest = weights([1, *_LATEST])
_CORRECTING = tuple(_rest)


@vectorised
def _predict(to: Array, states: Array, step_s: float, rates: Array, newest: int) -> None:
    for i in range(len(to)):
        change, slot = 0.0, newest
        for weight in _PREDICTING:
            change += weight * rates[slot, i]
            slot += 1
        to[i] = states[i] + step_s * change


@vectorised
def _prepare(change_now: Array, step_s: float, rates: Array, newest: int) -> None:
    """Add what the old rates contribute to the corrected step."""
    for i in range(len(change_now)):
        change, slot = 0.0, newest
        for weight in _CORRECTING:
            change += weight * rates[slot, i]
            slot += 1
        change_now[i] += step_s * change


@vectorised
def _correct(states: Array, lost: Array, step_s: float, new: Array) -> None:
    for i in range(len(states)):
        change, before = lost[i] + step_s * _OF_NEW * new[i], states[i]
        states[i] = before + change
        lost[i] = change - (states[i] - before)


@cache
def stepping(rates_of: Any) -> Any:
    """The compiled function that takes `count` steps of step_s, as that of runge_kutta.

    The first steps are by Runge and Kutta's method, as there are no earlier rates. What rounding
    takes from a step is given to the next, as there.
    """
    first_steps = runge_kutta.stepping(rates_of)

    def steps(states: Array, parameters: Array, step_s: float, count: int) -> None:
        # The latest rates stand first, from `newest` on. There is room for as many again, then they
        # are moved.
        rates = np.zeros((2 * ORDER, *states.shape))
        at, new, lost = np.empty_like(states), np.empty_like(states), np.zeros(states.size)
        # The same memory without rows, for the longest loops.
        flat_states, flat_at, flat_new = (
            states.reshape(states.size),
            at.reshape(states.size),
            new.reshape(states.size),
        )
        flat_rates = rates.reshape((2 * ORDER, states.size))
        newest = 2 * ORDER - 1
        rates_of(states, parameters, rates[newest])
        for step in range(count):
            if step < ORDER - 1:
                first_steps(states, parameters, step_s, 1)
            else:
                if newest == 0:
                    rates[ORDER:] = rates[:ORDER]
                    newest = ORDER
                _predict(flat_at, flat_states, step_s, flat_rates, newest)
                _prepare(lost, step_s, flat_rates, newest)
                rates_of(at, parameters, new)
                _correct(flat_states, lost, step_s, flat_new)
            newest -= 1
            rates_of(states, parameters, rates[newest])

    return vectorised(steps)
