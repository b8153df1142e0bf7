"""A log that the lab records of one of its robots, into the folder logs/."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from host.logs.tap import Event
from robot.record import Record


class Recording:
    """A tap that writes a log. A disk that fails ends the log, never the lab.

    Args:
        info: What the log says of its origin, as in Log.
        say: Gets what has gone wrong in words: a message and a hint.

    Attributes:
        path: The log's file.
        whole: Whether it has its end, and all before it.
        failed: Whether it ends early, since it could not be written.

    Raises:
        LogError: The file cannot be created.
        OSError: The disk is full.
    """

    def __init__(self, info: dict[str, Any], say: Callable[[str, str], None]) -> None:
        # What writes files is only imported by who does.
        from host.logs.log_folder import in_folder
        from host.logs.mcap_files import McapTap

        self._file = in_folder("lab", info, lambda path: McapTap(path, info))
        # The folder in which the program works may change.
        self.path: Path = self._file.path.absolute()
        self.whole = False
        self.failed = False
        self._say = say

    @property
    def name(self) -> str:
        """The file's name."""
        return self.path.name

    def ending(self) -> dict[str, bool]:
        """How it ends, as pages hear it: {whole, failed}."""
        return {"whole": self.whole, "failed": self.failed}

    def take_records(self, records: list[Record]) -> None:
        """Write records."""
        self._try(lambda: self._file.take_records(records))

    def take_event(self, event: Event) -> None:
        """Write an event."""
        self._try(lambda: self._file.take_event(event))

    def close(self) -> None:
        """End the log."""
        if self.failed:
            with suppress(OSError):  # has been said already
                self._file.close()
        self._try(self._file.close)
        self.whole = not self.failed

    def _try(self, write: Callable[[], None]) -> None:
        if self.failed:
            return
        try:
            write()
        except OSError as error:
            self.failed = True
            self._say(
                f"the log {self.name} ends here, since it cannot be written: {error.strerror}",
                "is the disk full? The robot goes on",
            )


class Recorded(Protocol):
    """A robot with the logs that the lab has recorded of it, by the names of their files."""

    @property
    def name(self) -> str:
        """What people call the robot."""

    @property
    def logs(self) -> Mapping[str, Recording]:
        """Its logs."""


def describe_logs(robots: Iterable[Recorded]) -> list[dict[str, Any]]:
    """The logs of robots as plain data, for pages."""
    return [
        {"name": name, "robot": robot.name} | recording.ending()
        for robot in robots
        for name, recording in robot.logs.items()
    ]


def find_log(robots: Iterable[Recorded], name: str) -> Path | None:
    """The file of a log; None if there is none of this name."""
    for robot in robots:
        if name in robot.logs:
            return robot.logs[name].path
    return None
