"""What a pupil does in each guided exercise, with a robot in virtual time."""

from host.client.robot import connect


def start(robot):
    for _ in range(10):
        robot.start()
        robot.wait(1.3)
        robot.stop()
        robot.wait(0.1)


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
    for ticks in (1, 2, 3, 4, 6, 10, 10):
        robot.kick("phase", ticks=ticks)
        robot.wait(3.0)


def there_and_back(robot):
    robot.start()
    robot.wait(2.0)
    for k in (0.7, 0.5, 0.35, 0.5, 0.6, 0.9, 1.4, 2.5):
        robot.set(k=k)
        robot.wait(2.0)


DO = {"start": start, "jump": jump, "longer": longer, "there-and-back": there_and_back}


def log_of(lesson, seed=1, **params):
    """The log of a pupil who has done an exercise of lessons.toml.

    Args:
        lesson: The exercise.
        seed: The robot's random seed.
        params: Its parameters besides those of the exercise.
    """
    walls = "&walls=2" if lesson["walls"] else ""
    with connect(f"sim://?seed={seed}&idle=1{walls}") as robot:
        robot.set(**lesson["set"], **params)
        with robot.recording() as log:
            DO[lesson["name"]](robot)
        return log
