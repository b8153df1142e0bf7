"""When a wheel has settled after a kick: one rule for logs and, compiled, for batches."""

from collections.abc import Sequence
from math import nan, pi

# The final speed is the mean over the last WINDOW_S; a wheel has settled when its speed stays
# within BAND of that.
WINDOW_S = 0.5
BAND = 0.1
COUNT_RAD = pi / 180  # one step of the encoder
HALF_SPAN = 2  # a speed is measured over the two ticks before and the two after
ROUNDING = 1e-9


def settling_s(phi: Sequence[float], times: Sequence[float], begin_s: float) -> float:
    """How long after a kick began a wheel had settled.

    It has settled at the first tick from which on its speed, measured over five ticks around each,
    stays within BAND of the final speed (or within what one count of the encoder makes over five
    ticks) until the end, which must be WINDOW_S away. It has settled at once if it never left that
    band.

    Args:
        phi: The wheel's angle, rad, one value a tick, some from before the kick.
        times: When these ticks began, s.
        begin_s: When the kick began, s.

    Returns:
        The time, s; NaN if it has not settled by the end of the data.
    """
    last = len(times) - 1
    if last < 2 * HALF_SPAN or times[last] - begin_s < WINDOW_S:
        return nan
    start_s = times[last] - WINDOW_S
    row = last
    while row > 0 and times[row] > start_s:
        row -= 1
    share = max(0.0, (start_s - times[row]) / (times[row + 1] - times[row]))
    final = (phi[last] - phi[row] - share * (phi[row + 1] - phi[row])) / WINDOW_S
    row = last - HALF_SPAN
    while row >= HALF_SPAN and times[row] >= begin_s:
        span_s = times[row + HALF_SPAN] - times[row - HALF_SPAN]
        speed = (phi[row + HALF_SPAN] - phi[row - HALF_SPAN]) / span_s
        if abs(speed - final) > max(BAND * abs(final), COUNT_RAD / span_s) + ROUNDING:
            break
        row -= 1
    if row < HALF_SPAN or times[row] < begin_s:
        return 0.0
    settled = row + 1
    return (
        times[settled] - begin_s
        if settled <= last - HALF_SPAN and times[last] - times[settled] >= WINDOW_S
        else nan
    )
