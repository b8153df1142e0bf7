"""Drive a train that has no steering to a place, by kicks alone.

First learn, by trying, what kicks do to its course; then plan with that.

Two kicked wheels bend the train. The kick brakes the left wheel of the first car and the right
wheel of the last, which pull both ends of the train to the same side: so it turns, whichever way it
goes. How far it turns, and how much of that comes only after the kick, is what must be learned.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from host.errors import NotDone
from host.util.extras import need
from robot.kicks import PHASE
from sim_motor.bodies.presets import PUSHED

if TYPE_CHECKING:
    from sim_motor.bodies.environment import Info, Train

Array = NDArray[np.float64]
Action = NDArray[np.int64]
Pose = tuple[float, float, float]

# Once every KICK_S (s) there is a choice: no kick, or a phase kick of this length on the left wheel
# of the first car and the right wheel of the last, or on the other two.
CHOICES = NO_KICK, LEFT, RIGHT = range(3)
KICK_S = 1.0
# Every choice after every other, once; the first follows the last.
ALL_PAIRS = (NO_KICK, LEFT, NO_KICK, RIGHT, LEFT, LEFT, RIGHT, RIGHT, NO_KICK)
# The train's pose is measured every LOOK_S (s). It runs for START_S (s) before its first choice,
# and plans AHEAD choices ahead.
LOOK_S, START_S, AHEAD = 0.1, 6.0, 10
# To be somewhere a second sooner is worth this much (m).
SOONER_M = 0.05
# The wheels start where rods push them forward, or at the mirror image, backward; normally
# distributed around it with this standard deviation (rad).
SPREAD_RAD = 0.3


def build_environment(preset: str) -> Train:
    """The train to be driven, as a Gymnasium environment.

    Args:
        preset: name of the train's preset.

    Returns:
        The environment, of five cars on a flat floor.

    Raises:
        WrongUse: if Gymnasium or MuJoCo is not installed.
    """
    need("gymnasium", "gym")
    need("mujoco", "gym")
    from sim_motor.bodies.environment import Train

    return Train(preset=preset, decision_s=LOOK_S, kick_s=KICK_S, time_s=1e6)


class Drive:
    """One drive of a train.

    It starts forward or backward by chance, and runs for START_S before the first choice.

    Args:
        train: as `build_environment` builds it; it is reset.
        seed: of the random start.

    Attributes:
        poses: (x m, y m, course rad) every LOOK_S from the first choice on.
        choices: what was chosen, every KICK_S.

    Raises:
        NotDone: if the train falls over, or the simulation becomes unstable.
    """

    def __init__(self, train: Train, seed: int) -> None:
        self._train, self._wheels = train, train.action_space.shape or ()
        rng = np.random.default_rng(seed)
        phases = rng.choice((-1.0, 1.0)) * PUSHED + rng.normal(0.0, SPREAD_RAD, self._wheels)
        train.reset(seed=seed, options={"phases": phases})
        self.choices: list[int] = []
        self.poses: list[Pose] = []
        self._run(START_S, np.zeros(self._wheels, dtype=np.int64))
        self.poses = self.poses[-1:]

    @property
    def last(self) -> int:
        """The last choice."""
        return self.choices[-1] if self.choices else NO_KICK

    def choose(self, choice: int) -> None:
        """Do one of CHOICES, and run for KICK_S.

        Raises:
            NotDone: if the train falls over, or the simulation becomes unstable.
        """
        from sim_motor.bodies.environment import KICKS

        kicked = {NO_KICK: [], LEFT: [0, -1], RIGHT: [1, -2]}[choice]
        action = np.zeros(self._wheels, dtype=np.int64)
        action[kicked] = KICKS.index(PHASE)
        self._run(KICK_S, action)
        self.choices.append(choice)

    def _run(self, seconds: float, action: Action) -> None:
        for _ in range(round(seconds / LOOK_S)):
            info = self._train.step(action)[-1]
            if info["ended"]:
                raise NotDone(f"the train can go no further: {info['ended']}", "try another seed")
            self.poses.append(measure_pose(info))
            action = np.zeros_like(action)


def measure_pose(info: Info) -> Pose:
    """The train's pose: (x m, y m, course rad) of its middle.

    Its course is along the line through its ends, the way that it goes.
    """
    cars: Array = info["cars"]
    x, y = cars[:, :2].mean(axis=0)
    ahead_x, ahead_y = (cars[0] - cars[-1])[:2] * (info["direction"] or 1)
    return float(x), float(y), float(np.arctan2(ahead_y, ahead_x))


def relative_to(origin: ArrayLike, poses: ArrayLike) -> Array:
    """Poses as seen from another pose.

    Args:
        origin: the pose (x m, y m, course rad) to look from.
        poses: (n, 3).

    Returns:
        (n, 3) of (m ahead, m to the left, rad to the left).
    """
    x, y, course = np.asarray(origin)
    there = np.asarray(poses)
    dx, dy = there[:, 0] - x, there[:, 1] - y
    turned = (there[:, 2] - course + np.pi) % (2 * np.pi) - np.pi
    ahead = np.cos(course) * dx + np.sin(course) * dy
    left = np.cos(course) * dy - np.sin(course) * dx
    return np.stack([ahead, left, turned], axis=1)


def learn(train: Train, seed: int, rounds: int) -> Array:
    """Learn what choices do to the train's course.

    The train tries every choice after every other, because a kick acts on when it is over: the
    joints are still bent.

    Args:
        train: as `build_environment` builds it.
        seed: of the drive.
        rounds: how often every choice after every other is tried.

    Returns:
        The mean course during KICK_S, every LOOK_S, as seen from where the train chose: (last
        choice, choice, times, 3).

    Raises:
        NotDone: if the train falls over, or the simulation becomes unstable.
    """
    times = round(KICK_S / LOOK_S)
    drive = Drive(train, seed)
    effects = np.zeros((len(CHOICES), len(CHOICES), times, 3))
    for choice in ALL_PAIRS * rounds:
        last = drive.last
        drive.choose(choice)
        effects[last, choice] += relative_to(drive.poses[-times - 1], drive.poses[-times:]) / rounds
    return effects


def plan(effects: Array, start: Any, last: int, goal: Array) -> int:
    """Choose what to do, by comparing all plans of AHEAD choices.

    Args:
        effects: what choices do, as `learn` returns it.
        start: the train's pose (x m, y m, course rad).
        last: its last choice.
        goal: (x m, y m).

    Returns:
        The first choice of the plan that brings the train nearest to the goal.
    """
    # One entry for each plan so far: its pose, its last choice, its cost and its first choice.
    x, y, course = (np.array([value]) for value in start)
    before, cost, first = np.array([last]), np.array([np.inf]), np.array([NO_KICK])
    for number in range(AHEAD):
        # Every plan so far goes on in each way.
        choice = np.tile(CHOICES, len(x))
        x, y, course, before, cost, first = (
            np.repeat(values, len(CHOICES)) for values in (x, y, course, before, cost, first)
        )
        first = choice if number == 0 else first
        cos, sin = np.cos(course), np.sin(course)
        for look in range(effects.shape[2]):
            ahead, left, turned = effects[:, :, look].T[:, choice, before]
            xs, ys = x + cos * ahead - sin * left, y + sin * ahead + cos * left
            late_m = SOONER_M * (KICK_S * number + LOOK_S * look)
            cost = np.minimum(cost, np.hypot(xs - goal[0], ys - goal[1]) + late_m)
        x, y, course, before = xs, ys, course + turned, choice
    return int(first[np.argmin(cost)])
