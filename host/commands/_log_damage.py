"""What is missing from a log that was read, for people and in JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from host.errors import NotDone

if TYPE_CHECKING:
    from host.logs.mcap_reading import LogFile


def damage_facts(log: LogFile) -> dict[str, Any]:
    """The same for every verb that reads a log, when it has been read."""
    return {"truncated": not log.whole, "damage": log.damage(), "lost": log.lost}


def damage_status(log: LogFile) -> int:
    """The exit status of what was done with a log: 0 if it is whole.

    Raises:
        NotDone: It is not whole, so that not all was done.
    """
    if not log.whole:
        raise NotDone(
            log.damage(),
            log.remedy(),
        )
    return 0
