"""What a pupil does in each guided exercise, with a robot in virtual time or the model wheel.

And robots and wheels that cheat: they do something else than they say.
"""

from functools import partial
from unittest.mock import patch

import numpy as np

from host.client.robot import connect
from host.experiments.robot.wall_hits import bounces, motion_since
from host.kicking.modes import MODES, WALL_TURNER
from host.kicking.steps import play
from host.lab.lessons import checks, model, model_checks
from host.lab.lessons.model_checks import PAIRS, Shown
from host.lab.lessons.straight import start_straight
from host.logs.log import Log
from host.theory.model.wheel import Wheel
from sim_motor.hand import pull

WALLS = MODES[WALL_TURNER].address
# How many robots a pupil has at most; one in twenty slides along a wall.
ROBOTS = 3


def start(robot):
    for _ in range(10):
        robot.start()
        robot.wait(1.3)
        robot.stop()
        robot.wait(0.1)


def trace(robot):
    brick = robot.link.brick
    motor = brick.motors[0]
    for angle_rad in (0, 1, 2, 3, 3, 2, 1, 0):
        for _ in range(10):
            truth = motor.truth()
            away_rad = motor.mount * angle_rad - truth.wheel_angle
            brick.set_load(0, pull(away_rad, truth.wheel_speed))
            robot.wait(0.03)


def jump(robot):
    robot.start()
    robot.wait(2.0)
    robot.kick("membrane")
    robot.wait(2.0)
    robot.kick("phase", ticks=4)
    robot.wait(2.0)


def longer(robot):
    robot.start()
    robot.wait(2.0)
    for ticks in (1, 2, 3, 3, 4, 4, 6, 6, 10, 10):
        robot.kick("phase", ticks=ticks)
        robot.wait(3.0)


def there_and_back(robot):
    robot.start()
    robot.wait(2.0)
    for k in (0.7, 0.5, 0.35, 0.5, 0.6, 0.9, 1.4, 2.5):
        robot.set(k=k)
        robot.wait(2.0)


def wall(robot):
    play(robot, start_straight(robot))
    robot.wait(20.0)


DO = {
    "start": start,
    "trace": trace,
    "jump": jump,
    "longer": longer,
    "there-and-back": there_and_back,
    "wall": wall,
}


def log_of(lesson, seed=1, **params):
    """The log of a pupil who has done an exercise of lessons.toml.

    Args:
        lesson: The exercise.
        seed: The robot's random seed.
        params: Its parameters besides those of the exercise.
    """
    address = WALLS if lesson["walls"] else "sim://?"
    for _ in range(ROBOTS):
        with connect(f"{address}&seed={seed}&idle=1") as robot:
            robot.set(**lesson["set"], **params)
            with robot.recording() as log:
                DO[lesson["name"]](robot)
        if not lesson["walls"] or len(bounces(*motion_since(log))) >= 2:
            break
        seed += 1000  # it slides along a wall: the pupil begins again with another robot
    return log


def ring(chosen):
    """Some k from 1.4 to 1.7, and the middle of the swings that died out and those that grew."""
    ks = (np.linspace(1.4, 1.7, 7) + chosen.uniform(-0.01, 0.01, 7)).clip(1.4, 1.7).round(2)
    runs = [Shown(k, model.ring(k).seen) for k in ks.tolist()]
    dying = [run.value for run in runs if run.seen[1] < 1.0]
    growing = [run.value for run in runs if run.seen[1] > 1.0]
    return runs, (max(dying, default=1.4) + min(growing, default=1.7)) / 2


def part(chosen):
    """Some pairs of twins, and the slope of their mean."""
    numbers = chosen.choice(50, PAIRS, replace=False) + 1
    runs = [Shown(number, model.part(number).seen) for number in numbers.tolist()]
    rises = [late - early for _, (early, late) in runs]
    return runs, float(np.mean(rises)) / (model.LATE_S - model.EARLY_S)


RUN = {"rest": ring, "twins": part}


def runs_of(lesson, seed=1):
    """The runs and the own number of a pupil who has done an exercise with the model wheel."""
    return RUN[lesson["name"]](np.random.default_rng(seed))


def failed(lesson, work):
    """What a check does not let pass, in words.

    Args:
        lesson: The exercise.
        work: What `log_of` or `runs_of` has given.
    """
    name = lesson["name"]
    found = model_checks.check(name, *work) if name in RUN else checks.check(name, work)
    return [finding.words for finding in found if not finding.ok]


def copied(log):
    """The same log, whose events may be changed."""
    copy = Log(log.info)
    for item in log.stream():
        if isinstance(item, dict):
            kick = {"kick": dict(item["kick"])} if item.get("kick") else {}
            copy.take_event({**item, **kick})
        else:
            copy.take_records([item])
    return copy


def with_another_tau(log):
    """The log of a robot that says another tau than it has."""
    log = copied(log)
    log.events[0]["params"] = {**log.events[0]["params"], "tau_s": 0.4}
    return log


def runs_with_another_tau(lesson, seed=1):
    """What a pupil finds with a model wheel that has another tau than the exercise says."""
    with (
        patch.object(model, "Wheel", partial(Wheel, tau=0.27)),
        patch.object(model, "CHAOTIC", Wheel(k=15.0, tau=1.1)),
    ):
        return runs_of(lesson, seed)


def with_swapped_kicks(log):
    """The log of a robot that does its second kick first."""
    log = copied(log)
    (_, one), (_, other) = log.kicks()
    for field in ("mode", "ticks", "pulse", "values"):
        one[field], other[field] = other[field], one[field]
    return log


def with_swapped_runs(work):
    """The runs of a model wheel that does the last run first."""
    (first, *rest, last), own = work
    return [first._replace(seen=last.seen), *rest, last._replace(seen=first.seen)], own
