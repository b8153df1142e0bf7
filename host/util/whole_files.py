"""Files that appear under their names only when they are whole.

A writer that fails, is interrupted or finds the disk full leaves what was there before: the old
file, or none.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

# What os.link says on file systems that have no hard links.
_NO_LINKS = {errno.EPERM, errno.ENOSYS, errno.EOPNOTSUPP, errno.EMLINK}


@contextmanager
def whole_file(path: str | Path, *, new: bool = False) -> Iterator[Path]:
    """Yield the path of a draft beside a file; it gets the file's name at the end of the block.

    If the block fails, or writes no draft, nothing has changed. A device or a pipe is not replaced:
    the block writes to it directly.

    Args:
        path: The file.
        new: Whether the file must not exist. Of two programs that write one name at the same time,
            one gets it, and the other one fails.

    Yields:
        The draft's path, with the file's ending.

    Raises:
        FileExistsError: `new`, and there is such a file.
        OSError: The file cannot be written. The error names the file, not the draft.
    """
    target = Path(os.path.realpath(path))  # a symbolic link keeps pointing to its file
    if new and os.path.lexists(path):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
    if target.exists() and not target.is_file():
        with naming(path):
            yield target
        return
    draft = target.with_name(f".kickctl-{secrets.token_hex(8)}{target.suffix[:40]}")
    try:
        with naming(path, draft):
            yield draft
            if draft.exists():
                (_claim if new else _replace)(draft, target)
    finally:
        with suppress(OSError):
            draft.unlink()


@contextmanager
def naming(path: str | Path, draft: Path | None = None) -> Iterator[None]:
    """Give a file's name to an OSError that names none, as that of a full disk, or the draft."""
    try:
        yield
    except OSError as error:
        if error.filename is None or error.filename == os.fspath(draft or ""):
            error.filename, error.filename2 = str(path), None
        raise


def write_text(path: str | Path, text: str) -> None:
    """Write a text file that is whole whenever it is there. Raises OSError."""
    with whole_file(path) as draft:
        draft.write_text(text, encoding="utf-8")


def _replace(draft: Path, target: Path) -> None:
    if target.exists():
        shutil.copymode(target, draft)
    draft.replace(target)


def _claim(draft: Path, target: Path) -> None:
    try:
        os.link(draft, target)
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        os.close(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        draft.replace(target)
