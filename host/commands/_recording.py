"""How verbs record what they do, and answer: no figure and no disk that fails swallows a result."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.commands._failures import os_words
from host.commands._terminal import print_result, say, show
from host.errors import KickctlError, NotDone, mark_kept

if TYPE_CHECKING:
    from host.client.robot import Robot
    from host.logs.log import Log
    from host.logs.mcap_files import McapTap
    from host.logs.tap import Event
    from robot.record import Record


class Recording:
    """A log in memory, and its file, which grows with it.

    The disk may fail: the log in memory goes on, and so does the robot.

    Attributes:
        log: The log.
        path: The file's path.
        failure: Why the file is not whole, in words; empty if it is.
    """

    def __init__(self, log: Log, file: McapTap) -> None:
        self.log = log
        self.path = file.path
        self.failure = ""
        self._file = file

    def take_records(self, records: list[Record]) -> None:
        """Keep records."""
        self.log.take_records(records)
        self._try(lambda: self._file.take_records(records))

    def take_event(self, event: Event) -> None:
        """Keep an event."""
        self.log.take_event(event)
        self._try(lambda: self._file.take_event(event))

    def rename(self, what: str, instead: str) -> None:
        """Say something else in the file's name; it keeps its name where that is not possible."""
        from host.logs.log_folder import rename_log

        self.path = rename_log(self.path, instead.join(self.path.name.rsplit(what, 1)))

    def close(self) -> None:
        """Close the file."""
        try:
            self._file.close()
        except OSError as error:
            self.failure = self.failure or os_words(error)

    def require_whole(self) -> None:
        """Raise NotDone if the file is not whole."""
        if self.failure:
            raise NotDone(self.failure, f"the log {self.path} ends where that happened")

    def _try(self, write: Callable[[], None]) -> None:
        if self.failure:
            return
        try:
            write()
        except OSError as error:
            self.failure = os_words(error)
            say(f"{self.failure}; the log ends here, and the robot goes on")


@contextmanager
def recorded(robot: Robot, what: str, *, of_kick: bool = False) -> Iterator[Recording]:
    """Record all that the robot does meanwhile, in memory and in a new file under logs/.

    Args:
        robot: The robot.
        what: What is done, for the file's name.
        of_kick: Whether that is a kick. If it comes to none, the file is named no-kick-... instead.

    Yields:
        The recording.
    """
    from host.logs.log import Log
    from host.logs.log_folder import in_folder
    from host.logs.mcap_files import McapTap

    info = robot.info()
    try:
        file = in_folder(what, info, lambda path: McapTap(path, info))
    except (KickctlError, OSError) as error:
        error.add_note("no kick was sent")
        raise
    recording = Recording(Log(info), file)
    try:
        robot.add_tap(recording)
        yield recording
    except (KickctlError, KeyboardInterrupt) as error:
        if of_kick and not recording.log.kicks():
            recording.rename(what, f"no-{what}")
        error.add_note(f"what was recorded until then is in {recording.path}")
        mark_kept(error, recording.path)
        raise
    finally:
        robot.remove_tap(recording)
        recording.close()


def conclude(
    options: argparse.Namespace,
    result: dict[str, Any],
    sentence: str,
    recording: Recording,
    draw: Callable[[Path], Path],
) -> None:
    """Give the result of what was recorded, and draw its figure beside the log.

    Args:
        options: Say whether to answer in JSON. There, `figure` is null if it cannot be drawn, and
            `figure_error` says why; `log_error` says why a log is not whole.
        result: The answer, without its files.
        sentence: The same for people.
        recording: What was recorded.
        draw: Writes the figure to the path that it gets, and returns that. It may fail in any way.

    Raises:
        NotDone: The log's file is not whole.
    """
    files: dict[str, Any] = {"log": str(recording.path)}
    if recording.failure:
        files["log_error"] = recording.failure
    essentials = f"{sentence}\nlog {recording.path}"
    if options.json:  # for an interrupt while the figure is drawn
        show({**result, **files, "figure": None, "figure_error": "interrupted"}, essentials)
    else:
        print_result(essentials, essentials)
    try:
        files["figure"] = str(draw(recording.path.with_suffix(".png")))
    except Exception as error:  # noqa: BLE001 - the result counts, not what befalls a picture
        files |= {"figure": None, "figure_error": figure_words(error)}
        say(f"kickctl: {files['figure_error']}")
    if options.json:
        show({**result, **files}, essentials)
    elif files["figure"] is not None:
        print_result(f"figure {files['figure']}", f"figure {files['figure']}")
    recording.require_whole()


def figure_words(error: Exception) -> str:
    """Why there is no figure."""
    if isinstance(error, OSError):
        return f"no figure: {os_words(error)}"
    return f"no figure: matplotlib failed with {type(error).__name__}: {error}"
