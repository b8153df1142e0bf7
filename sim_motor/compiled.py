"""The one place that knows numba: typed decorators, and the robot's pure functions compiled as they are."""

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])
prange = numba.prange


def jit(function: F) -> F:
    """Compile a function on its first call and keep the result on disk. It may call only functions of its own module.

    A division by zero gives infinity: checks for it would double the time of a substep.
    """
    return cast(F, numba.njit(cache=True, forceinline=True, error_model="numpy")(function))


def assembled(function: F) -> F:
    """Compile a function that calls compiled functions of other modules.

    Not kept on disk: numba would not notice that a function of another module that went into it has changed since.
    """
    return cast(F, numba.njit(error_model="numpy")(function))


def assembled_parallel(function: F) -> F:
    """As `assembled`, with its `prange` loops spread over all cores."""
    return cast(F, numba.njit(error_model="numpy", parallel=True)(function))


@cache
def compiled(function: F) -> F:
    """A plain Python function compiled together with the functions it calls, whose source stays as it is.

    Its code object runs with globals in which every Python function that it names is replaced by the compiled one.
    """
    source = cast(FunctionType, function)
    names = source.__globals__
    callees = {name: compiled(names[name]) for name in source.__code__.co_names if isinstance(names.get(name), FunctionType)}
    twin = FunctionType(source.__code__, {**names, **callees}, source.__name__, source.__defaults__)
    return cast(F, numba.njit(twin))
