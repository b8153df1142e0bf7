"""kickctl log list|pull|export|replay|recover."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from host.commands._options import common
from host.commands._terminal import answer, robot_of, say, show
from host.errors import WrongUse

if TYPE_CHECKING:
    from host.logs.mcap_reading import LogFile
    from host.logs.replay import ReplayResult

HELP = "list, export, replay and recover logs, or pull one from the robot's black box"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions, each with its own arguments."""
    parents = [common(defaults=False)]
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    listing = actions.add_parser("list", parents=parents, help="list the logs in a folder")
    listing.add_argument("folder", nargs="?", type=Path, help="the folder (default: logs/ here)")
    pull = actions.add_parser(
        "pull", parents=parents, help="fetch the last minutes from the robot's black box"
    )
    pull.add_argument(
        "--out", type=Path, metavar="FILE", help="the log to write (default: a new one under logs/)"
    )
    export = actions.add_parser("export", parents=parents, help="write a log as a table")
    export.add_argument("log", type=Path, help="the log, an MCAP file")
    export.add_argument(
        "--format",
        choices=("csv", "npz"),
        default="csv",
        help="csv for spreadsheets, npz for numpy (default %(default)s)",
    )
    export.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="the table to write (default: csv to standard output, npz beside the log)",
    )
    replay = actions.add_parser(
        "replay",
        parents=parents,
        help="recompute the controller from a log's angles and delta t, and compare exactly",
    )
    replay.add_argument("log", type=Path, help="the log, an MCAP file")
    recovery = actions.add_parser(
        "recover",
        parents=parents,
        help="write what can be read of a log that breaks off to a new log, which viewers open",
    )
    recovery.add_argument("log", type=Path, help="the log, an MCAP file; it is not changed")
    recovery.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="the log to write (default: NAME-recovered.mcap beside it)",
    )


def run(options: argparse.Namespace) -> int:
    """Run the action. `replay` returns 1 if the controller computes something else."""
    actions = {
        "list": _list,
        "pull": _pull,
        "export": _export,
        "replay": _replay,
        "recover": _recover,
    }
    return actions[options.action](options)


def _list(options: argparse.Namespace) -> int:
    from host.logs.log_folder import LOG_FOLDER, list_logs

    folder = options.folder or LOG_FOLDER
    if not folder.is_dir():
        if options.folder is not None:
            raise WrongUse(f"there is no folder {folder}", "name the folder with the logs")
        rows = []
    else:
        rows = list_logs(folder)
    if options.json:
        show({"logs": [{**row._asdict(), "path": str(row.path)} for row in rows]})
        return 0
    for row in rows:
        print(
            f"{row.path}  {row.ticks} ticks  {row.seconds:.1f} s  {row.brick} "
            f" {row.started_utc[:19]}  {row.note}".rstrip()
        )
    if not rows:
        say(f"no logs in {folder}; `kickctl record 10` writes one")
    return 0


def _pull(options: argparse.Namespace) -> int:
    from host.logs.log import Log
    from host.logs.log_folder import in_folder

    with robot_of(options) as robot:
        log = Log(robot.info())
        robot.pull(log)
    path = log.save(options.out) if options.out else in_folder("pull", log.save)
    answer(
        options,
        {"log": str(path), "ticks": len(log)},
        f"{len(log)} ticks, {log.seconds:.1f} s, in {path}",
    )
    return 0


def _export(options: argparse.Namespace) -> int:
    import sys

    from host.logs.mcap_reading import LogFile
    from host.logs.tables import save_csv, save_npz, write_csv

    log = LogFile(options.log)
    if options.format == "csv" and options.out is None and not options.json:
        write_csv(log.stream(), sys.stdout)
        _say_if_cut(log)
        return 0
    out = options.out or options.log.with_suffix("." + options.format)
    try:
        ticks = (
            save_csv(log.stream(), out)
            if options.format == "csv"
            else save_npz(log.stream(), log.info, out)
        )
    except OSError as error:
        raise WrongUse(
            f"{out} cannot be written: {error.strerror}", "choose another place with --out"
        ) from error
    _say_if_cut(log)
    answer(options, {"table": str(out), "ticks": ticks}, f"{ticks} ticks in {out}")
    return 0


def _say_if_cut(log: LogFile) -> None:
    if not log.whole:
        say(f"{log.path} breaks off; the table has the ticks until then")


def _replay(options: argparse.Namespace) -> int:
    from host.logs.mcap_reading import LogFile
    from host.logs.replay import replay

    log = LogFile(options.log)
    result = replay(log)
    facts = {
        "reproduced": result.reproduced,
        "exact": result.exact,
        "compared": result.compared,
        "not_comparable": result.not_comparable,
        "missing": result.missing,
        "truncated": not log.whole,
        "worst": result.worst,
        "first_mismatch": None if result.first is None else str(result.first),
    }
    sentence = (
        f"{result.compared} ticks replayed: {_verdict(result)} ({result.not_comparable} not"
        f" comparable, {result.missing} missing)"
    )
    if not log.whole:
        sentence += (
            "; the file is damaged or breaks off after them"
            f" (kickctl log recover {shlex.quote(str(log.path))})"
        )
    answer(options, facts, sentence)
    return 0 if result.reproduced and log.whole else 1


def _recover(options: argparse.Namespace) -> int:
    from host.logs.log_folder import recover

    path, ticks, whole = recover(options.log, options.out)
    state = "was whole" if whole else "breaks off or is damaged after them"
    answer(
        options,
        {"log": str(path), "ticks": ticks, "from": str(options.log), "was_whole": whole},
        f"{ticks} ticks of {options.log}, which {state}, are in {path}",
    )
    return 0


def _verdict(result: ReplayResult) -> str:
    if not result.compared:
        return "nothing to compare"
    if result.exact:
        return "bit for bit the same"
    return f"within {result.tolerance:g}" if result.reproduced else f"NOT the same: {result.beyond}"
