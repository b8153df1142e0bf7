"""Compiled functions on disk: a second process loads them, in milliseconds each.

There is a folder for each numba, Python and kind of processor (see sim_motor.kept_files). A file's
name holds the digest of the sources that went into it (sim_motor.function_digest): what changed is
compiled again, and what did not change is not.

numba's own cache on disk does not do: it notices changes in the function's own file only, wants
such a file, and two processes that compile one function for different types can mix them up.
"""

import hashlib
import os
import pickle
import sys
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import llvmlite
import numba
from llvmlite import binding
from numba.core import sigutils, types
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from sim_motor.function_digest import function_digest
from sim_motor.kept_files import keep, load, place


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
        folder = place(_machine())
        return None if folder is None else str(folder)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        content = load(_machine(), self._name(sig)) if self._can_be_kept(sig) else None
        if content is None:
            return None
        target_context.refresh()
        try:
            parts = pickle.loads(content)  # noqa: S301 - this user's own file
        except ImportError:  # its module is no file, as that of a function that a program has built
            return None
        return CompileResult._rebuild(target_context, *parts)  # noqa: SLF001 - as numba's cache

    def save_overload(self, sig: Any, data: Any) -> None:
        sound = not data.lifted and not data.library.has_dynamic_globals
        if sound and self._can_be_kept(sig):
            content = dumps(data._reduce())  # noqa: SLF001 - as numba's cache
            keep(_machine(), self._name(sig), content)

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
