"""The one place that knows numba: pure functions compiled, or evaluated in another mathematics.

What is compiled is kept on disk (sim_motor.compiled_cache), so that only the first process on a
machine compiles it.
"""

from collections.abc import Callable, Mapping
from functools import cache
from types import FunctionType
from typing import Any, TypeVar, cast

import numba

from sim_motor import compiled_cache
from sim_motor.function_digest import function_digest

F = TypeVar("F", bound=Callable[..., Any])
prange = numba.prange


def njit(function: F, **options: Any) -> F:
    """Compile a function on its first call with numba's options, and keep the result on disk.

    Everything that the function takes from around it must stand above it: helpers, constants.
    Functions given as arguments have another identity in each process, so that a function that
    takes them is compiled in each; hand them in by `bound` instead.
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
    return retold(function, {}, njit)


def retold(
    function: F,
    mathematics: Mapping[str, Any],
    finish: Callable[[Any], Any] = lambda function: function,
) -> F:
    """A plain Python function, with the functions it calls, in another mathematics.

    Args:
        function: Stays as it is. The new one runs the same code, with other globals: every Python
            function that it names is replaced by that function retold.
        mathematics: What stands for a name, as numpy's cosine for "cos".
        finish: What is done to each new function, as compiling it.
    """
    source = cast(FunctionType, function)
    names = source.__globals__
    own = {name: mathematics[name] for name in source.__code__.co_names if name in mathematics}
    for name in source.__code__.co_names:
        if name not in own and isinstance(names.get(name), FunctionType):
            own[name] = retold(names[name], mathematics, finish)
    new = FunctionType(source.__code__, {**names, **own}, source.__name__, source.__defaults__)
    return cast(F, finish(new))
