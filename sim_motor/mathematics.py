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
    """A plain Python function in another mathematics, with the functions that it calls.

    Args:
        function: Stays as it is. The new function runs the same code, but every name in
            `mathematics` has the value given there, and every Python function that it calls is
            treated the same way.
        mathematics: Values by name, for example numpy's cosine for "cos".
        finish: Called with each new function; what it returns takes that function's place. It may
            compile it.

    Returns:
        What `finish` returns for the new function.
    """
    source = cast(FunctionType, function)
    names = source.__globals__
    own = {name: mathematics[name] for name in source.__code__.co_names if name in mathematics}
    for name in source.__code__.co_names:
        if name not in own and isinstance(names.get(name), FunctionType):
            own[name] = with_mathematics(names[name], mathematics, finish)
    new = FunctionType(source.__code__, {**names, **own}, source.__name__, source.__defaults__)
    return cast(F, finish(new))
