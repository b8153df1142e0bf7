"""The one place that knows how to compile functions, and how to spread their work over all cores.

What is compiled is kept on disk (sim_motor.compiled_cache), so that only the first process on a
machine compiles it.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, cached_property
from types import FunctionType
from typing import Any, TypeVar, cast

import numba
from numba.core import types
from numba.core.datamodel.models import OpaqueModel
from numba.extending import register_model, typeof_impl

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
    # Nobody calls it from C, and the wrapper for that takes a fifth of the time.
    options["no_cfunc_wrapper"] = True
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


def unlocked_jit(function: F) -> F:
    """As `jit`, for `over_cores`: while the function runs, so may others of the same process."""
    return njit(function, error_model="numpy", nogil=True)


class _Inner:
    """A compiled function for other compiled ones, without the wrapper for calls from Python.

    That takes longer to compile than most functions. If Python calls it all the same, it is
    compiled once more.
    """

    def __init__(self, dispatcher: Any, options: Mapping[str, Any]) -> None:
        self.dispatcher, self._options = dispatcher, options
        # By these one knows what is compiled (sim_motor.function_digest).
        self.py_func, self.targetoptions = dispatcher.py_func, dispatcher.targetoptions

    @cached_property
    def _for_python(self) -> Callable[..., Any]:
        own = self.py_func
        parts = own.__globals__, own.__name__, own.__defaults__, own.__closure__
        return njit(FunctionType(own.__code__, *parts), **self._options)

    def __call__(self, *arguments: Any) -> Any:
        return self._for_python(*arguments)


class _InnerType(types.Dispatcher):
    """What compiled code takes an `_Inner` for.

    It takes literals as numbers: numba would compile the function once more for each.
    """

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        return super().get_call_type(context, tuple(map(types.unliteral, args)), kws)


register_model(_InnerType)(OpaqueModel)


@typeof_impl.register(_Inner)
def _type_of_inner(inner: _Inner, _context: Any) -> _InnerType:
    return _InnerType(inner.dispatcher)


def inner(function: F, **options: Any) -> F:
    """As `njit`, for a function that compiled ones call."""
    dispatcher = njit(function, no_cpython_wrapper=True, **options)
    return function if dispatcher is function else cast(F, _Inner(dispatcher, options))


def inner_jit(function: F) -> F:
    """As `jit`, for a function that compiled ones call."""
    return inner(function, error_model="numpy")


def inlined_jit(function: F) -> F:
    """As `inner_jit`, and compile the function into those that call it."""
    return inner(function, error_model="numpy", forceinline=True)


@cache
def compiled(function: F) -> F:
    """A plain Python function, and those that it calls, for compiled ones. Its source stays."""
    return with_mathematics(function, {}, inner)


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
