"""A robot's time that no restart of its program sets back."""

from __future__ import annotations

from robot.record import Record


class SteadyClock:
    """A clock that goes on where the robot's program, and with it its own clock, begins again.

    Attributes:
        begin_s: The time of the first record (s); None before it.
    """

    def __init__(self) -> None:
        self.begin_s: float | None = None
        self._shift_s = 0.0
        self._latest_s = 0.0
        self._restarted = False

    def restart(self) -> None:
        """The robot's program has begun again."""
        self._restarted = True

    def read(self, record: Record) -> float:
        """The time of the next record (s)."""
        if self._restarted and self.begin_s is not None:
            self._shift_s = self._latest_s + record.dt_s - record.t_s
        self._restarted = False
        self._latest_s = float(record.t_s + self._shift_s)
        if self.begin_s is None:
            self.begin_s = self._latest_s
        return self._latest_s
