"""How much of something may still be done: a bucket that fills by itself."""

from __future__ import annotations


class Allowance:
    """A bucket from which each deed takes one.

    Args:
        now: The time (s); the bucket is full then.
        rate_per_s: How fast it fills (1/s).
        most: What it holds when it is full.
    """

    def __init__(self, now: float, rate_per_s: float, most: float) -> None:
        self._rate_per_s = rate_per_s
        self._left = self._most = most
        self._since = now

    def take(self, now: float) -> bool:
        """Take one at a time (s). Returns whether there was one."""
        passed_s = max(0.0, now - self._since)
        self._left = min(self._most, self._left + self._rate_per_s * passed_s)
        self._since = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
