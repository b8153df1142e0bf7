"""What viewers see of each robot: the names of its topics, services and parameters."""

from __future__ import annotations

import re
from collections.abc import Sequence

from host.errors import WrongUse

# Viewers read a point or a colon in a path as its end.
_ODD = re.compile(r"[^A-Za-z0-9_-]+")


def prefixes(names: Sequence[str]) -> dict[str, str]:
    """What stands before the topics of each robot.

    One robot has the topics of a log, /ticks and /events. Of several, each has them under its name,
    as in /anna/ticks; other letters than those of a topic become _.

    Args:
        names: The robots' names or addresses.

    Returns:
        The prefixes by name, such as {'anna': '/anna', 'bert': '/bert'}.

    Raises:
        WrongUse: Two robots would have the same topics.
    """
    if len(names) == 1:
        return {names[0]: ""}
    found = {name: "/" + _ODD.sub("_", name).strip("_") for name in names}
    if len(set(found.values())) < len(names):
        raise WrongUse(
            "two of these robots would have the same topics",
            "give them names, as in: kickctl robots add anna tcp://192.168.1.7",
        )
    return found


def parameter(prefix: str, name: str) -> str:
    """The name of a robot's parameter: k, or anna.k with several robots."""
    return f"{prefix[1:]}.{name}" if prefix else name


def split_parameter(text: str, robots: Sequence[str]) -> tuple[str, str] | None:
    """The prefix and the name of a parameter; None if no robot has this prefix."""
    if "" in robots:
        return "", text
    robot, _, name = text.partition(".")
    return (f"/{robot}", name) if f"/{robot}" in robots else None
