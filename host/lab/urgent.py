"""Threads that other programs on this machine do not hold up: a STOP goes through them."""

import os
import threading
from contextlib import suppress

# The lowest that is real time: a simulated robot's loop (robot.schedule) comes before the lab.
PRIORITY = 1


class UrgentThread(threading.Thread):
    """A thread with real-time priority, if the system grants it; what it starts has none.

    Linux shares out its processors among sessions first, so that an ordinary lab waits for a
    browser which draws, up to 100 ms at a time: then a STOP is late.
    """

    def run(self) -> None:
        with suppress(AttributeError, OSError):  # it is not Linux, or this user may not
            policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
            os.sched_setscheduler(0, policy, os.sched_param(PRIORITY))
        super().run()
