"""The lines that `kickctl watch` shows of a robot, one for each refresh."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from host.client.robot import Robot
from host.commands._watched import Watched

REFRESH_S = 0.1


def lines(
    robot: Robot, seconds: float, until: Callable[[], bool], pause: Callable[[float], object]
) -> Iterator[dict[str, Any]]:
    """Watch a robot.

    Args:
        robot: The robot.
        seconds: How long to watch (s of the robot's time).
        until: Ends a refresh early as soon as it returns True.
        pause: Lets real time pass.

    Yields:
        Watched.line.
    """
    watched = Watched()
    robot.add_tap(watched)
    robot.wait(REFRESH_S)
    shown = False  # there is one line at least, no matter how short the time is
    while not shown or watched.elapsed_s < seconds:
        robot.wait(REFRESH_S, until)
        if robot.link.virtual:
            # Virtual time would pass before anyone has seen it.
            pause(REFRESH_S)
        if watched.status_due:
            watched.take_status(robot.status())
        line = watched.line()
        if line is not None:
            shown = True
            yield line
