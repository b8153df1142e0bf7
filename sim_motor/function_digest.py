"""A digest of a function: of its code, and of all that it takes from around it.

Two functions with the same digest compute the same. So the digest names what was compiled from a
function, in whichever module the code stands that went into it.
"""

import builtins
import dis
import hashlib
import inspect
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

_NUMBERS = (type(None), type(...), bool, int, float, complex, str, bytes)
_DATA = (*_NUMBERS, tuple, list, set, frozenset, np.ndarray, CodeType)


def function_digest(function: Callable[..., Any], options: Mapping[str, Any]) -> str:
    """The digest of a Python function and of the options with which it is compiled.

    Args:
        function: A plain function. It may call compiled ones: their options count too.
        options: numba's.

    Returns:
        The first 16 hexadecimal digits of a SHA-256.

    Raises:
        NameError: The function names something that does not exist yet.
        TypeError: It takes something from around it that has no known content.
    """
    digest = hashlib.sha256()
    for part in _Walk(function).of_compiled(function, options):
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()[:16]


class _Walk:
    """One walk through a function and all that it takes from around it, each function once."""

    def __init__(self, root: Callable[..., Any]) -> None:
        self._numbers: dict[int, int] = {}
        self._root = root

    def of_compiled(self, function: Any, options: Mapping[str, Any]) -> Iterator[str]:
        yield from self._of(sorted(options.items()))
        yield from self._of_function(function)

    def _of_function(self, function: Any) -> Iterator[str]:
        if id(function) in self._numbers:
            yield f"function {self._numbers[id(function)]}"
            return
        self._numbers[id(function)] = len(self._numbers)
        code = function.__code__
        yield f"function {function.__module__} {function.__name__}"
        yield from self._of(code)
        yield from self._of(function.__defaults__)
        for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
            yield name
            yield from self._of(cell.cell_contents)
        for name in _global_names(code):
            yield name
            if name in function.__globals__:
                yield from self._of(function.__globals__[name], code.co_names)
            elif function is self._root and name == function.__name__:
                yield from self._of_function(function)
            elif not hasattr(builtins, name):
                raise NameError(
                    f"{function.__name__} needs {name}, which does not exist yet: define it above"
                )

    def _of(self, value: Any, attributes: tuple[str, ...] = ()) -> Iterator[str]:
        """The content of a value. attributes: names that code may take from it, if a module."""
        if isinstance(value, _DATA):
            yield from self._of_data(value)
        elif isinstance(value, ModuleType):
            yield f"module {value.__name__}"
            for name in attributes:
                if hasattr(value, name):
                    yield from self._of_attribute(value.__name__, name, getattr(value, name))
        elif getattr(value, "py_func", value) is self._root:
            yield from self._of_function(self._root)
        elif hasattr(value, "py_func"):  # compiled by numba
            yield from self.of_compiled(value.py_func, value.targetoptions)
        elif isinstance(value, FunctionType):
            yield from self._of_function(value)
        elif hasattr(value, "__wrapped__"):  # one of numba's intrinsics
            yield from self._of_function(value.__wrapped__)
        elif isinstance(value, type | BuiltinFunctionType | np.ufunc):
            yield f"{getattr(value, '__module__', '')} {value.__name__}"
        else:
            raise TypeError(f"the content of {value!r} is not known")

    def _of_data(self, value: Any) -> Iterator[str]:
        if isinstance(value, np.ndarray):
            yield f"array {value.dtype.str} {value.shape} {value.tobytes().hex()}"
        elif isinstance(value, CodeType):
            yield value.co_code.hex()
            shape = (value.co_argcount, value.co_posonlyargcount, value.co_kwonlyargcount)
            names = (value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars)
            # Under a profiler numba clears that flag of what it has called.
            flags = value.co_flags & ~inspect.CO_OPTIMIZED
            yield from self._of((*shape, flags, *names, value.co_consts))
        elif isinstance(value, tuple | list | set | frozenset):
            yield f"{type(value).__name__} of {len(value)}"
            # A set has another order in each process.
            for item in value if isinstance(value, tuple | list) else sorted(value, key=repr):
                yield from self._of(item)
        else:
            yield f"{type(value).__name__} {value!r}"

    def _of_attribute(self, module: str, name: str, value: Any) -> Iterator[str]:
        """What a module has by a name: by content if it is data or compiled, else by name alone."""
        yield f"{module}.{name}"
        if hasattr(value, "py_func") or isinstance(value, _DATA):
            yield from self._of(value)


@cache
def _global_names(code: CodeType) -> tuple[str, ...]:
    """The global names that code uses, with the code of functions that stand inside it."""
    names = {one.argval for one in dis.get_instructions(code) if one.opname == "LOAD_GLOBAL"}
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            names.update(_global_names(constant))
    return tuple(sorted(names))
