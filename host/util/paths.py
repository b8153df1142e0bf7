"""Paths as people type them on a command line."""

import argparse
from pathlib import Path


def path_argument(text: str) -> Path:
    """The path that an option takes.

    Raises argparse.ArgumentTypeError if it is empty, or if it is '-': who types that means a
    stream, and no command reads or writes one of that name. './-' is a file.
    """
    if text in ("", "-"):
        why = "'-', which would be a file of that name and no stream" if text else "empty"
        raise argparse.ArgumentTypeError(f"cannot be {why}; give the name of a file or a folder")
    return Path(text)
