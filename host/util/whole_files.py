"""Files that appear under their names only when they are whole.

A writer that fails, is interrupted or finds the disk full leaves what was there before: the old
file, or none. What is no file, such as a pipe, gets the whole of what was written, at the end.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from host.errors import WrongUse

# How the name of a draft begins.
DRAFT = ".kickctl-"
# What os.link says on file systems that have no hard links.
_NO_LINKS = {errno.EPERM, errno.ENOSYS, errno.EOPNOTSUPP, errno.EMLINK}


class FileTaken(WrongUse):
    """There is a file of this name already, and nobody allowed to replace it."""

    def __init__(self, path: str | Path) -> None:
        super().__init__(
            f"{path} exists already", "choose another name, or replace the file with --force"
        )


@contextmanager
def whole_file(path: str | Path, *, new: bool = False) -> Iterator[Path]:
    """Yield the path of a draft beside a file; it gets the file's name at the end of the block.

    If the block fails, or writes no draft, nothing has changed. A device, a pipe or a descriptor of
    this process, such as /dev/stdout, is not replaced: the draft lies elsewhere, and is copied to
    it at the end.

    Args:
        path: The file.
        new: Whether the file must not exist. Of two programs that write one name at the same time,
            one gets it, and the other one fails.

    Yields:
        The draft's path, with the file's ending.

    Raises:
        FileTaken: `new`, and there is such a file.
        OSError: The file cannot be written. The error names the file, not the draft.
    """
    target = Path(os.path.realpath(path))  # a symbolic link keeps pointing to its file
    if is_stream(path):
        with tempfile.TemporaryDirectory() as folder, naming(path):
            draft = Path(folder, "draft").with_suffix(target.suffix[:40])
            yield draft
            if draft.exists():
                _copy(draft, path)
        return
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    require_free(path, replace=not new)
    draft = target.with_name(f"{DRAFT}{secrets.token_hex(8)}{target.suffix[:40]}")
    try:
        with naming(path, draft):
            yield draft
            if draft.exists():
                (_claim if new else _replace)(draft, target)
    except FileExistsError:  # another program was faster
        raise FileTaken(path) from None
    finally:
        with suppress(OSError):
            draft.unlink()


def require_free(path: str | Path, *, replace: bool = False) -> None:
    """Raise FileTaken if there is a file of this name, unless it may be replaced.

    Raise WrongUse if it is a folder, or if its name cannot be typed.
    """
    require_text(path)
    if Path(path).is_dir():
        raise WrongUse(f"{path} is a folder", "name a file")
    if not replace and os.path.lexists(path) and not is_stream(path):
        raise FileTaken(path)


def require_text(path: str | Path) -> None:
    """Raise WrongUse if a file's name has bytes that are no text: no message could show it."""
    try:
        Path(path).name.encode()
    except UnicodeEncodeError:
        raise WrongUse(
            f"the name {path} has bytes that are no text in UTF-8, so that nobody could type it",
            "choose another name",
        ) from None


def require_folder(path: str | Path) -> None:
    """Raise WrongUse if there is no folder for this file, or none that takes files."""
    if is_stream(path):
        return
    folder = Path(os.path.realpath(path)).parent
    if not folder.is_dir():
        raise WrongUse(
            f"{path} cannot be written: there is no folder {Path(path).parent}",
            "create the folder first, or choose another place",
        )
    if not os.access(folder, os.W_OK | os.X_OK):
        raise WrongUse(
            f"{path} cannot be written: you may not write to the folder {Path(path).parent}",
            "choose a folder that you may write to",
        )


def is_stream(path: str | Path) -> bool:
    """Whether a path names something to write to that cannot be replaced: a device or a pipe."""
    if descriptor_of(path) is not None:
        return True
    path = Path(path)
    return path.exists() and not path.is_file() and not path.is_dir()


def descriptor_of(path: str | Path) -> int | None:
    """The descriptor of this process that a path names, as /dev/stdout names 1; None for others.

    What is behind it may be a pipe or a file. It must be neither opened again, which would empty
    the file, nor replaced.
    """
    place = os.path.abspath(path)  # noqa: PTH100 - Path.absolute keeps '..'
    for _ in range(40):  # as many links as the kernel follows
        folder, name = os.path.split(place)
        if os.path.realpath(folder) == f"/proc/{os.getpid()}/fd" and name.isdecimal():
            return int(name)
        try:
            place = os.path.join(folder, os.readlink(place))  # noqa: PTH115, PTH118
        except OSError:
            break
    return None


def _copy(draft: Path, path: str | Path) -> None:
    """Copy a draft to a device, a pipe or a descriptor."""
    descriptor = descriptor_of(path)
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    with (
        draft.open("rb") as source,
        open(path if descriptor is None else os.dup(descriptor), "wb") as out,  # noqa: PTH123
    ):
        shutil.copyfileobj(source, out)


@contextmanager
def naming(path: str | Path, draft: Path | None = None) -> Iterator[None]:
    """Give a file's name to an OSError that names none, as that of a full disk, or the draft."""
    try:
        yield
    except OSError as error:
        if error.filename is None or error.filename == os.fspath(draft or ""):
            error.filename = str(path)
            if error.filename2 is not None:
                error.filename2 = None
        raise


def write_text(path: str | Path, text: str, *, new: bool = False) -> None:
    """Write a text file that is whole whenever it is there. Raises as `whole_file` does."""
    with whole_file(path, new=new) as draft:
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
