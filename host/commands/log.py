"""kickctl log list|pull|export|replay."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from host.commands._options import common
from host.commands._terminal import answer, robot_of, say, show
from host.errors import WrongUse

if TYPE_CHECKING:
    from host.logs.replay import ReplayResult

HELP = "logs: list them, pull the robot's black box, export, replay"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """One action, and what it needs."""
    parents = [common(defaults=False)]
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    listing = actions.add_parser("list", parents=parents, help="the logs in a folder")
    listing.add_argument("folder", nargs="?", type=Path, help="default: logs/ here")
    pull = actions.add_parser(
        "pull", parents=parents, help="fetch the last minutes from the robot's black box"
    )
    pull.add_argument(
        "--out", type=Path, metavar="FILE", help="the log to write (default: a new one under logs/)"
    )
    export = actions.add_parser("export", parents=parents, help="a log as a table")
    export.add_argument("log", type=Path)
    export.add_argument("--format", choices=("csv", "npz"), default="csv")
    export.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="where to (default: csv to standard output, npz beside the log)",
    )
    replay = actions.add_parser(
        "replay",
        parents=parents,
        help="feed a log's angles and delta t to the controller again and compare every bit",
    )
    replay.add_argument("log", type=Path)


def run(options: argparse.Namespace) -> int:
    """Run the action."""
    return {"list": _list, "pull": _pull, "export": _export, "replay": _replay}[options.action](
        options
    )


def _list(options: argparse.Namespace) -> int:
    from host.logs.mcap_files import LOG_FOLDER, list_logs

    folder = options.folder or LOG_FOLDER
    if not folder.is_dir():
        if options.folder is not None:
            raise WrongUse(f"there is no folder {folder}", "name the folder that the logs are in")
        rows = []
    else:
        rows = list_logs(folder)
    if options.json:
        show([{**row._asdict(), "path": str(row.path)} for row in rows])
        return 0
    for row in rows:
        print(
            f"{row.path}  {row.ticks} ticks  {row.seconds:.1f} s  {row.brick} "
            f" {row.started_utc[:19]}  {row.note}".rstrip()
        )
    if not rows:
        say(f"no logs in {folder}; `kickctl record 10` makes one")
    return 0


def _pull(options: argparse.Namespace) -> int:
    from host.logs.log import Log
    from host.logs.mcap_files import new_path

    with robot_of(options) as robot:
        log = Log(robot.info())
        robot.pull(log)
    path = log.save(options.out or new_path("pull"))
    answer(
        options,
        {"log": str(path), "ticks": len(log)},
        f"{len(log)} ticks, {log.seconds:.1f} s, in {path}",
    )
    return 0


def _export(options: argparse.Namespace) -> int:
    import sys

    from host.logs.log import Log
    from host.logs.tables import write_csv

    log = Log.load(options.log)
    if log.info.get("truncated"):
        say(f"{options.log} breaks off; the table has what is there")
    if options.format == "csv" and options.out is None and not options.json:
        write_csv(log.arrays(), sys.stdout)
        return 0
    out = options.out or options.log.with_suffix("." + options.format)
    try:
        path = log.to_csv(out) if options.format == "csv" else log.to_npz(out)
    except OSError as error:
        raise WrongUse(
            f"{out} cannot be written: {error.strerror}", "choose another place with --out"
        ) from error
    answer(options, {"table": str(path), "ticks": len(log)}, f"{len(log)} ticks in {path}")
    return 0


def _replay(options: argparse.Namespace) -> int:
    from host.logs.log import Log
    from host.logs.replay import replay

    log = Log.load(options.log)
    result = replay(log)
    truncated = bool(log.info.get("truncated"))
    missing = sum(end - first for first, end in log.missing())
    facts = {
        "reproduced": result.reproduced,
        "exact": result.exact,
        "compared": result.compared,
        "not_comparable": result.not_comparable,
        "missing": missing,
        "truncated": truncated,
        "worst": result.worst,
        "first_mismatch": None if result.first is None else str(result.first),
    }
    sentence = (
        f"{result.compared} ticks replayed: {_verdict(result)} ({result.not_comparable} not"
        f" comparable, {missing} missing)"
    )
    answer(
        options,
        facts,
        sentence + ("; the file is damaged or breaks off after them" if truncated else ""),
    )
    return 0 if result.reproduced and not truncated else 1


def _verdict(result: ReplayResult) -> str:
    if not result.compared:
        return "nothing to compare"
    if result.exact:
        return "bit for bit the same"
    return f"within {result.tolerance:g}" if result.reproduced else f"NOT the same: {result.beyond}"
