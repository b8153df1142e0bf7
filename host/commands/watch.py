"""kickctl watch."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from math import inf
from typing import Any

from host.client.robot import Robot
from host.commands._keys import keys, why_no_keys
from host.commands._terminal import robot_of
from host.commands._watch_keys import FOOT, KeyActions
from host.commands._watch_table import Screen
from host.commands._watched import Watched
from host.util.numbers import Number

HELP = (
    "show what the robot does in a live table; on a terminal, space stops it, 1 to 5 kick it, ?"
    " explains the keys, and q ends the table. With --json: a stream of JSON lines, one object for"
    " each refresh"
)

REFRESH_S = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add how long to watch."""
    parser.add_argument(
        "--seconds",
        type=Number("s", 0.001, 1e9),
        default=inf,
        metavar="S",
        help="how long to watch, in s of the robot's time (default: until q or ^C)",
    )


def run(options: argparse.Namespace) -> int:
    """Show the table; with --json print a line of JSON for each refresh instead."""
    with robot_of(options) as robot:
        watched = Watched()
        robot.add_tap(watched)
        robot.wait(REFRESH_S)
        show = _print_lines if options.json else _show_table
        with suppress(KeyboardInterrupt):
            show(robot, watched, options.seconds)
    return 0


def _print_lines(robot: Robot, watched: Watched, seconds: float) -> None:
    import time

    from host.commands._terminal import show_next

    for line in _lines(robot, watched, seconds, lambda: False, time.sleep):
        show_next(line)


def _show_table(robot: Robot, watched: Watched, seconds: float) -> None:
    lacking = why_no_keys()
    screen = Screen(robot.link.uri, [f"no keys: {lacking}"] if lacking else FOOT)
    actions = KeyActions(robot, screen.add, screen.change_foot)
    with ExitStack() as stack:
        stack.enter_context(screen.shown())
        stack.callback(actions.close)
        if not lacking:
            stack.enter_context(keys(actions.press, screen.close, screen.open))
        for line in _lines(robot, watched, seconds, lambda: actions.waiting, actions.pause):
            screen.take(line)
            actions.kick()
            if actions.left:
                break


def _lines(
    robot: Robot,
    watched: Watched,
    seconds: float,
    until: Callable[[], bool],
    pause: Callable[[float], object],
) -> Iterator[dict[str, Any]]:
    """A line for each refresh.

    Args:
        robot: The robot.
        watched: A tap that the robot feeds.
        seconds: How long to watch (s of the robot's time).
        until: Ends a refresh early as soon as it returns True.
        pause: Lets real time pass.

    Yields:
        Watched.line.
    """
    while watched.elapsed_s < seconds:
        robot.wait(REFRESH_S, until)
        if robot.link.virtual:
            # Virtual time would pass before anyone has seen it.
            pause(REFRESH_S)
        if watched.status_due:
            watched.take_status(robot.status())
        line = watched.line()
        if line is not None:
            yield line
