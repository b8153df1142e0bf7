"""An experiment's results in a folder, kept cell by cell, so that a run that was cut short goes on where it was."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from host.errors import WrongUse
from host.experiments.experiment import Cell, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SETTINGS, _CELLS = "settings.json", "cells.jsonl"


class Done(NamedTuple):
    """What came of a cell: its rows, and why earlier tries of it did not count."""

    rows: list[Row]
    spoiled: list[str]


class Study:
    """The folder of one run, made if it is not there.

    settings: plain data; a folder with other settings is another run's. Raises WrongUse then.
    """

    def __init__(self, folder: Path, settings: dict[str, Any]) -> None:
        self.folder = folder
        self._done: dict[str, Done] = {}
        folder.mkdir(parents=True, exist_ok=True)
        own = folder / _SETTINGS
        if not own.exists():
            own.write_text(json.dumps(settings, indent=1) + "\n", encoding="utf-8")
        elif json.loads(own.read_text(encoding="utf-8")) != settings:
            raise WrongUse(f"{folder} holds the results of another run (see {own})", "name another folder with --out")
        self._read()

    def _read(self) -> None:
        """Take in what was kept; a last line that was cut short was not."""
        journal = self.folder / _CELLS
        whole = 0
        if journal.exists():
            for line in journal.read_bytes().splitlines(keepends=True):
                if not line.endswith(b"\n"):
                    break
                entry = json.loads(line)
                self._done[_key(entry["cell"])] = Done(entry["rows"], entry["spoiled"])
                whole += len(line)
        self._journal = journal.open("ab")
        self._journal.truncate(whole)

    def __contains__(self, cell: Cell) -> bool:
        return _key(cell) in self._done

    def __len__(self) -> int:
        return len(self._done)

    def keep(self, cell: Cell, rows: list[Row], spoiled: list[str]) -> None:
        """Keep what came of a cell, on disk before this returns."""
        line = json.dumps({"cell": cell, "rows": rows, "spoiled": spoiled}, allow_nan=False)
        self._journal.write(line.encode() + b"\n")
        self._journal.flush()
        os.fsync(self._journal.fileno())
        self._done[_key(cell)] = Done(json.loads(line)["rows"], spoiled)

    def close(self) -> None:
        """Keep no more."""
        self._journal.close()

    def rows(self, cells: list[Cell]) -> list[Row]:
        """The rows of these cells in their order, each with its cell's fields."""
        return [{**cell, **row} for cell in cells for row in self._done[_key(cell)].rows]

    def spoiled(self) -> list[str]:
        """Why tries did not count."""
        return [reason for done in self._done.values() for reason in done.spoiled]

    def write_table(self, name: str, rows: list[Row]) -> Path:
        """The rows as CSV, one line each."""
        path = self.folder / f"{name}.csv"
        columns = list(dict.fromkeys(column for row in rows for column in row))
        with path.open("w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, columns)
            writer.writeheader()
            writer.writerows(rows)
        return path

    def write_figure(self, name: str, figure: Figure) -> list[Path]:
        """A figure as PNG and SVG."""
        paths = [self.folder / f"{name}.{kind}" for kind in ("png", "svg")]
        for path in paths:
            figure.savefig(path)
        return paths

    def write(self, name: str, text: str) -> Path:
        """A text as a file."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path


def _key(cell: Cell) -> str:
    return json.dumps(cell, sort_keys=True)
