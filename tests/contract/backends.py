"""The motors that the contract is tried on.

Simulated, simulated behind the brick's files, and a real brick's.
"""

import os
import time

from robot.ev3 import SYSFS, Ev3Motor
from robot.motors import MotorFault
from sim_motor.brick import SimBrick

REAL_PORTS = "KICK_TEST_PORTS"


class Simulated:
    """sim_motor's motor in virtual time."""

    def __init__(self):
        brick = SimBrick(1, jitter=False)
        self.motor = brick.motors[0]
        self._clock = brick.clock

    def wait(self, seconds):
        self._clock.wait(self._clock.now() + seconds, lambda timeout_s: None)

    def close(self):
        """Nothing is left behind."""


class OnFiles:
    """robot.ev3's motor in real time, on whatever files."""

    def __init__(self, root, port):
        self.motor = Ev3Motor("left", port, root)
        self.motor.find()

    def wait(self, seconds):
        time.sleep(seconds)

    def close(self):
        try:
            self.motor.stop()
        finally:
            self.motor._close()


def real():
    """The first motor named in KICK_TEST_PORTS ('outB'), on a brick that runs the tests."""
    return OnFiles(SYSFS, os.environ[REAL_PORTS].split(",")[0])


def refuses(action):
    """Whether a motor says no."""
    try:
        action()
    except MotorFault:
        return True
    return False
