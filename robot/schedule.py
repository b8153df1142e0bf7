"""A schedule that holds: what keeps other programs, and Python itself, from delaying a tick.

Real-time priority, memory that stays where it is, and a garbage collector with hours of its own.
The kernel grants the first two to a service, to root, or to a user whose limits allow it; a robot
that may not have them goes on without, and says so in its status.
"""

import gc
import os
import resource

# Of the kernel's 1 to 99. The watchdog comes before the loop, or a loop that never sleeps would
# keep it from stopping the motors where there is one processor only.
LOOP_PRIORITY, WATCHDOG_PRIORITY = 10, 11
# mlockall(2): what is there, and what is to come.
_CURRENT_AND_FUTURE = 1 | 2
COLLECT_S = 1.0
# The share of each period that the program sleeps whatever hosts want, if it has that priority.
# The kernel halts one that never sleeps, by default for 50 ms in each second, which is more than a
# tick: sched(7), sched_rt_runtime_us.
REST_SHARE = 0.08


def take_priority(priority):
    """Have the calling thread, and those that it starts, run before all ordinary programs.

    Args:
        priority: 1 to 99, such as LOOP_PRIORITY and WATCHDOG_PRIORITY.

    Returns:
        Whether the kernel allows it.
    """
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError:
        return False
    return True


def lock_memory():
    """Keep all memory of this process from being swapped out, which takes a tick to undo.

    Call it before the loop runs, when all that it needs is imported.

    Returns:
        Whether the kernel allows it.
    """
    # With a limit, memory that is needed later could be refused.
    limit = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0]
    if limit != resource.RLIM_INFINITY and os.geteuid() != 0:
        return False
    try:
        # Not `ctypes`, whose types take a brick 0.3 s to make.
        import _ctypes

        program = _ctypes.dlopen(None, 0)  # type: ignore[arg-type]
        mlockall = _ctypes.dlsym(program, "mlockall")
        return _ctypes.call_function(mlockall, (_CURRENT_AND_FUTURE,)) == 0
    except (ImportError, OSError):
        return False


class Collector(object):
    """A panel of the program that looks for garbage between ticks, and only in what is new.

    By itself Python looks through everything now and then, in the middle of a tick.
    """

    def __init__(self):
        gc.collect()
        gc.disable()
        self._due_s = 0.0

    def serve(self, loop):
        """Collect once in COLLECT_S.

        Args:
            loop: The robot.loop.Loop.
        """
        now = loop.clock.now()
        if now >= self._due_s:
            self._due_s = now + COLLECT_S
            gc.collect(0)

    def close(self):
        """Leave it to Python again."""
        gc.enable()
