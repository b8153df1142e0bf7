"""The four phases of the paper's phase diagram, by mean and standard deviation of omega."""

from __future__ import annotations

from typing import Literal

Phase = Literal["S", "FB", "LLM", "C"]
PHASES: tuple[Phase, ...] = ("S", "FB", "LLM", "C")

# A wheel rests if mean and deviation of omega (rad/s) are below STILL. It rolls one way if the mean
# is above ROLLING_MEAN (rad/s) and the deviation below ROLLING_SPREAD of it.
STILL, ROLLING_MEAN, ROLLING_SPREAD = 0.02, 0.1, 0.6
# Cycles around a resting angle end below this multiple of the k of their Hopf bifurcation.
NEAR_HOPF = 2.0


def phase(omega_mean: float, omega_std: float, k: float, k_hopf: float) -> Phase:
    """The phase of a wheel that has settled.

    A wheel that neither rests nor rolls one way goes forth and back if k is near the Hopf line,
    where the cycles around the resting angles are; elsewhere it is chaotic.

    Args:
        omega_mean: Mean of omega, rad/s.
        omega_std: Standard deviation of omega, rad/s.
        k: The wheel's spring constant.
        k_hopf: The spring constant at which its rest becomes unstable.

    Returns:
        S for rest, FB for forth and back, LLM for rolling one way, C for chaos.
    """
    mean = abs(omega_mean)
    if mean < STILL and omega_std < STILL:
        return "S"
    if mean > ROLLING_MEAN and omega_std < ROLLING_SPREAD * mean:
        return "LLM"
    return "FB" if k < NEAR_HOPF * k_hopf else "C"
