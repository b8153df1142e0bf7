"""What runs on the emulated brick.

Whole ticks of the robot's loop, through robot.ev3 and through LargeMotor's properties.

A line on standard output ends each stretch that is to be counted.
"""

import sys

from robot.loop import Loop
from tests.bench_arm.ways import library_motors, our_motors

WARM_UP, TICKS = 50, 200


class Clock:
    """Time that passes when told to."""

    def __init__(self):
        self.time = 0.0

    def now(self):
        return self.time


def main(root):
    """Print 'WAY begin' and 'WAY end' around TICKS ticks in each way."""
    for way, motors in (("ours", our_motors(root)), ("library", library_motors(root))):
        clock = Clock()
        loop = Loop(motors, None, clock, 1)
        loop.start()
        for tick in range(WARM_UP + TICKS):
            if tick == WARM_UP:
                print(way, "begin", flush=True)
            clock.time = loop.deadline
            loop.tick()
        print(way, "end", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
