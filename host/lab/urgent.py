"""Threads that other programs on this machine do not hold up: a STOP goes through them."""

import os
import threading
from contextlib import suppress

from robot.schedule import take_priority

# The lowest that is real time: a simulated robot's loop comes before the lab.
PRIORITY = 1


class UrgentThread(threading.Thread):
    """A thread with real-time priority, if the system grants it, as are threads that it starts.

    All of them need it: one without it that holds Python's lock and waits for its turn would hold
    up the others. Processes that it starts give it back with `stand_back`.

    Linux shares out its processors among sessions first, so that an ordinary lab waits for a
    browser which draws, up to 0.2 s at a time: then a STOP is late.
    """

    def run(self) -> None:
        with suppress(AttributeError):  # it is not Linux
            take_priority(PRIORITY)
        super().run()


def stand_back(niceness: int) -> None:
    """Let other programs come before this process: no real-time priority, and nicer by so much."""
    with suppress(AttributeError, OSError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    os.nice(niceness)
