"""kickctl lab --replay and --export: a log in the place of a robot."""

from __future__ import annotations

import argparse
import shlex
from contextlib import suppress
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.commands._log_damage import damage_facts, damage_status
from host.commands._options import refuse_unused
from host.commands._outputs import add_force, require_place
from host.commands._terminal import answer, print_result, say, show_next
from host.errors import WrongUse
from host.util.numbers import Number
from host.util.paths import path_argument

if TYPE_CHECKING:
    from collections.abc import Callable

    from host.logs.mcap_reading import LogFile

_SECONDS = Number("s", 0.0, 1e7)
_PAGES = (".html", ".htm")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which log, which part of it, and where the file goes."""
    group = parser.add_argument_group("a log instead of a robot")
    one = group.add_mutually_exclusive_group()
    one.add_argument(
        "--replay",
        type=path_argument,
        metavar="LOG",
        help="open a log instead of a robot: a time slider, and in each tick the equations with"
        " that tick's numbers. Ten minutes of a log take some 2 s to read",
    )
    one.add_argument(
        "--export",
        nargs=2,
        type=path_argument,
        metavar=("FILE.html", "LOG"),
        help="write the same as one file, which any browser opens from disk, without a network",
    )
    group.add_argument(
        "--from",
        dest="from_s",
        type=_SECONDS,
        metavar="S",
        help="where the part of the log begins, in s from its first tick (default: 0)",
    )
    group.add_argument(
        "--to",
        dest="to_s",
        type=_SECONDS,
        metavar="S",
        help="where the part of the log ends, in s from its first tick (default: its end). A page"
        " takes 20,000 ticks: ten minutes of 30 ms",
    )
    add_force(group)


def wants_replay(options: argparse.Namespace) -> bool:
    """Whether the command is about a log. Raises WrongUse for options that need one without it."""
    if options.replay is not None or options.export is not None:
        return True
    for name, value in (("--from", options.from_s), ("--to", options.to_s)):
        if value is not None:
            raise WrongUse(
                f"{name} cuts a log, and there is none", "name one: --replay LOG --from 10 --to 20"
            )
    if options.force:
        raise WrongUse("--force replaces a file, and none is written", "leave it out")
    return False


def run(options: argparse.Namespace, open_browser: Callable[[str], None]) -> int:
    """Serve a replay until ^C, or write it. Raises KickctlError if that cannot be."""
    _refuse_robots(options)
    if options.export is None:
        return _serve(options, open_browser)
    path, source = options.export
    if path.suffix.lower() not in _PAGES:
        swapped = source.suffix.lower() in _PAGES
        page, log = (source, path) if swapped else (path.with_suffix(".html"), source)
        raise WrongUse(
            f"the file {path} has another ending than .html, so that no browser would open it",
            f"kickctl lab --export {shlex.quote(str(page))} {shlex.quote(str(log))}",
        )
    return _export(options, require_place(options, path), source)


def _refuse_robots(options: argparse.Namespace) -> None:
    way = "--replay" if options.export is None else "--export"
    refuse_unused(argparse.Namespace(**{**vars(options), "used": (), "command": f"lab {way}"}))
    for name in ("walls", "unattended"):
        if getattr(options, name) is not None:
            raise WrongUse(f"--{name} is for robots, and {way} shows a log", "leave it out")
    if way == "--replay" and options.force:
        raise WrongUse("--force replaces a file, and --replay writes none", "leave it out")
    if way == "--export" and options.host:
        raise WrongUse(
            "--host and --class open a page to others, and --export writes a file", "leave it out"
        )


def _read(options: argparse.Namespace, path: Path) -> tuple[LogFile, dict[str, Any]]:
    """The log and its tape. Says what is wrong with it."""
    from host.lab.tape import Cut, make_tape
    from host.logs.mcap_reading import LogFile
    from host.logs.replay import nothing_compared

    from_s, to_s = options.from_s or 0.0, inf if options.to_s is None else options.to_s
    if from_s > to_s:
        raise WrongUse(
            f"--from {from_s:g} is later than --to {to_s:g}",
            "exchange them: both count from the start",
        )
    log = LogFile(path)
    tape = make_tape(log, path.name, Cut(from_s, to_s), options.twin)
    verdict = tape["verdict"]
    if not verdict["reproduced"]:
        if verdict["compared"]:
            say(f"{path} is not what the robot's program computes: {verdict['first_mismatch']}")
        else:
            nothing = nothing_compared(path if tape["part"] == "" else f"this part of {path}")
            say(f"{nothing.message}; {nothing.hint}")
        for words in verdict["other_sources"]:
            say(words)
    return log, tape


def _facts(log: LogFile, tape: dict[str, Any]) -> dict[str, Any]:
    verdict = {name: value for name, value in tape["verdict"].items() if name != "damage"}
    facts = {"ticks": tape["ticks"], **verdict, **damage_facts(log)}
    if tape["twin"] is not None:
        facts["twin"] = {"motor": tape["twin"]["motor"], "kicks": tape["twin"]["kicks"]}
    return facts


def _export(options: argparse.Namespace, path: Path, source: Path) -> int:
    from host.lab.one_file import one_file
    from host.util.whole_files import whole_file

    log, tape = _read(options, source)
    page = one_file(tape).encode()
    with whole_file(path, new=not options.force) as draft:
        draft.write_bytes(page)
    facts = {"file": str(path), "bytes": len(page), **_facts(log, tape)}
    size = f"{len(page) / 1e6:.1f} MB"
    ticks = f"{tape['ticks']} tick{'s' * (tape['ticks'] != 1)}"
    answer(options, facts, f"{ticks} in {path}, {size}; any browser opens it")
    return damage_status(log)


def _serve(options: argparse.Namespace, open_browser: Callable[[str], None]) -> int:
    from urllib.parse import quote

    from host.lab.replays import Replays
    from host.lab.server import Lab

    log, tape = _read(options, options.replay)
    replays = Replays()
    replays.give(tape)
    with Lab([], options.port, options.host, replays=replays) as lab:
        url = lab.view_url.replace("/#", f"/replay.html?log={quote(tape['name'])}#")
        with suppress(KeyboardInterrupt):
            if options.json:
                show_next({"replay": url, **_facts(log, tape)})
            else:
                print_result(f"replay {url}")
            if not log.whole:
                say(f"{log.damage()}; {log.remedy()}")
            if not options.no_open:
                open_browser(url)
            lab.wait()
    return 0
