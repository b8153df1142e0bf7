"""The four phases of the paper's phase diagram."""

from __future__ import annotations

from typing import Literal

import numpy as np

from host.theory.analysis.attractors import BACK, CHAOS, REST, ROLL
from host.theory.analysis.deciding import UNDECIDED, decide, stay_at_rest
from host.theory.engine.ensemble import Averages
from host.theory.model.wheel import PHI, Array

Phase = Literal["S", "FB", "LLM", "C", "undecided"]
PHASES: tuple[Phase, ...] = ("S", "FB", "LLM", "C", "undecided")

# A wheel rolls one way if the mean of omega is above ROLLING_MEAN (rad/s) and its deviation below
# ROLLING_SPREAD of the mean.
ROLLING_MEAN, ROLLING_SPREAD = 0.1, 0.6
# A slower wheel (rad/s) rests if rest is stable, and is not about to begin to swing.
_DEAD = 1e-6
# If rest is unstable it is pushed (rad): from nearer to rest even a transient looks chaotic.
_PUSH = 1e-3
_OF_KIND: dict[int, Phase] = {
    REST: "S",
    BACK: "FB",
    ROLL: "LLM",
    CHAOS: "C",
    UNDECIDED: "undecided",
}


def phases(found: Averages, parameters: Array) -> list[Phase]:
    """The phases of wheels.

    Those that neither rest for good nor roll are followed on: one that repeats itself goes forth
    and back, or rolls unevenly, and one that does not is chaotic if small differences grow.

    Args:
        found: Averages of the wheels, and where they ended.
        parameters: Their constants, (constants, wheels).

    Returns:
        S for rest, FB for forth and back, LLM for rolling one way, C for chaos, 'undecided' for
        what has not settled after 6000 s more. These are followed in rounds of 50 s to 1600 s. A
        wheel whose round would take more than 100 000 steps of integration is undecided, too.
    """
    mean, std = np.abs(found.omega_mean), found.omega_std
    rolls = (mean > ROLLING_MEAN) & (std < ROLLING_SPREAD * mean)
    still = ~rolls & (np.maximum(mean, std) < _DEAD)
    dead = still.copy()
    dead[still] = stay_at_rest(found.states[:, still], parameters[:, still])
    kinds = np.where(rolls, ROLL, REST)
    open_ = ~rolls & ~dead
    if open_.any():
        states = found.states.copy()
        states[PHI, still & ~dead] += _PUSH
        kinds[open_] = decide(states[:, open_], parameters[:, open_])
    return [_OF_KIND[kind] for kind in kinds.tolist()]
