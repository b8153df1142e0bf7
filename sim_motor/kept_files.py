"""Files that spare the next process some work, and that any process may do without.

They stand in kickctl/compiled below NUMBA_CACHE_DIR, XDG_CACHE_HOME or ~/.cache, the first that is
set, in a folder for each kind of content. Their names hold a hash of all that decides about their
content. The files that were not used for the longest time are removed when all together take more
than MOST_BYTES.
"""

import contextlib
import hashlib
import multiprocessing
import os
import sys
import tempfile
from functools import cache
from pathlib import Path

from robot.user_folders import cache_folder

MOST_BYTES = 128 * 2**20
_CHECKSUM_BYTES = 32


def place(kind: str) -> Path | None:
    """The folder for a kind of content, or None if this user has no home folder."""
    named = os.environ.get("NUMBA_CACHE_DIR")
    if not named:
        folder = cache_folder()
        return Path(folder, "compiled", kind) if folder else None
    root = os.path.expanduser(named)  # noqa: PTH111 - Path's raises where this leaves the "~"
    return None if root.startswith("~") else Path(root, "kickctl", "compiled", kind)


def load(kind: str, name: str) -> bytes | None:
    """A file's content, or None if there is no such file or it is damaged."""
    folder = place(kind)
    if folder is None:
        return None
    try:
        content = (folder / name).read_bytes()
    except OSError:
        return None
    with contextlib.suppress(OSError):  # another user's file, or removed since
        os.utime(folder / name)  # used just now, see _prune
    checksum, content = content[:_CHECKSUM_BYTES], content[_CHECKSUM_BYTES:]
    return content if hashlib.sha256(content).digest() == checksum else None


def keep(kind: str, name: str, content: bytes) -> None:
    """Write a file for the next process. Where that fails, standard error says so, once."""
    folder = place(kind)
    if folder is None:
        _say_once("this user has no home folder")
        return
    try:
        _write(folder / name, content)
        _prune(folder.parent)
    except OSError as error:
        _say_once(f"{folder}: {error.strerror}")


def _write(path: Path, content: bytes) -> None:
    """Write a file that is whole whenever it is there. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        try:
            file.write(hashlib.sha256(content).digest() + content)
            file.close()
            Path(file.name).replace(path)
        except OSError:
            Path(file.name).unlink()
            raise


def _prune(root: Path) -> None:
    """Remove the files that were not used for the longest time, until the others fit.

    A process that uses one has read all of it, and does not miss it.
    """
    files = []
    for folder in root.iterdir():
        for path in folder.iterdir():
            with contextlib.suppress(FileNotFoundError):
                files.append((path.stat().st_mtime, path.stat().st_size, path))
    size = 0
    for _, own, path in sorted(files, reverse=True):
        size += own
        if size > MOST_BYTES:
            path.unlink(missing_ok=True)


@cache
def _say_once(why: str) -> None:
    if multiprocessing.parent_process() is None:
        print(
            f"kickctl: compiled functions cannot be kept ({why}). All works, but each start takes"
            " some seconds longer. To end that, set XDG_CACHE_HOME to a folder with room where you"
            " can write.",
            file=sys.stderr,
        )
