"""Hints that work when they are typed: they name the robot that was named on the command line."""

from __future__ import annotations

import re
import shlex

# Verbs that reach a robot, as hints name them.
_VERBS = (
    "demo|kick|plan|drive|start|stop|clear|status|params|record|watch|doctor|rods|log pull"
    "|experiment|reproduce"
)
# Not before a --help, which needs no robot.
_COMMAND = re.compile(rf"\bkickctl (?:{_VERBS})\b(?![^`'\"\n,;]*--help)")
_named: list[str] = []


def name_robot(brick: str | None, token: str | None) -> None:
    """Remember how the command line has named the robot; None where it has not."""
    pairs = (("--brick", brick), ("--token", token))
    _named[:] = [f" {option} {shlex.quote(value)}" for option, value in pairs if value is not None]


def as_typed(text: str) -> str:
    """The text, with the robot's name in every command of it that reaches a robot."""
    return _COMMAND.sub(lambda found: found[0] + "".join(_named), text) if _named else text
