"""The results of a run in a folder, cell by cell, so that an interrupted run can be resumed."""

from __future__ import annotations

import csv
import fcntl
import hashlib
import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from host.errors import WrongUse
from host.runs.columns import Kind
from host.runs.contract import Cell, Part, Row
from host.util.whole_files import DRAFT, whole_file, write_text

_CELLS = "cells.jsonl"


class Done(NamedTuple):
    """The result of a cell: its rows, and why earlier tries of it did not count."""

    rows: list[Row]
    spoiled: list[str]


class Study:
    """The folder of a run below `results`, created if it does not exist.

    Its name is the experiment's with a digest of all settings. These are plain data, and the
    fingerprint of the sources is one of them: a run of other code has a folder of its own.

    Args:
        results: The folder below which the run's folder lies.
        settings: All that the results depend on; "experiment" is the name.

    Raises:
        WrongUse: The folder cannot be used.
    """

    def __init__(self, results: Path, settings: dict[str, Any]) -> None:
        self.folder = folder = results / f"{settings['experiment']}-{digest(settings)}"
        self._done: dict[str, Done] = {}
        self._begun: dict[str, Part] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._journal = (folder / _CELLS).open("a+b")
        except OSError as error:
            raise WrongUse(
                f"{folder} cannot hold results: {error.strerror}",
                "name a folder with --out that you may write to",
            ) from error
        try:
            fcntl.flock(self._journal, fcntl.LOCK_EX | fcntl.LOCK_NB)
            for draft in folder.glob(f"{DRAFT}*"):  # of a run that was killed while it wrote
                with suppress(OSError):
                    draft.unlink()
            self.write("settings.json", json.dumps(settings, indent=1, allow_nan=False) + "\n")
            self._read()
        except BlockingIOError:
            self.close()
            raise WrongUse(
                f"another run works in {folder} now",
                "wait until it ends, or name another folder with --out",
            ) from None
        except (WrongUse, OSError):
            self.close()
            raise

    def _read(self) -> None:
        """Read the cells that are complete. A last line that was cut short does not count."""
        self._journal.seek(0)
        whole = 0
        for line in self._journal:
            if not line.endswith(b"\n"):
                break
            try:
                entry = json.loads(line)
                if "part" in entry:
                    self._add(entry["cell"], Part(**entry["part"]))
                else:
                    self._end(entry["cell"], Done(entry["rows"], entry["spoiled"]))
            except (ValueError, KeyError, TypeError) as error:
                raise WrongUse(
                    f"{self.folder / _CELLS} is damaged",
                    "name another folder with --out, or delete this one",
                ) from error
            whole += len(line)
        self._journal.truncate(whole)

    def __contains__(self, cell: Cell) -> bool:
        return _key(cell) in self._done

    def __len__(self) -> int:
        return len(self._done)

    @property
    def complete(self) -> float:
        """How many cells are complete, with the shares of those that have begun."""
        return len(self._done) + sum(part.share for part in self._begun.values())

    def keep(self, cell: Cell, rows: list[Row], spoiled: list[str]) -> None:
        """Keep the result of a cell. It is on disk before this returns."""
        kept = self._append({"cell": cell, "rows": rows, "spoiled": spoiled})
        self._end(cell, Done(kept["rows"], spoiled))

    def keep_part(self, cell: Cell, part: Part) -> None:
        """Keep a part of a cell, but for the last. It is on disk before this returns."""
        kept = self._append({"cell": cell, "part": part._asdict()})
        self._add(cell, Part(**kept["part"]))

    def begun(self, cell: Cell) -> Part | None:
        """All complete parts of a cell that has begun, as one part; None for another cell."""
        return self._begun.get(_key(cell))

    def _end(self, cell: Cell, done: Done) -> None:
        self._done[_key(cell)] = done
        self._begun.pop(_key(cell), None)

    def _add(self, cell: Cell, part: Part) -> None:
        before = self.begun(cell)
        self._begun[_key(cell)] = part._replace(rows=[*(before.rows if before else ()), *part.rows])

    def _append(self, entry: dict[str, Any]) -> dict[str, Any]:
        """Add a line to the journal. Returns the entry as it will be read."""
        line = json.dumps(entry, allow_nan=False)
        self._journal.write(line.encode() + b"\n")
        self._journal.flush()
        os.fsync(self._journal.fileno())
        kept: dict[str, Any] = json.loads(line)
        return kept

    def close(self) -> None:
        """Close the folder for others to use."""
        self._journal.close()

    def rows(self, cells: list[Cell]) -> list[Row]:
        """The rows of these cells, in this order, each with the fields of its cell."""
        return [{**cell, **row} for cell in cells for row in self._done[_key(cell)].rows]

    def spoiled(self) -> list[str]:
        """The reasons why some tries did not count."""
        return [reason for done in self._done.values() for reason in done.spoiled]

    def write_table(self, name: str, rows: list[Row], kind: Kind | None = None) -> Path:
        """Write rows as CSV, one line each.

        Args:
            name: The file's name, without its ending.
            rows: The rows.
            kind: What they are; it says the order of columns, else the rows do.
        """
        path = self.folder / f"{name}.csv"
        columns = list(dict.fromkeys(column for row in rows for column in row))
        if kind is not None:
            columns = [column.name for column in kind.columns if column.name in columns]
        with whole_file(path) as draft, draft.open("w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, columns)
            writer.writeheader()
            writer.writerows(rows)
        return path

    def write(self, name: str, text: str) -> Path:
        """Write a text to a file of this name."""
        path = self.folder / name
        write_text(path, text)
        return path


def digest(data: dict[str, Any]) -> str:
    """Eight hexadecimal digits that stand for plain data."""
    return hashlib.sha256(_key(data).encode()).hexdigest()[:8]


def _key(cell: Cell) -> str:
    return json.dumps(cell, allow_nan=False, sort_keys=True)
