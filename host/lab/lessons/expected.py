"""What simulated wheels do, for the checks of the guided exercises."""

from __future__ import annotations

from host.kicking.kick_map import kick_specimens, request
from robot.kicks import PHASE
from robot.params import Params
from sim_motor.compiled import on_one_core

_WHEELS, _SEED = 200, 1


def reversal_share(ticks: int, params: Params) -> float:
    """The share of rolling wheels that a phase kick of this length reverses.

    Args:
        ticks: The kick's length.
        params: The robot's parameters.

    Returns:
        From 0 to 1, never quite 0 or 1: so few wheels exclude nothing.
    """
    with on_one_core():
        result = kick_specimens(request(PHASE, ticks, None), _WHEELS, _SEED, params=params)
    moving = result.before != 0
    return float((result.reversed[moving].sum() + 1) / (moving.sum() + 2))
