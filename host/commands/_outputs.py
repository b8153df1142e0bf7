"""Files that a user names, to be written: no other file is lost, and none has a wrong ending."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from host.commands._terminal import answer, say
from host.errors import WrongUse
from host.util.whole_files import descriptor_of, require_folder, require_free

_STANDARD_OUTPUT = 1


def add_force(parser: argparse._ActionsContainer) -> None:
    """Add --force, which lets a command replace files."""
    parser.add_argument(
        "--force", action="store_true", help="replace a file that is there already (never a log)"
    )


def require_place(options: argparse.Namespace, path: Path) -> Path:
    """Refuse a file that must not be written, before anything is done.

    Args:
        options: Those of the command, with --json and --force.
        path: The file to be written.

    Returns:
        The path.

    Raises:
        WrongUse: There is a log there, or a file without --force; or no file can be written there;
            or the file is standard output, where --json answers.
    """
    from host.logs.mcap_reading import require_no_log

    require_no_log(path)
    if options.json and descriptor_of(path) == _STANDARD_OUTPUT:
        raise WrongUse(
            "with --json the answer goes to standard output, so nothing else can go there",
            "name a file with --out",
        )
    require_free(path, replace=options.force)
    require_folder(path)
    return path


def answer_beside(
    options: argparse.Namespace, path: Path, result: dict[str, Any], sentence: str
) -> None:
    """Answer; in words on standard error if the file itself went to standard output."""
    if descriptor_of(path) == _STANDARD_OUTPUT:
        say(sentence)
    else:
        answer(options, result, sentence)
