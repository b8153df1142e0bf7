"""kickctl log list|pull|export|replay|plot|film|recover."""

from __future__ import annotations

import argparse
import shlex
import sys
from typing import TYPE_CHECKING, Any

from host.commands import _log_pictures
from host.commands._log_damage import damage_facts, damage_status
from host.commands._options import EVERY, common
from host.commands._outputs import add_force, answer_beside, require_place
from host.commands._terminal import answer, robot_of, say, show
from host.errors import NotDone, WrongUse
from host.util.paths import path_argument
from host.util.whole_files import descriptor_of, require_folder

if TYPE_CHECKING:
    from host.logs.replay import ReplayResult

HELP = "list, export, replay, plot, film and recover logs, or pull one from the robot's black box"
# As host.logs.tables has them; that is imported only when a table is written.
FORMATS = ("csv", "npz", "parquet")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions, each with its own arguments."""
    actions: Any = parser.add_subparsers(dest="action", metavar="ACTION", required=True)

    def action(name: str, words: str, used: tuple[str, ...] = ()) -> argparse.ArgumentParser:
        parents = [common(defaults=False, used=used)]
        own: argparse.ArgumentParser = actions.add_parser(
            name, parents=parents, help=words, description=words
        )
        return own

    def reader(name: str, words: str) -> argparse.ArgumentParser:
        own = action(name, words)
        own.add_argument("log", type=path_argument, help="the log, an MCAP file; it is not changed")
        own.epilog = (
            "The exit status is 1 if the log breaks off or is damaged: then this is done for what"
            " can be read."
        )
        return own

    listing = action("list", "list the logs in a folder")
    listing.add_argument(
        "folder", nargs="?", type=path_argument, help="the folder (default: logs/ here)"
    )
    pull = action("pull", "fetch the last minutes from the robot's black box", EVERY)
    pull.add_argument(
        "--out",
        type=path_argument,
        metavar="FILE",
        help="the log to write (default: a new one under logs/)",
    )
    export = reader("export", "write a log as a table")
    export.add_argument(
        "--format",
        choices=FORMATS,
        help="csv for spreadsheets, npz for numpy, parquet for pandas, polars, R and databases; it"
        " needs kickctl[parquet] (default: what the ending of --out says, or csv)",
    )
    export.add_argument(
        "--excel",
        action="store_true",
        help="csv with semicolons and decimal commas, as spreadsheets expect it in most of Europe",
    )
    export.add_argument(
        "--out",
        type=path_argument,
        metavar="FILE",
        help="the table to write (default: csv to standard output, others beside the log)",
    )
    add_force(export)
    reader("replay", "recompute the controller from a log's angles and delta t, compare exactly")
    _log_pictures.add_arguments(
        reader("plot", "draw a log: angles, potentials, duty cycles, kicks and stops"),
        reader("film", "film both wheels and their rods, turning as logged"),
    )
    recovery = action(
        "recover",
        "write what can be read of a log that breaks off or is damaged to a new log that viewers"
        " open",
    )
    recovery.epilog = "The exit status is 1 if ticks are known to be lost."
    recovery.add_argument(
        "log", type=path_argument, help="the log, an MCAP file; it is not changed"
    )
    recovery.add_argument(
        "--out",
        type=path_argument,
        metavar="FILE",
        help="the log to write (default: NAME-recovered.mcap beside it)",
    )


def run(options: argparse.Namespace) -> int:
    """Run the action. `replay` raises NotDone if the controller computes something else."""
    actions = {
        "list": _list,
        "pull": _pull,
        "export": _export,
        "replay": _replay,
        "plot": _log_pictures.plot,
        "film": _log_pictures.film,
        "recover": _recover,
    }
    return actions[options.action](options)


def _list(options: argparse.Namespace) -> int:
    from host.logs.log_folder import BREAKS_OFF, DAMAGED, LOG_FOLDER, list_logs

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
    cut = [row.path for row in rows if row.note == BREAKS_OFF]
    if cut:
        say(
            f"a log that breaks off is still being recorded, or was cut: kickctl log recover"
            f" {shlex.quote(str(cut[0]))}"
        )
    damaged = [row.path for row in rows if row.note.startswith(DAMAGED)]
    if damaged:
        say(
            "a damaged log is read up to the damage; what follows is read by: kickctl log recover"
            f" {shlex.quote(str(damaged[0]))}"
        )
    if not rows:
        say(f"no logs in {folder}; `kickctl record 10` writes one")
    return 0


def _pull(options: argparse.Namespace) -> int:
    from host.logs.log import Log
    from host.logs.log_folder import in_folder
    from host.logs.mcap_files import require_new_log

    if options.out is not None:
        require_new_log(options.out)
        require_folder(options.out)
    with robot_of(options) as robot:
        log = Log(robot.info())
        robot.pull(log)
    path = log.save(options.out) if options.out else in_folder("pull", log.info, log.save)
    answer(
        options,
        {"log": str(path), "ticks": len(log)},
        f"{len(log)} ticks, {log.seconds:.1f} s, in {path}",
    )
    return 0


def _export(options: argparse.Namespace) -> int:
    from host.logs.mcap_reading import LogFile
    from host.logs.parquet import save_parquet
    from host.logs.tables import format_of, save_csv, save_npz, write_csv

    log = LogFile(options.log)
    out = options.out
    form = options.format or "csv" if out is None else format_of(out, options.format)
    if options.excel and form != "csv":
        raise WrongUse(f"--excel is a kind of csv, and this is {form}", "leave one of them out")
    if out is None and form != "csv":
        out = options.log.with_suffix("." + form)
    if out is not None:
        require_place(options, out)
    elif options.json:
        raise WrongUse(
            "with --json the answer goes to standard output, so the table cannot",
            "name a file with --out",
        )
    if form == "csv" and (out is None or descriptor_of(out) == 1):
        write_csv(log.stream(), sys.stdout, excel=options.excel)
        return damage_status(log)
    new = not options.force
    if form == "csv":
        ticks = save_csv(log.stream(), out, new=new, excel=options.excel)
    elif form == "npz":
        ticks = save_npz(log.stream(), log.info, out, new=new)
    else:
        ticks = save_parquet(log.stream(), log.info, out, new=new)
    facts = {"table": str(out), "ticks": ticks, **damage_facts(log)}
    answer_beside(options, out, facts, f"{ticks} tick{'s' * (ticks != 1)} in {out}")
    return damage_status(log)


def _replay(options: argparse.Namespace) -> int:
    from host.logs.mcap_reading import LogFile
    from host.logs.replay import nothing_compared, other_sources, replay

    log = LogFile(options.log)
    others = other_sources(log.info)
    for words in others:
        say(words)
    result = replay(log)
    facts = {
        "reproduced": result.reproduced,
        "exact": result.exact,
        "compared": result.compared,
        "not_comparable": result.not_comparable,
        "why_not_comparable": result.why_behind_gaps,
        "missing": result.missing,
        **damage_facts(log),
        "other_sources": others,
        "worst": result.worst,
        "first_mismatch": None if result.first is None else str(result.first),
    }
    sentence = (
        f"{result.compared} ticks replayed: {_verdict(result)} ({result.not_comparable} not"
        f" comparable, {result.missing} missing)"
    )
    answer(options, facts, sentence)
    if result.why_behind_gaps:
        say(result.why_behind_gaps)
    damage_status(log)
    if not result.compared:
        raise nothing_compared(log.path)
    if not result.reproduced:
        raise NotDone(f"the controller does not compute what {log.path} says", _verdict(result))
    return 0


def _recover(options: argparse.Namespace) -> int:
    from host.logs.recovery import recover

    found = recover(options.log, options.out)
    share = f"{found.ticks:,} " if found.total is None else f"{found.ticks:,} of {found.total:,} "
    if found.was_whole:
        state = "which was whole,"
    elif found.lost is None:
        state = "which breaks off; how many are lost is not known, they"
    else:
        state = f"{'' if found.total is not None else 'at least '}{found.lost:,} lost,"
    facts = {
        "log": str(found.path),
        "ticks": found.ticks,
        "from": str(options.log),
        "was_whole": found.was_whole,
        "lost": found.lost,
        "total": found.total,
    }
    answer(options, facts, f"{share}ticks of {options.log}, {state} are in {found.path}")
    if found.lost:
        raise NotDone(
            f"{found.lost:,} ticks of {options.log} cannot be read",
            f"go on with {found.path}: its events `lost` say where they are missing",
        )
    return 0


def _verdict(result: ReplayResult) -> str:
    if not result.compared:
        return "nothing to compare"
    if result.exact:
        return "bit for bit the same"
    return f"within {result.tolerance:g}" if result.reproduced else f"NOT the same: {result.beyond}"
