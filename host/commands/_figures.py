"""Options of the figure that a run draws."""

from __future__ import annotations

import argparse
from typing import Any


def add_figure(parser: argparse.ArgumentParser) -> None:
    """Add --format and --panel."""
    parser.add_argument(
        "--format",
        metavar="LIST",
        help="formats of the figure, one or several of png, svg and pdf (default png,svg)",
    )
    parser.add_argument(
        "--panel",
        metavar="NAME",
        help="draw this panel of the figure alone, into a file of its own; a wrong name lists them",
    )


def figure_given(options: argparse.Namespace) -> dict[str, Any]:
    """What was given of these options, as `perform` takes it."""
    given = {"formats": options.format, "panel": options.panel}
    return {name: value for name, value in given.items() if value is not None}
