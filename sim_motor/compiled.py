"""The one place that knows how to compile functions, and how to spread their work over all cores.

What is compiled is kept on disk (sim_motor.compiled_cache), so that only the first process on a
machine compiles it.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from typing import Any, TypeVar, cast

import numba

from sim_motor import compiled_cache
from sim_motor.function_digest import function_digest
from sim_motor.mathematics import with_mathematics

F = TypeVar("F", bound=Callable[..., Any])
_CORES = len(os.sched_getaffinity(0))
_most_cores: ContextVar[int] = ContextVar("_most_cores", default=_CORES)


def njit(function: F, **options: Any) -> F:
    """Compile a function on its first call with numba's options, and keep the result on disk.

    Everything that the function takes from around it must stand above it: helpers, constants. A
    function that is given compiled functions as arguments is compiled again in each process, as
    numba cannot recognise them there; it should take them from around it instead.
    """
    digest = function_digest(function, options)
    # Machine code from several processes is linked by name, so that a name must mean one code.
    function.__qualname__ += "_" + digest
    dispatcher = numba.njit(**options)(function)
    if dispatcher is not function:  # which it is where NUMBA_DISABLE_JIT is set
        compiled_cache.attach(dispatcher, options, digest)
    return cast(F, dispatcher)


def jit(function: F) -> F:
    """Compile a function. A division by zero gives infinity: to check for it doubles the time."""
    return njit(function, error_model="numpy")


def inlined_jit(function: F) -> F:
    """As `jit`, and compile the function into those that call it."""
    return njit(function, error_model="numpy", forceinline=True)


def unlocked_jit(function: F) -> F:
    """As `jit`, for `over_cores`: while the function runs, so may others of the same process."""
    return njit(function, error_model="numpy", nogil=True)


@cache
def compiled(function: F) -> F:
    """A plain Python function compiled with the functions it calls. Its source stays as it is."""
    return with_mathematics(function, {}, njit)


@contextmanager
def on_one_core() -> Iterator[None]:
    """Let `over_cores` take one core: to spread short work takes longer than to do it.

    It counts for the calling thread.
    """
    before = _most_cores.set(1)
    try:
        yield
    finally:
        _most_cores.reset(before)


def over_cores(work: Callable[[int, int], None], count: int) -> None:
    """Call work(core, cores) for every core, side by side, on as many as there are.

    numba would do so inside of a compiled function, but takes several times as long to compile
    that, as it compiles what is called there once more.

    Args:
        work: Does each of the `cores`-th parts of the work from part number `core` on, by a
            function that is compiled without Python's lock.
        count: How many parts there are. No more cores are taken.
    """
    cores = min(_most_cores.get(), count)
    if cores <= 1:
        work(0, 1)
        return
    with ThreadPoolExecutor(cores) as pool:
        list(pool.map(work, range(cores), [cores] * cores))
