"""What is missing from a log that was read, for people and in JSON."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

from host.commands._terminal import say

if TYPE_CHECKING:
    from host.logs.mcap_reading import LogFile


def damage_facts(log: LogFile) -> dict[str, Any]:
    """The same for every verb that reads a log, when it has been read."""
    return {"truncated": not log.whole, "damage": log.damage()}


def damage_status(log: LogFile) -> int:
    """Say what is missing, and what to do.

    Returns:
        The exit status: 0 if the log is whole; 1 if it is not, so that not all was done.
    """
    if log.whole:
        return 0
    say(
        f"kickctl: {log.damage()}\n  kickctl log recover {shlex.quote(str(log.path))} makes a whole"
        " log of what can be read"
    )
    return 1
