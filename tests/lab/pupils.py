"""What a pupil does in each guided exercise, with a robot in virtual time."""

from host.client.robot import connect
from host.experiments.robot.wall_hits import bounces, motion_since
from host.kicking.modes import MODES, WALL_TURNER
from sim_motor.hand import pull

WALLS = MODES[WALL_TURNER].address


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
    robot.start()
    robot.wait(16.0)


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
    while True:
        with connect(f"{address}&seed={seed}&idle=1") as robot:
            robot.set(**lesson["set"], **params)
            with robot.recording() as log:
                DO[lesson["name"]](robot)
        if not lesson["walls"] or len(bounces(*motion_since(log))) >= 2:
            return log
        seed += 1000  # it turned on the spot: the pupil begins again with another robot
