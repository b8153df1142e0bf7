"""Does the cells of a run, keeps the result of each, and writes table, figure and summary."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from host.errors import FigureInterrupted, KickctlError, mark_kept
from host.runs.answers import as_data
from host.runs.contract import Cell, Findings, Row, Setting
from host.runs.folder import Study
from host.util.progress import progress

T = TypeVar("T")
# The rows of a cell, and why earlier tries of it did not count.
Outcome = tuple[list[Row], list[str]]
Result = tuple[Cell, list[Row], list[str]]
Work = Callable[[Cell], Outcome]
# Draws the figure of rows and findings, and writes it to STEM.png and STEM.svg. Returns the paths.
Draw = Callable[[list[Row], Findings, Path], list[Path]]


@contextmanager
def open_study(
    results: Path, settings: dict[str, Any], cells: list[Cell], say: Callable[[str], None]
) -> Iterator[Study]:
    """Yields the study of a run.

    Says how many cells are complete, at first and if the run ends early.
    """
    study = Study(results, settings)
    name = settings["experiment"]
    say(
        f"{name}: {sum(cell in study for cell in cells)} of {len(cells)} cells complete in"
        f" {study.folder}"
    )
    try:
        yield study
    except (KickctlError, KeyboardInterrupt, OSError) as error:
        mark_kept(error, study.folder)
        say(
            f"{sum(cell in study for cell in cells)} of {len(cells)} cells complete in"
            f" {study.folder}; the same command resumes the run"
        )
        raise
    finally:
        study.close()


def do_cells(name: str, cells: list[Cell], study: Study, work: Work) -> None:
    """Do the cells that are not complete yet, one after the other."""
    missing = [cell for cell in cells if cell not in study]
    _keep(
        ((cell, *work(cell)) for cell in missing),
        len(cells) - len(missing),
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
        processes: Whether to use a process for each core of this machine.
    """
    missing = [cell for cell in cells if cell not in study]
    if scheduler is not None:
        from host.runs.cluster import compute_on_cluster

        done = compute_on_cluster(scheduler, function, missing, setting)
    elif processes:
        from host.runs.processes import compute_in_processes

        done = compute_in_processes(function, missing, setting)
    else:
        done = ((cell, function(cell, setting)) for cell in missing)
    with closing(done):
        _keep(
            ((cell, rows, []) for cell, rows in done),
            len(cells) - len(missing),
            len(cells),
            study,
            name,
        )


def _keep(results: Iterable[Result], done: int, total: int, study: Study, name: str) -> None:
    with progress(name, total) as advance:
        advance(done)
        for cell, rows, spoiled in results:
            study.keep(cell, rows, spoiled)
            done += 1
            advance(done)


def finish(
    name: str,
    rows: list[Row],
    findings: Findings,
    draw: Draw,
    study: Study,
    about: dict[str, Any],
) -> dict[str, Any]:
    """Write the table, the figure and the summary, as far as disk and matplotlib allow.

    Args:
        name: The run's name.
        rows: All rows.
        findings: What they come to.
        draw: Draws the figure.
        study: The run's folder.
        about: The run's settings.

    Returns:
        The summary. Under "unwritten" it says which files are missing, and why.

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
        except Exception as error:  # noqa: BLE001 - drawing may fail in any way
            unwritten[file] = f"{file} failed with {type(error).__name__}: {error}"
        return otherwise

    logs = study.folder / "logs"
    texts = findings.files.items()
    kept = [attempt(file, partial(study.write, file, text), None) for file, text in texts]
    table = attempt("table", lambda: study.write_table(name, rows), None)
    none: list[Path] = []
    interrupted = False
    figures = none
    try:
        figures = attempt("figure", lambda: draw(rows, findings, study.folder / name), none)
    except KeyboardInterrupt:
        interrupted = True
        unwritten["figure"] = "figure: interrupted while it was drawn"
    path = study.folder / "summary.json"
    summary = {
        **about,
        "claims": [claim.as_dict() for claim in findings.claims],
        "answers": as_data(findings.answers),
        "numbers": findings.numbers,
        "trials": len(rows),
        "spoiled": study.spoiled(),
        "folder": str(study.folder),
        "table": table and str(table),
        "figures": [str(path) for path in figures],
        "files": [str(path) for path in kept if path],
        "logs": str(logs) if logs.exists() else None,
        "summary": str(path),
        "unwritten": unwritten,
    }
    text = json.dumps(summary, indent=1, allow_nan=False) + "\n"
    if attempt("summary", lambda: study.write(path.name, text), None) is None:
        summary["summary"] = None
    if interrupted:
        raise FigureInterrupted(summary)
    return summary
