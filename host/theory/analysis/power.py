"""Power spectra: of a cycle from its Fourier series, of other motion by Welch's method.

Two powers are shown, neither changed by the symmetries: that of the potentials, x1 and x2 together,
and that of omega. The potentials of a rotation have its own frequency, omega four times that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from host.theory.engine.ensemble import rate_per_s
from host.theory.engine.flow import FINENESS, plain_under, run
from host.theory.model.laws import law_of
from host.theory.model.wheel import OMEGA, Array, Wheel

# Welch's method averages over segments that are this part of a series, and overlap by a half.
_SEGMENTS = 8
# Harmonics of a cycle that are kept; its samples are at least as many as for `run`, a power of 2.
HARMONICS = 64
_FEWEST = 512
# A peak rises above the valleys on its sides by this factor.
_RISE = 3.0


class Power(NamedTuple):
    """A power spectrum.

    Attributes:
        frequency_hz: Hz, (frequencies,).
        potentials: power of x1 and x2; of a cycle the mean square of each harmonic, else the
            density, 1/Hz, (frequencies,).
        omega: likewise of omega, (rad/s)^2 or (rad/s)^2/Hz, (frequencies,).
    """

    frequency_hz: Array
    potentials: Array
    omega: Array


def of_cycle(wheel: Wheel, state: Array, period_s: float) -> Power:
    """The harmonics of a cycle. The trapezoidal rule over a period is exact to rounding.

    Args:
        wheel: The wheel.
        state: A state of the cycle, (4,).
        period_s: The cycle's period, s.
    """
    needed = period_s * FINENESS * float(rate_per_s(wheel.columns(1))[0])
    count = max(_FEWEST, 2 ** int(np.ceil(np.log2(needed))))
    path = run(plain_under(law_of(wheel)), state[:, None], tuple(wheel), period_s, count)[:-1, :, 0]
    parts = 2 * np.abs(np.fft.rfft(path, axis=0)[1 : HARMONICS + 1] / count) ** 2
    numbers = np.arange(1, HARMONICS + 1)
    return Power(numbers / period_s, parts[:, 0] + parts[:, 1], parts[:, OMEGA])


def of_motion(wheel: Wheel, states: Array, seconds: float) -> Power:
    """The spectrum of wheels that do not repeat themselves, averaged over them.

    Args:
        wheel: The wheels' constants.
        states: Where they start, (4, wheels).
        seconds: How long to follow each, s.
    """
    from scipy.signal import welch

    every = round(FINENESS)
    samples = int(np.ceil(seconds * float(rate_per_s(wheel.columns(1))[0])))
    step_s, found, own_rates = seconds / samples, [], plain_under(law_of(wheel))
    for state in states.T:
        whole = run(own_rates, state[:, None], tuple(wheel), seconds, samples * every)
        path = whole[::every, :, 0]
        frequency, density = welch(
            path, 1.0 / step_s, nperseg=2 * samples // (_SEGMENTS + 1), axis=0
        )
        found.append(density)
    mean = np.mean(found, axis=0)[1:]
    return Power(frequency[1:], mean[:, 0] + mean[:, 1], mean[:, OMEGA])


class Peak(NamedTuple):
    """A peak of a spectrum: where it is, Hz, and its power there."""

    frequency_hz: float
    power: float


def peaks(frequency_hz: Array, power: Array, most: int) -> list[Peak]:
    """The strongest peaks, the greatest power first.

    Args:
        frequency_hz: Hz, (frequencies,), at equal distances.
        power: (frequencies,).
        most: How many at most.

    Returns:
        The peaks that rise above the valleys on both sides by a factor of 3. A place between two
        frequencies is that of the parabola through the logarithms of three powers.
    """
    from scipy.signal import find_peaks

    logs = np.log(np.maximum(power, 1e-300))
    places, _ = find_peaks(logs, prominence=np.log(_RISE))
    strongest = places[np.argsort(-power[places], kind="stable")][:most]
    found = []
    for place in strongest.tolist():
        left, top, right = logs[place - 1 : place + 2].tolist()
        off = 0.5 * (left - right) / (left - 2 * top + right)
        distance = float(frequency_hz[1] - frequency_hz[0])
        found.append(Peak(float(frequency_hz[place]) + off * distance, float(power[place])))
    return found
