"""Does the cells of a run, keeps the result of each, and writes table, figure and summary."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from host.errors import FigureInterrupted, KickctlError, mark_kept
from host.runs.answers import as_data
from host.runs.columns import Kind, by_kind
from host.runs.contract import Cell, Findings, Part, Parts, Row, Setting
from host.runs.folder import Study
from host.runs.results import Results
from host.util.progress import progress

T = TypeVar("T")
# The rows of a cell, and why earlier tries of it did not count.
Outcome = tuple[list[Row], list[str]]
Result = tuple[Cell, Part, list[str]]
Work = Callable[[Cell], Outcome]
# Draws the figure of rows and findings, and writes it to STEM.png and others. Returns the
# paths, and why they show all panels instead of the one that was wanted; else an empty text.
Draw = Callable[[list[Row], Findings, Path], tuple[list[Path], str]]


@contextmanager
def open_study(
    results: Path, settings: dict[str, Any], cells: list[Cell], say: Callable[[str], None]
) -> Iterator[Study]:
    """Yields the study of a run.

    Says how many cells are complete. If the run ends early, the error has that as a note: so it is
    part of the hint, in words and in JSON.
    """
    study = Study(results, settings)

    def complete() -> str:
        done = sum(cell in study for cell in cells)
        return f"{done} of {len(cells)} cells complete in {study.folder}"

    say(f"{settings['experiment']}: {complete()}")
    try:
        yield study
    except (KickctlError, KeyboardInterrupt, OSError) as error:
        mark_kept(error, study.folder)
        error.add_note(f"{complete()}; the same command resumes the run")
        raise
    finally:
        study.close()


def do_cells(name: str, cells: list[Cell], study: Study, work: Work) -> None:
    """Do the cells that are not complete yet, one after the other."""
    missing = [cell for cell in cells if cell not in study]
    _keep(
        ((cell, Part(rows), spoiled) for cell in missing for rows, spoiled in [work(cell)]),
        len(cells),
        study,
        name,
    )


def simulate(
    name: str,
    function: Callable[[Cell, Setting], list[Row]],
    cells: list[Cell],
    setting: Setting,
    study: Study,
    scheduler: str | None = None,
    *,
    parts: Parts | None = None,
    processes: bool = False,
) -> None:
    """Compute the cells that are not complete yet.

    Args:
        name: The name of the run, for its progress bar.
        function: Computes a cell.
        cells: All cells of the run.
        setting: What they share.
        study: Where their results are kept.
        scheduler: The address of a Dask scheduler; None to compute on this machine.
        parts: Computes a cell part by part, on this machine; None if its cells are short.
        processes: Whether to use a process for each core of this machine.
    """
    missing = [cell for cell in cells if cell not in study]
    parts = parts or partial(_in_one_part, function)
    done: Generator[tuple[Cell, Part]]
    if scheduler is not None:
        from host.runs.cluster import compute_on_cluster

        done = _whole(compute_on_cluster(scheduler, function, missing, setting))
    elif processes:
        from host.runs.processes import compute_in_processes

        done = compute_in_processes(parts, missing, setting, study.begun)
    else:
        done = (
            (cell, part) for cell in missing for part in parts(cell, setting, study.begun(cell))
        )
    with closing(done):
        _keep(((cell, part, []) for cell, part in done), len(cells), study, name)


def _in_one_part(
    function: Callable[[Cell, Setting], list[Row]], cell: Cell, setting: Setting, begun: Part | None
) -> Iterator[Part]:
    """A short cell, as Parts."""
    yield Part(function(cell, setting))


def _whole(results: Generator[tuple[Cell, list[Row]]]) -> Generator[tuple[Cell, Part]]:
    """Cells that are computed elsewhere, each in one part. Closing it closes `results`."""
    with closing(results):
        for cell, rows in results:
            yield cell, Part(rows)


def _keep(results: Iterable[Result], total: int, study: Study, name: str) -> None:
    with progress(name, total) as advance:
        advance(study.complete)
        for cell, part, spoiled in results:
            if part.share < 1.0:
                study.keep_part(cell, part)
            else:
                begun = study.begun(cell)
                study.keep(cell, [*(begun.rows if begun else ()), *part.rows], spoiled)
            advance(study.complete)


def finish(
    name: str,
    rows: list[Row],
    findings: Findings,
    draw: Draw,
    study: Study,
    about: dict[str, Any],
    kinds: list[Kind],
) -> Results:
    """Write the tables, the figure and the summary, as far as disk and matplotlib allow.

    Rows of several kinds have a table each, NAME-KIND.csv. columns.csv explains all columns.

    Args:
        name: The run's name.
        rows: All rows.
        findings: What they come to.
        draw: Draws the figure.
        study: The run's folder.
        about: The run's settings.
        kinds: The kinds of rows, from the data dictionary; none if it does not have them.

    Returns:
        The summary, with the rows. Under "unwritten" it says which files are missing, and why.

    Raises:
        FigureInterrupted: ^C came while the figure was drawn; all else is written.
    """
    unwritten: dict[str, str] = {}

    def attempt(file: str, write: Callable[[], T], otherwise: T) -> T:
        """What `write` returns; it may fail in any way, and the findings are still told."""
        try:
            return write()
        except OSError as error:
            unwritten[file] = f"{error.filename or file} cannot be written: {error.strerror}"
        except KickctlError as error:
            unwritten[file] = f"no {file}: {error.in_a_line}"
        except Exception as error:  # noqa: BLE001 - drawing may fail in any way
            unwritten[file] = f"{file} failed with {type(error).__name__}: {error}"
        return otherwise

    none: list[Path] = []
    logs = study.folder / "logs"
    texts = findings.files.items()
    kept = [attempt(file, partial(study.write, file, text), None) for file, text in texts]
    tables = attempt("table", lambda: _write_tables(name, rows, kinds, study), none)
    interrupted = False
    figures, other = none, ""
    try:
        figures, other = attempt(
            "figure", lambda: draw(rows, findings, study.folder / name), (none, "")
        )
    except KeyboardInterrupt:
        interrupted = True
        unwritten["figure"] = "figure: interrupted while it was drawn"
    if other:
        unwritten["panel"] = other
    path = study.folder / "summary.json"
    summary = Results(
        rows,
        kinds,
        {
            **about,
            "claims": [claim.as_dict() for claim in findings.claims],
            "answers": as_data(findings.answers),
            "numbers": findings.numbers,
            "trials": len(rows),
            "spoiled": study.spoiled(),
            "folder": str(study.folder),
            "tables": [str(path) for path in tables],
            "figures": [str(path) for path in figures],
            "files": [str(path) for path in kept if path],
            "logs": str(logs) if logs.exists() else None,
            "summary": str(path),
            "unwritten": unwritten,
        },
    )
    text = json.dumps(summary, indent=1, allow_nan=False) + "\n"
    if attempt("summary", lambda: study.write(path.name, text), None) is None:
        summary["summary"] = None
    if interrupted:
        raise FigureInterrupted(summary)
    return summary


def _write_tables(name: str, rows: list[Row], kinds: list[Kind], study: Study) -> list[Path]:
    """Write a table for each kind of rows, and one that explains their columns."""
    if not kinds:
        return [study.write_table(name, rows)]
    found = by_kind(rows, kinds)
    written = [
        study.write_table(f"{name}-{kind.name}" if len(kinds) > 1 else name, found[kind.name], kind)
        for kind in kinds
        if kind.name in found
    ]
    explained = [
        {"table": path.name, **column._asdict()}
        for path, kind in zip(written, (own for own in kinds if own.name in found), strict=True)
        for column in kind.columns
    ]
    study.write_table("columns", explained)
    return written
