"""Does the cells of a run one by one, keeps what comes of each, and puts it all together in the end."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.errors import KickctlError
from host.runs.contract import Cell, Findings, Row, Setting
from host.runs.folder import Study
from host.util.progress import progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Outcome = tuple[list[Row], list[str]]  # and why earlier tries did not count
Result = tuple[Cell, list[Row], list[str]]
Work = Callable[[Cell], Outcome]
Draw = Callable[[list[Row], Findings], "Figure"]


@contextmanager
def begun(
    results: Path, settings: dict[str, Any], cells: list[Cell], say: Callable[[str], None]
) -> Iterator[Study]:
    """Yields the study of a run, begun or gone on with, and says what is kept of it if it ends early."""
    study = Study(results, settings)
    name = settings["experiment"]
    say(
        f"{name}: {sum(cell in study for cell in cells)} of {len(cells)} pieces are done in"
        f" {study.folder}"
    )
    try:
        yield study
    except (KickctlError, KeyboardInterrupt, OSError):
        say(
            f"{len(study)} of {len(cells)} pieces are kept in {study.folder}; the same command goes"
            " on from there"
        )
        raise
    finally:
        study.close()


def do(name: str, cells: list[Cell], study: Study, work: Work) -> None:
    """Do those cells that the study does not have yet."""
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
    """Do them by computing, here or on the Dask cluster of the scheduler at this address.

    Processes: one for each core, if here.
    """
    missing = [cell for cell in cells if cell not in study]
    if scheduler is not None:
        from host.runs.cluster import spread

        done = spread(scheduler, function, missing, setting)
    elif processes:
        from host.runs.processes import side_by_side

        done = side_by_side(function, missing, setting)
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
    settings: dict[str, Any],
) -> dict[str, Any]:
    """Write the table, the figure that `draw` makes, and the summary, which is returned."""
    figures = study.write_figure(name, draw(rows, findings))
    logs = study.folder / "logs"
    summary = {
        **settings,
        "claims": [claim.as_dict() for claim in findings.claims],
        "numbers": findings.numbers,
        "trials": len(rows),
        "spoiled": study.spoiled(),
        "folder": str(study.folder),
        "table": str(study.write_table(name, rows)),
        "figures": [str(path) for path in figures],
        "files": [str(study.write(file, text)) for file, text in findings.files.items()],
        "logs": str(logs) if logs.exists() else None,
    }
    study.write("summary.json", json.dumps(summary, indent=1, allow_nan=False) + "\n")
    return summary
