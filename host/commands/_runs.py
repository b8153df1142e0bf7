"""What the commands of experiments and studies share: a command for each, and its figure."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from host.commands._options import common
from host.runs.registry import Entry, add_options


def add_run(names: Any, name: str, entry: Entry, used: Sequence[str]) -> argparse.ArgumentParser:
    """Add the command of an experiment or study, with its options and those of its figure.

    Args:
        names: What `add_subparsers` has returned.
        name: Its name.
        entry: Its help text and options.
        used: The options for robots that it uses, see `common`.
    """
    parser: argparse.ArgumentParser = names.add_parser(
        name,
        help=entry.help.replace("%", "%%"),
        description=entry.help,
        parents=[common(defaults=False, used=used)],
    )
    add_options(parser, entry)
    parser.add_argument(
        "--format",
        metavar="LIST",
        help="formats of the figure, one or several of png, svg and pdf (default png,svg)",
    )
    parser.add_argument(
        "--panel",
        metavar="NAME",
        help="draw this panel of the figure alone, into a file of its own; a wrong name lists them"
        " (a sweep's are its quantities, known after the run: it draws them all)",
    )
    return parser


def figure_given(options: argparse.Namespace) -> dict[str, Any]:
    """What was given of the figure's options, as `perform` takes it."""
    given = {"formats": options.format, "panel": options.panel}
    return {name: value for name, value in given.items() if value is not None}
