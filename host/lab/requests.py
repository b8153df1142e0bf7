"""What pages send, read and checked. What is wrong with it is said in words."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import isfinite
from typing import Any

from host.errors import RefusedByRobot, WrongUse, quotable
from host.lab.lessons.straight import STRAIGHT
from host.lab.presets import PRESETS, PRIMITIVES
from robot.kick_requests import FIELDS
from robot.kicks import WHEELS

MAX_BYTES = 4096
LARGEST_REQUEST = 2**53
RELOAD = "reload the page"
GUESSES = ("reverses", "continues", "stops")


def parse(text: str) -> dict[str, Any]:
    """Read a message.

    Args:
        text: What a page has sent.

    Returns:
        An object with a `type`, which is text; nothing else is known of it.

    Raises:
        WrongUse: It is something else.
    """
    if len(text.encode(errors="surrogatepass")) > MAX_BYTES:
        raise WrongUse(f"a message has more than {MAX_BYTES} bytes", "send less at a time")
    try:
        message = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise WrongUse("a message is not JSON", RELOAD) from error
    if not isinstance(message, dict) or not isinstance(message.get("type"), str):
        raise WrongUse("a message is no object with a type", RELOAD)
    return message


def request_of(message: dict[str, Any]) -> int | None:
    """The number by which the message wants to be answered; None if it has none that can be."""
    request = message.get("request")
    if isinstance(request, bool) or not isinstance(request, int):
        return None
    return request if abs(request) <= LARGEST_REQUEST else None


def text_of(message: dict[str, Any], name: str) -> str:
    """A field that is text. Raises WrongUse."""
    value = message.get(name)
    if not isinstance(value, str):
        raise WrongUse(f"'{name}' is missing, or is no text", RELOAD)
    return value


def whole_of(message: dict[str, Any], name: str) -> int:
    """A field that is a whole number. Raises WrongUse."""
    value = message.get(name)
    if isinstance(value, bool) or not isinstance(value, int):
        raise WrongUse(f"'{name}' is missing, or is no whole number", RELOAD)
    return value


def angle_of(message: dict[str, Any]) -> float | None:
    """The angle of a `hand`, rad; None lets go. Raises WrongUse."""
    value = message.get("angle_rad")
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e6:
        raise WrongUse("'angle_rad' is no angle", "give a number of rad, or null")
    return float(value)


def wheel_of(message: dict[str, Any]) -> str:
    """The wheel of a `hand`. Raises WrongUse."""
    wheel = text_of(message, "wheel")
    if wheel not in WHEELS:
        raise WrongUse(f"there is no wheel '{quotable(wheel)}'", "it is left or right")
    return wheel


def kick_of(fields: object) -> dict[str, Any]:
    """A kick as a page describes it, without its guess and without what is null.

    The robot checks the values. Raises WrongUse for fields that no kick has.
    """
    if not isinstance(fields, dict):
        raise WrongUse("a kick is missing", RELOAD)
    kick = {name: value for name, value in fields.items() if name != "guess" and value is not None}
    for name in kick:
        if name not in FIELDS or name == "id":
            raise WrongUse(f"a kick has no '{quotable(name)}'", RELOAD)
    return kick


def guess_of(fields: dict[str, Any]) -> str | None:
    """What the person expects of a kick; None if nothing. Raises WrongUse."""
    guess = fields.get("guess")
    if guess is not None and guess not in GUESSES:
        raise WrongUse("nobody can guess this", f"a guess is one of {', '.join(GUESSES)}")
    return guess


def changes_of(fields: dict[str, Any]) -> dict[str, Any]:
    """Parameters to set, by name; the robot checks their values. Raises WrongUse."""
    changes = fields.get("set")
    if not isinstance(changes, dict) or not changes:
        raise WrongUse("no parameter is named", "name at least one")
    for value in changes.values():
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise WrongUse("a parameter's value is a number or text", RELOAD)
        if isinstance(value, float) and not isfinite(value):
            raise WrongUse("a parameter's value is no finite number", "give a smaller one")
    return changes


def flag_of(fields: dict[str, Any], name: str) -> bool:
    """A field that is true or false. Raises WrongUse."""
    value = fields.get(name)
    if not isinstance(value, bool):
        raise WrongUse(f"'{name}' is missing, or is neither true nor false", RELOAD)
    return value


def named(fields: dict[str, Any], choices: dict[str, Any]) -> str:
    """The field `name`, which is one of the choices' names. Raises WrongUse."""
    name = text_of(fields, "name")
    if name not in choices:
        raise WrongUse(f"there is no '{quotable(name)}'", f"choose from {', '.join(choices)}")
    return name


_Check = Callable[[dict[str, Any]], dict[str, Any]]
_CHECKS: dict[str, _Check] = {
    "start": lambda fields: {},
    "clear": lambda fields: {},
    "identify": lambda fields: {},
    "take_over": lambda fields: {},
    "kick": kick_of,
    "set": lambda fields: {"set": changes_of(fields)},
    "record": lambda fields: {"on": flag_of(fields, "on")},
    "preset": lambda fields: {"set": PRESETS[named(fields, PRESETS)].set},
    "primitive": lambda fields: {"name": named(fields, {**PRIMITIVES, STRAIGHT: ""})},
}


def arguments_of(command: str, fields: dict[str, Any], *, stops: bool) -> dict[str, Any]:
    """The arguments of a command as a station takes them.

    Args:
        command: One of the commands of MESSAGES.md.
        fields: What the page says of it.
        stops: Whether the robot is to stop when nobody attends to it.

    Raises:
        KickctlError: There is no command of this kind, or its arguments are wrong.
    """
    if command not in _CHECKS:
        raise WrongUse(f"there is no command '{quotable(command)}'", RELOAD)
    checked = _CHECKS[command](fields)
    if stops and checked.get("set", {}).get("link_loss") == "continue":
        raise RefusedByRobot(
            "with link_loss = continue the robot would drive on when nobody attends to it, and"
            " this lab is to stop it then",
            "start the lab with --unattended continue if that is what you want",
        )
    return checked


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no number in JSON")
