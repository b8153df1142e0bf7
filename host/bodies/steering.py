"""Drives a train that nobody steers to a place, by kicks alone.

It learns by trying what kicks do to its course, and then plans with that.

Two kicked wheels bend the train: the left one of its first car and the right one of its last, which
the kick brakes, pull both ends of the train to the same side, and so it turns, whichever way it
goes. How far, and how much of a kick comes only after it, is what it learns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from host.errors import NotDone
from host.util.extras import need
from robot.kicks import PHASE
from sim_motor.bodies.presets import PUSHED

if TYPE_CHECKING:
    from sim_motor.bodies.environment import Info, Train

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# What can be done, once every KICK_S (s): nothing, or a phase kick of so long on the left wheel of
# the first car and the right one of the last, or the other two.
CHOICES = ON, LEFT, RIGHT = range(3)
KICK_S = 1.0
# Every choice after every other, once; the first follows the last.
ALL_PAIRS = (ON, LEFT, ON, RIGHT, LEFT, LEFT, RIGHT, RIGHT, ON)
# How often (s) the train is looked at, how long (s) it runs before anything is asked of it, and how
# many choices are planned ahead.
LOOK_S, START_S, AHEAD = 0.1, 6.0, 10
# What it is worth to be somewhere a second sooner (m).
SOONER_M = 0.05
# The wheels begin where rods push them forward, or at the mirror image, which is backward; give or
# take so much (rad).
SPREAD_RAD = 0.3


def environment(preset: str) -> Train:
    """The train that is driven. Raises WrongUse if Gymnasium is not installed."""
    need("gymnasium", "gym")
    need("mujoco", "gym")
    from sim_motor.bodies.environment import Train

    return Train(preset=preset, decision_s=LOOK_S, kick_s=KICK_S, time_s=1e6)


class Drive:
    """A train on its way, started by `seed`, forward or backward by chance, and let run for START_S.

    poses: (x m, y m, course rad) every LOOK_S from then on; choices: what was chosen every KICK_S.
    Raises NotDone if the train falls over or can no longer be followed.
    """

    def __init__(self, train: Train, seed: int) -> None:
        self._train, self._wheels = train, train.action_space.shape or ()
        rng = np.random.default_rng(seed)
        phases = rng.choice((-1.0, 1.0)) * PUSHED + rng.normal(0.0, SPREAD_RAD, self._wheels)
        train.reset(seed=seed, options={"phases": phases})
        self.choices: list[int] = []
        self.poses: list[tuple[float, float, float]] = []
        self._go_on(START_S, np.zeros(self._wheels, dtype=np.int64))
        self.poses = self.poses[-1:]

    @property
    def last(self) -> int:
        """What was chosen last."""
        return self.choices[-1] if self.choices else ON

    def choose(self, choice: int) -> None:
        """Do one of CHOICES, and see for KICK_S what comes of it."""
        from sim_motor.bodies.environment import KICKS

        action = np.zeros(self._wheels, dtype=np.int64)
        action[{ON: [], LEFT: [0, -1], RIGHT: [1, -2]}[choice]] = KICKS.index(PHASE)
        self._go_on(KICK_S, action)
        self.choices.append(choice)

    def _go_on(self, seconds: float, action: Whole) -> None:
        for _ in range(round(seconds / LOOK_S)):
            info = self._train.step(action)[-1]
            if info["ended"]:
                raise NotDone(f"the train can go no further: {info['ended']}", "try another seed")
            self.poses.append(pose(info))
            action = np.zeros_like(action)


def pose(info: Info) -> tuple[float, float, float]:
    """Where the train's middle is (m), and its course (rad).

    Along the line through its ends, the way that it goes.
    """
    cars: Array = info["cars"]
    x, y = cars[:, :2].mean(axis=0)
    ahead_x, ahead_y = (cars[0] - cars[-1])[:2] * (info["direction"] or 1)
    return float(x), float(y), float(np.arctan2(ahead_y, ahead_x))


def seen_from(origin: Any, poses: Any) -> Array:
    """Poses, (n, 3), as (m ahead, m to the left, rad to the left) of the pose `origin`."""
    (x, y, course), poses = origin, np.asarray(poses)
    dx, dy = poses[:, 0] - x, poses[:, 1] - y
    turned = (poses[:, 2] - course + np.pi) % (2 * np.pi) - np.pi
    return np.stack(
        [
            np.cos(course) * dx + np.sin(course) * dy,
            np.cos(course) * dy - np.sin(course) * dx,
            turned,
        ],
        axis=1,
    )


def learn(train: Train, seed: int, rounds: int) -> Array:
    """What choices do: the mean course, every LOOK_S of KICK_S, as seen from where the train chose; (last choice, choice, times, 3).

    It tries every choice after every other, `rounds` times: a kick goes on to act when it is over,
    for the joints are still bent. Raises NotDone.
    """
    times = round(KICK_S / LOOK_S)
    drive = Drive(train, seed)
    effects = np.zeros((len(CHOICES), len(CHOICES), times, 3))
    for choice in ALL_PAIRS * rounds:
        last = drive.last
        drive.choose(choice)
        effects[last, choice] += seen_from(drive.poses[-times - 1], drive.poses[-times:]) / rounds
    return effects


def plan(effects: Array, start: Any, last: int, goal: Array) -> int:
    """The first of those AHEAD choices that bring a train at the pose `start`, which chose `last`, nearest to the goal (x m, y m)."""
    x, y, course = (np.array([value]) for value in start)
    before, cost, first = np.array([last]), np.array([np.inf]), np.array([ON])
    looks = np.arange(effects.shape[2])
    for number in range(AHEAD):
        # Every plan so far goes on in each way.
        choice = np.tile(CHOICES, len(x))
        x, y, course, before, cost, first = (
            np.repeat(values, len(CHOICES)) for values in (x, y, course, before, cost, first)
        )
        first = choice if number == 0 else first
        ahead, left, turned = np.moveaxis(effects[before, choice], -1, 0)
        cos, sin = np.cos(course)[:, None], np.sin(course)[:, None]
        xs, ys = x[:, None] + cos * ahead - sin * left, y[:, None] + sin * ahead + cos * left
        away = np.hypot(xs - goal[0], ys - goal[1]) + SOONER_M * (KICK_S * number + LOOK_S * looks)
        cost = np.minimum(cost, away.min(axis=1))
        x, y, course, before = xs[:, -1], ys[:, -1], course + turned[:, -1], choice
    return int(first[np.argmin(cost)])
