"""How well the lab's basins foretell a simulated robot: `python -m tests.bench_basins`.

A picture comes from the batch simulator, with punctual ticks and the motor as published. Here the
robot's own loop runs on simulated bricks, whose motors differ, have play and are read with errors,
and whose ticks are late. It takes about 20 s of a core for each setting.
"""

import random
from array import array
from math import atan2, pi

import numpy as np

from host.lab.basin_question import DECISIVE, Question
from host.lab.basins import FASTEST_TURNS_S, compute, ends_of, start_at, ticks_to_end
from host.lab.derived import wrapped
from robot.kicks import MEMBRANE, PHASE, POSITION
from robot.loop import Loop
from robot.params import Params
from sim_motor.brick import SimBrick
from sim_motor.constants import load

SETTINGS = {
    "ordinary (k = 8, tau = 0.25 s, a = 4)": {},
    "k = 2": {"k": 2.0},
    "tau = 0.5 s": {"tau_s": 0.5},
    "a = 2": {"a": 2.0},
}
STARTS, KICKED = 600, 400
SIDE = 64
LONGEST_KICK_TICKS = 8
# How long robots roll before a kick, at least and at most.
ROLL_TICKS = (100, 120)


class Robot:
    """A simulated brick under the robot's own loop."""

    def __init__(self, seed, changes):
        self.brick = SimBrick(seed)
        self.loop = Loop(self.brick.motors, self.brick.battery, self.brick.clock, seed)
        if changes:
            self.loop.set_params(changes)
        self.loop.start()
        self.wheels = [side.wheel for side in self.loop._sides]

    def place(self, start):
        """Put both wheels where two wheels of a batch start."""
        rows = (self.brick.motors, self.wheels, start.states, start.potentials, start.duties)
        for motor, wheel, state, potentials, duty in zip(*rows, strict=True):
            motor.state[:] = array("d", state)
            wheel.x1, wheel.x2 = potentials.tolist()
            motor.write_duty(int(duty))
        self.loop.deadline += self.loop.params.tick_s

    def run(self, ticks):
        """The angles (rad) of both wheels in the next ticks, (2, ticks)."""
        phi_rad = np.empty((2, ticks))
        for tick in range(ticks):
            self.loop.clock.wait(self.loop.deadline, lambda _: None)
            self.loop.tick()
            phi_rad[:, tick] = [wheel.phi for wheel in self.wheels]
        return phi_rad

    def ends(self):
        """Where both wheels end."""
        return ends_of(self.run(ticks_to_end(self.loop.params)))


def picture(changes, side=SIDE):
    """The basins of a robot with these parameters."""
    return compute(question(changes, side)) | {"side": side}


def question(changes, side):
    """The question about the basins of a robot with these parameters."""
    values = changed(changes).values()
    return Question({name: values[name] for name in DECISIVE}, load(), None, side, (0, side))


def changed(changes):
    """The default parameters with some changes."""
    params = Params()
    if changes:
        params.apply(params.check(changes))
    return params


def end_at(basins, lag_rad, speed_rad_s):
    """Where a picture says that a place in the plane leads: the first letter of an end."""
    side = basins["side"]
    column = int((lag_rad / pi + 1.0) / 2.0 * side)
    row = int((speed_rad_s / (2.0 * pi * basins["fastest"]) + 1.0) / 2.0 * side)
    return basins["ends"][side * min(max(row, 0), side - 1) + min(column, side - 1)]


def starts_as_foretold(changes, basins, wheels, seed=0):
    """Whether each of some wheels ends as the picture says, from a random start of its slice."""
    rng = np.random.default_rng(seed)
    lag_rad = rng.uniform(-pi, pi, wheels)
    speed_rad_s = 2.0 * pi * FASTEST_TURNS_S * rng.uniform(-1.0, 1.0, wheels)
    start = start_at(lag_rad, speed_rad_s, basins["radius"], changed(changes))
    foretold = map(end_at, [basins] * wheels, lag_rad, speed_rad_s)
    ends = []
    for first in range(0, wheels, 2):
        robot = Robot(seed + first, changes)
        robot.place(start.of(slice(first, first + 2)))
        ends += robot.ends()
    return [end[0] == letter for end, letter in zip(ends, foretold, strict=True)]


def kicks_as_foretold(changes, basins, wheels, seed=0):
    """The same for wheels that roll and are kicked, at any angle, by a random kick of the paper.

    What counts is where the page's plane shows them in the last tick of the kick. That is not in
    the picture's slice: angle and memory are what they are.

    Returns:
        Pairs: the kick's mode, and whether the wheel ended as foretold.
    """
    chance = random.Random(seed)
    found = []
    for first in range(0, wheels, 2):
        robot = Robot(seed + first, changes)
        ticks = chance.randint(1, LONGEST_KICK_TICKS)
        kick = chance.choice(
            (
                {"mode": MEMBRANE},
                {"mode": POSITION, "ticks": ticks},
                {"mode": PHASE, "ticks": ticks, "shift": chance.uniform(-pi, pi)},
            )
        )
        before = robot.run(chance.randint(*ROLL_TICKS))
        robot.loop.kick({"id": "kick", **kick})
        phi_rad = np.hstack((before, robot.run(kick.get("ticks", 1))))
        speeds_rad_s = (phi_rad[:, -1] - phi_rad[:, -2]) / robot.loop.params.tick_s
        foretold = [
            end_at(basins, wrapped(wheel.phi - atan2(wheel.x2, wheel.x1)), speed_rad_s)
            for wheel, speed_rad_s in zip(robot.wheels, speeds_rad_s, strict=True)
        ]
        found += [
            (kick["mode"], end[0] == letter)
            for end, letter in zip(robot.ends(), foretold, strict=True)
        ]
    return found


def basins() -> None:
    """Print the shares at each setting."""
    for name, changes in SETTINGS.items():
        drawn = picture(changes)
        starts = starts_as_foretold(changes, drawn, STARTS)
        kicked = kicks_as_foretold(changes, drawn, KICKED)
        all_of = starts + [right for _, right in kicked]
        print(
            f"basins, {name}: {np.mean(all_of):.1%} of {len(all_of)} ended as drawn:"
            f" {np.mean(starts):.1%} of {STARTS} starts in the slice, "
            + ", ".join(
                f"{np.mean(rights):.1%} of {len(rights)} after a {mode} kick"
                for mode in (MEMBRANE, POSITION, PHASE)
                if (rights := [right for one, right in kicked if one == mode])
            ),
            flush=True,
        )


if __name__ == "__main__":
    basins()
