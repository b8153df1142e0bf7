"""Keeps what a body does while it runs, in files and in little memory however long it runs."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from host.bodies.files import CsvStates, McapStates
from host.util.interrupts import uninterrupted
from host.util.whole_files import whole_file

if TYPE_CHECKING:
    from sim_motor.bodies.body import Body
    from sim_motor.bodies.measures import Summary

Array = NDArray[np.float64]

# How many states a body keeps until they are written, and how many are at most kept for a figure.
BLOCK, FIGURE_ROWS = 500, 20000


class Keeper:
    """Writes a body's states to files, and sums them up.

    Args:
        folder: Where the files go. They appear when they are whole, at the end.
        body: The body, at its start; it keeps at least BLOCK states.
        info: Plain data about the run.

    Attributes:
        columns: Names of the columns.
        failures: Why files could not be written, by their names.
    """

    def __init__(self, folder: Path, body: Body, info: dict[str, Any]) -> None:
        from sim_motor.bodies.running_summary import RunningSummary

        self.columns = body.columns
        self._body = body
        self._latest_s = -1.0
        self._waiting = 1  # states that the body noted, and that were not taken; its start is one
        self._summary = RunningSummary(self.columns)
        self._thin = ThinRows()
        self._files = [
            _File(folder / "state.csv", partial(CsvStates, columns=self.columns)),
            _File(folder / "state.mcap", partial(McapStates, columns=self.columns, info=info)),
        ]

    def note(self) -> None:
        """The body has noted a state."""
        self._waiting += 1
        if self._waiting >= BLOCK:
            with uninterrupted():
                self._take()

    def finish(self) -> None:
        """Take the last states, and end the files."""
        with uninterrupted():
            self._take()
            for file in self._files:
                file.finish()

    def drop(self) -> None:
        """Write nothing: the files that were there stay as they are."""
        for file in self._files:
            file.drop()

    @property
    def failures(self) -> dict[str, OSError]:
        """Why files could not be written, by their names."""
        return {file.path.name: file.failure for file in self._files if file.failure}

    def summary(self) -> Summary:
        """The summary of all states."""
        return self._summary.summary()

    def rows(self) -> Array:
        """States for a figure, (times, columns): of a long run not all, see ThinRows."""
        return self._thin.rows()

    def _take(self) -> None:
        rows = self._body.rows
        rows = rows[rows[:, 0] > self._latest_s]
        self._waiting = 0
        if not len(rows):
            return
        self._latest_s = float(rows[-1, 0])
        self._summary.add(rows)
        self._thin.add(rows)
        for file in self._files:
            file.add(rows)


class ThinRows:
    """Rows that are evenly apart, at most FIGURE_ROWS of them, and the last."""

    def __init__(self) -> None:
        self._kept: list[Array] = []
        self._every = 1
        self._count = 0
        self._last: Array | None = None

    def add(self, rows: Array) -> None:
        """Take the next rows, (rows, columns)."""
        for row in rows:
            if self._count % self._every == 0:
                if len(self._kept) == FIGURE_ROWS:
                    self._kept, self._every = self._kept[::2], 2 * self._every
                if self._count % self._every == 0:
                    self._kept.append(row.copy())
            self._count += 1
        self._last = rows[-1].copy()

    def rows(self) -> Array:
        """The rows, (rows, columns)."""
        last = self._last if (self._count - 1) % self._every else None
        return np.array(self._kept if last is None else [*self._kept, last])


class _File:
    """A file of states that may fail: then the body goes on without it."""

    def __init__(self, path: Path, begin: Callable[[Path], CsvStates | McapStates]) -> None:
        self.path = path
        self.failure: OSError | None = None
        self._states: CsvStates | McapStates | None = None
        self._draft: AbstractContextManager[Path] = whole_file(path)
        self._try(lambda: self._begin(begin))

    def _begin(self, begin: Callable[[Path], CsvStates | McapStates]) -> None:
        self._states = begin(self._draft.__enter__())

    def add(self, rows: Array) -> None:
        if self._states is not None:
            self._try(partial(self._states.add, rows))

    def finish(self) -> None:
        if self._states is not None and self.failure is None:
            self._try(self._states.finish)
        if self.failure is None:
            self._try(lambda: self._draft.__exit__(None, None, None))

    def _try(self, work: Callable[[], object]) -> None:
        if self.failure is not None:
            return
        try:
            work()
        except OSError as error:
            self.failure = error
            self._remove_draft(error)

    def drop(self) -> None:
        if self.failure is None:
            self._remove_draft(OSError())

    def _remove_draft(self, error: OSError) -> None:
        """Remove the draft; this also has the error name the file."""
        with suppress(OSError):
            if self._states is not None:
                self._states.finish()
        with suppress(OSError):
            self._draft.__exit__(OSError, error, error.__traceback__)
