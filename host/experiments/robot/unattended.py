"""The robot's loop by itself, with no host: it waits for its clock only."""

from __future__ import annotations

from robot.loop import Loop
from robot.record import Record, unpack


def run(loop: Loop, ticks: int) -> list[Record]:
    """Run the loop for this number of ticks, and return their records."""
    records: list[Record] = []
    for _ in range(ticks):
        loop.clock.wait(loop.deadline, lambda timeout_s: None)
        loop.tick()
        records += unpack(loop.blackbox.read(loop.blackbox.next_tick - 1, 1))
    return records
