"""The one place that knows numba.

Typed decorators, and the robot's pure functions told anew in another mathematics, or compiled.
"""

from collections.abc import Callable, Mapping
from functools import cache
from types import FunctionType
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])
prange = numba.prange


def jit(function: F) -> F:
    """Compile a function on its first call and keep the result on disk.

    It may call only functions of its own module.

    A division by zero gives infinity: checks for it would double the time of a substep.
    """
    return cast(F, numba.njit(cache=True, forceinline=True, error_model="numpy")(function))


def assembled(function: F) -> F:
    """Compile a function that calls compiled functions of other modules.

    Not kept on disk: numba would not notice that a function of another module that went into it has
    changed since.
    """
    return cast(F, numba.njit(error_model="numpy")(function))


def assembled_parallel(function: F) -> F:
    """As `assembled`, with its `prange` loops spread over all cores."""
    return cast(F, numba.njit(error_model="numpy", parallel=True)(function))


@cache
def compiled(function: F) -> F:
    """A plain Python function compiled together with the functions it calls, whose source stays as it is."""
    return retold(function, {}, numba.njit)


def retold(
    function: F,
    mathematics: Mapping[str, Any],
    finish: Callable[[Any], Any] = lambda function: function,
) -> F:
    """A plain Python function, and the functions it calls, from the same source in another mathematics.

    Its code object runs with globals in which every Python function that it names is replaced by
    that function retold, and what `mathematics` names, as "cos", by what is given there. finish:
    what is done to each function, as compiling it.
    """
    source = cast(FunctionType, function)
    names = source.__globals__
    own = {name: mathematics[name] for name in source.__code__.co_names if name in mathematics}
    for name in source.__code__.co_names:
        if isinstance(names.get(name), FunctionType):
            own[name] = retold(names[name], mathematics, finish)
    return cast(
        F,
        finish(
            FunctionType(source.__code__, {**names, **own}, source.__name__, source.__defaults__)
        ),
    )
