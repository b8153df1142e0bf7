"""kickctl watch."""

from __future__ import annotations

import argparse
import time
from contextlib import ExitStack, suppress
from math import inf

from host.client.robot import Robot
from host.commands._keys import keys, why_no_keys
from host.commands._terminal import robot_of, show_next
from host.commands._watch_keys import FOOT, KeyActions
from host.commands._watch_lines import lines
from host.commands._watch_table import OneRobot
from host.link.names import is_several, named, several
from host.util.numbers import Number

HELP = (
    "show what the robot does in a live table; on a terminal, space stops it, 1 to 5 kick it, ?"
    " explains the keys, and q ends the table. ^C ends it too, and the exit status is 0. With"
    " --json: a stream of JSON lines, one object for each refresh"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add how long to watch, and whether a kick takes control from another host."""
    parser.add_argument(
        "--seconds",
        type=Number("s", 0.001, 1e9),
        default=inf,
        metavar="S",
        help="how long to watch, in s of the robot's time (default: until q or ^C)",
    )
    parser.add_argument(
        "--take-over",
        action="store_true",
        dest="keys_take_over",
        help="keys also kick a robot that somebody else drives; their program says that you took"
        " control",
    )


def run(options: argparse.Namespace) -> int:
    """Show the table; with --json print a line of JSON for each refresh instead."""
    text = named(options.brick)
    if text is not None and is_several(text):
        from host.commands._watch_several import watch_several

        return watch_several(options, several(text))
    with robot_of(options) as robot:
        show = _print_lines if options.json else _show_table
        with suppress(KeyboardInterrupt):
            show(robot, options)
    return 0


def _print_lines(robot: Robot, options: argparse.Namespace) -> None:
    for line in lines(robot, options.seconds, lambda: False, time.sleep):
        show_next(line)


def _show_table(robot: Robot, options: argparse.Namespace) -> None:
    lacking = why_no_keys()
    screen = OneRobot(robot.link.uri, [f"no keys: {lacking}"] if lacking else FOOT)
    actions = KeyActions(
        robot.stop_at_once, screen.add, screen.change_foot, take_over=options.keys_take_over
    )
    with ExitStack() as stack:
        stack.enter_context(screen.shown())
        stack.callback(actions.close)
        if not lacking:
            robot.on_trouble = screen.add
            stack.enter_context(keys(actions.press, screen.close, screen.open))
        for line in lines(robot, options.seconds, lambda: actions.waiting, actions.pause):
            screen.take(line)
            actions.kick(robot)
            if actions.left:
                break
