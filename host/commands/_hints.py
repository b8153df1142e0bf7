"""Hints that work when they are typed: they name the robot that was named on the command line."""

from __future__ import annotations

import re
import shlex

from robot.params import TABLE

# Commands that reach a robot, as hints name them. The robot's name goes behind them.
_SETTING = f"(?:{'|'.join(TABLE)})(?:=[-+.\\w]*\\w)?"
_COMMAND = re.compile(
    r"\bkickctl (?:"
    rf"params(?: (?:list|get|set|reset)\b(?: {_SETTING}\b)*)?"
    r"|drive(?: (?:forward|backward|spin-left|spin-right|stopped|chaos|wall-turner))?"
    r"|experiment [-\w]+|kick(?: --mode \w+)?|record(?: [0-9]+)?|log pull"
    r"|demo|plan|start|stop|clear|status|identify|watch|lab|foxglove|doctor|rods|reproduce"
    # --help needs no robot, and words that another process has said may name theirs already.
    r")\b(?![^`'\"\n,;]*--(?:help|brick|token)\b)"
)
_named: list[str] = []


def name_robot(brick: str | None, token: str | None) -> None:
    """Remember how the command line has named the robot; None where it has not."""
    pairs = (("--brick", brick), ("--token", token))
    _named[:] = [f" {option} {shlex.quote(value)}" for option, value in pairs if value is not None]


def as_typed(text: str) -> str:
    """The text, with the robot's name in every command of it that reaches a robot."""
    return _COMMAND.sub(lambda found: found[0] + "".join(_named), text) if _named else text
