"""The robot's program with a fault in its next tick, after the motors have their duties.

SIGUSR1 has it hang, SIGUSR2 has it crash.
"""

import signal
import sys
import time

from robot import __main__ as program
from robot.blackbox import BlackBox

HANG_S = 0.6

_due = []
_append = BlackBox.append


def _hang():
    time.sleep(HANG_S)


def _crash():
    raise ZeroDivisionError("injected")


def _faulty_append(self, fields):
    while _due:
        _due.pop()()
    _append(self, fields)


if __name__ == "__main__":
    BlackBox.append = _faulty_append
    signal.signal(signal.SIGUSR1, lambda number, frame: _due.append(_hang))
    signal.signal(signal.SIGUSR2, lambda number, frame: _due.append(_crash))
    sys.exit(program.main())
