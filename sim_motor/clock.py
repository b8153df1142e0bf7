"""The simulated brick's clock: virtual time, and how late ticks begin on the brick."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import repeat
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from sim_motor.arrays import Array

# How late a tick begins: a record of 496 ticks of 30 ms on a brick (Python 3.5, balancing robot)
# lies on a shifted log-normal with these three numbers: median 0.66 ms, 90 % below 2.1, 99 % below
# 5.7, the longest 13.6. None is later than the longest.
LATE_LEAST_S, LATE_MEDIAN_S, LATE_SPREAD, LATE_MOST_S = 0.00017, 0.00049, 1.06, 0.0136


def lateness_s(normal: Array) -> Array:
    """How late ticks begin, s, from standard normal numbers."""
    import numpy as np

    return np.minimum(LATE_LEAST_S + LATE_MEDIAN_S * np.exp(LATE_SPREAD * normal), LATE_MOST_S)


class Clock(Protocol):
    """The clock seam of robot.motors."""

    def now(self) -> float: ...
    def wait(self, deadline: float, serve: Callable[[float], object]) -> None: ...


class VirtualClock:
    """Time that passes only when it is waited for.

    Args:
        seed: Random seed of how late ticks begin.
        jitter: Whether ticks begin late as on the brick, else punctually.
    """

    def __init__(self, seed: int, *, jitter: bool = True) -> None:
        self._now = 0.0
        self._late = self._lateness(seed) if jitter else repeat(0.0)

    def now(self) -> float:
        """Seconds since the clock was made."""
        return self._now

    def wait(self, deadline: float, serve: Callable[[float], object]) -> None:
        """Let links be served once, then be at `deadline` (s), or as late as the brick would be."""
        serve(0.0)
        self._now = max(self._now, deadline) + next(self._late)

    @staticmethod
    def _lateness(seed: int) -> Iterator[float]:
        import numpy as np  # which a punctual clock does without

        rng = np.random.default_rng(seed)
        while True:
            yield from lateness_s(rng.standard_normal(1000)).tolist()
