"""The one place that knows how to compile functions.

What is compiled is kept on disk (sim_motor.compiled_cache), so that only the first process on a
machine compiles it.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, TypeVar, cast

import numba

from sim_motor import compiled_cache
from sim_motor.function_digest import function_digest
from sim_motor.mathematics import with_mathematics

F = TypeVar("F", bound=Callable[..., Any])
prange = numba.prange


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


def parallel_jit(function: F) -> F:
    """As `jit`, with its `prange` loops spread over all cores."""
    return njit(function, error_model="numpy", parallel=True)


@cache
def compiled(function: F) -> F:
    """A plain Python function compiled with the functions it calls. Its source stays as it is."""
    return with_mathematics(function, {}, njit)


@contextmanager
def on_one_core() -> Iterator[None]:
    """Let `parallel_jit` loops run on one core: to spread a short one takes longer than to run it.

    It counts for the calling thread.
    """
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(before)
