"""Compiled functions on disk: a second process loads them, in milliseconds each.

They stand in kickctl/compiled below NUMBA_CACHE_DIR, XDG_CACHE_HOME or ~/.cache, the first that is
set, in a folder for each numba, Python and kind of processor. A file's name holds the digest of the
sources that went into it (sim_motor.function_digest): what changed is compiled again, and what did
not change is not. The files that were not used for the longest time are removed when all together
take more than MOST_BYTES.

numba's own cache on disk does not do: it notices changes in the function's own file only, wants
such a file, and two processes that compile one function for different types can mix them up.
"""

import contextlib
import hashlib
import multiprocessing
import os
import pickle
import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
from llvmlite import binding
from numba.core import sigutils, types
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from sim_motor.function_digest import function_digest

MOST_BYTES = 128 * 2**20
_CHECKSUM_BYTES = 32


def attach(dispatcher: Any, options: Mapping[str, Any], digest: str) -> None:
    """Let a numba dispatcher look for its compiled forms on disk, and keep new ones there.

    Args:
        dispatcher: What numba.njit returns.
        options: numba's, with which it was made.
        digest: That of its function and the options.
    """
    # What numba's own enable_caching() sets.
    dispatcher._cache = _Kept(dispatcher.py_func, options, digest)  # noqa: SLF001


class _Kept(NullCache):
    """The compiled forms of one function, one for each signature: numba's seam for a cache."""

    def __init__(
        self, function: Callable[..., Any], options: Mapping[str, Any], digest: str
    ) -> None:
        self._function, self._options, self._digest = function, options, digest

    @property
    def cache_path(self) -> str | None:
        folder = place()
        return None if folder is None else str(folder)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        folder = place()
        if folder is None or not self._can_be_kept(sig):
            return None
        content = _read(folder / self._name(sig))
        if content is None:
            return None
        target_context.refresh()
        parts = pickle.loads(content)  # noqa: S301 - this user's own file
        return CompileResult._rebuild(target_context, *parts)  # noqa: SLF001 - as numba's cache

    def save_overload(self, sig: Any, data: Any) -> None:
        if data.lifted or data.library.has_dynamic_globals or not self._can_be_kept(sig):
            return
        folder = place()
        if folder is None:
            _say_once("this user has no home folder")
            return
        try:
            _write(folder / self._name(sig), dumps(data._reduce()))  # noqa: SLF001 - as numba's cache
            _prune(folder.parent)
        except OSError as error:
            _say_once(f"{folder}: {error.strerror}")

    def _can_be_kept(self, sig: Any) -> bool:
        """Whether another process can know that it looks for the same."""
        if any(isinstance(one, types.Callable) for one in _arguments(sig)):
            return False
        # What it takes from around it may have been changed since, as by a test.
        return function_digest(self._function, self._options) == self._digest

    def _name(self, sig: Any) -> str:
        kinds = hashlib.sha256(str(_arguments(sig)).encode()).hexdigest()[:16]
        return f"{self._function.__name__}-{self._digest}-{kinds}"


def _arguments(sig: Any) -> tuple[Any, ...]:
    """The types of a signature's arguments."""
    arguments: tuple[Any, ...] = sigutils.normalize_signature(sig)[0]
    return arguments


def place() -> Path | None:
    """The folder of compiled functions for this numba, Python and processor.

    None if there is no home folder to put it in.
    """
    root = os.environ.get("NUMBA_CACHE_DIR")
    if not root:
        home = os.path.expanduser("~")  # noqa: PTH111 - Path.home() raises where this gives "~"
        root = os.environ.get("XDG_CACHE_HOME") or os.path.join(home, ".cache")  # noqa: PTH118
        if not os.path.isabs(root):  # noqa: PTH117
            return None
    return Path(root, "kickctl", "compiled", _machine())


@cache
def _machine() -> str:
    """A hash of all but sources that decides about machine code."""
    settings = [
        f"{name}={value}"
        for name, value in sorted(os.environ.items())
        if name.startswith("NUMBA_") and name not in {"NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS"}
    ]
    processor = [binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()]
    versions = [sys.version, numba.__version__, llvmlite.__version__]
    return hashlib.sha256("\0".join(versions + processor + settings).encode()).hexdigest()[:16]


def _read(path: Path) -> bytes | None:
    """A file's content, or None if there is none, or a damaged one."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    with contextlib.suppress(OSError):  # another user's, or gone
        os.utime(path)  # used just now, see _prune
    checksum, content = content[:_CHECKSUM_BYTES], content[_CHECKSUM_BYTES:]
    return content if hashlib.sha256(content).digest() == checksum else None


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
            " some seconds longer. To end that, set XDG_CACHE_HOME to a folder that you can write"
            " to.",
            file=sys.stderr,
        )
