"""The simulated kernel's files in virtual time."""

import os

import pytest

from sim_motor.brick import SimBrick
from sim_motor.sysfs import Tree

MOTOR = "/tacho-motor/motor0/"
READ, WRITE = os.R_OK, os.W_OK


class Files:
    """A tree and its time. Each file is opened once, as programs do."""

    def __init__(self, **options):
        self.brick = SimBrick(1, jitter=False, **options)
        self.tree = Tree(self.brick)
        self.now = 0.0
        self._handles = {}

    def handle(self, path, wanted):
        if (path, wanted) not in self._handles:
            self._handles[path, wanted] = self.tree.open(path, wanted)
        return self._handles[path, wanted]

    def read(self, path):
        return self.tree.read(self.handle(path, READ), 4096, 0).decode().rstrip("\n")

    def write(self, path, text):
        self.tree.write(self.handle(path, WRITE), text.encode())

    def wait(self, seconds):
        self.now += seconds
        self.tree.run_to(self.now)

    def run(self, duty):
        self.write(MOTOR + "duty_cycle_sp", str(duty))
        self.write(MOTOR + "command", "run-direct")

    def inject(self, fault):
        self.write("/.faults", fault)

    def first(self, condition, within=5.0):
        """The time until the condition holds, looked at every 2 ms."""
        begin = self.now
        while not condition():
            assert self.now - begin < within
            self.wait(0.002)
        return self.now - begin

    @property
    def position(self):
        return int(self.read(MOTOR + "position"))


def fails(number):
    return pytest.raises(OSError, match=rf"\[Errno {number}\]")
