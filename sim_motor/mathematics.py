"""The robot's pure functions in another mathematics: of arrays, of symbols, or compiled."""

from collections.abc import Callable, Mapping
from types import FunctionType
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def with_mathematics(
    function: F,
    mathematics: Mapping[str, Any],
    finish: Callable[[Any], Any] = lambda function: function,
) -> F:
    """A plain Python function, with the functions it calls, in another mathematics.

    Args:
        function: Stays as it is. The new one runs the same code, with other globals: every Python
            function that it names is replaced by that function with_mathematics.
        mathematics: What stands for a name, as numpy's cosine for "cos".
        finish: What is done to each new function, as compiling it.
    """
    source = cast(FunctionType, function)
    names = source.__globals__
    own = {name: mathematics[name] for name in source.__code__.co_names if name in mathematics}
    for name in source.__code__.co_names:
        if name not in own and isinstance(names.get(name), FunctionType):
            own[name] = with_mathematics(names[name], mathematics, finish)
    new = FunctionType(source.__code__, {**names, **own}, source.__name__, source.__defaults__)
    return cast(F, finish(new))
