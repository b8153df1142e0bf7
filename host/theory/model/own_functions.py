"""The user's own transfer functions and mechanics, and whether they compile."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import isfinite
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

from host.errors import WrongUse


class _Own(NamedTuple):
    """What one number stands for."""

    transfer: Callable[..., Any] | None
    mechanics: Callable[..., Any] | None


# Number 0 is the paper.
_KNOWN = [_Own(None, None)]
# Arguments to try a function with.
_TRIED = {
    "transfer": ("(x, a)", (0.5, 4.0)),
    "mechanics": ("(torque, omega, inertia, friction, dry_friction)", (0.1, 2.0, 0.05, 0.5, 0.0)),
}
# The functions of the model whose places they take.
_PLACES = {"transfer": "target_position", "mechanics": "acceleration"}


def number_of(transfer: Callable[..., Any] | None, mechanics: Callable[..., Any] | None) -> int:
    """The number of a transfer function and mechanics; of the paper's where they are None.

    Raises:
        WrongUse: A function does not compile, or gives no finite number.
    """
    own = _Own(transfer, mechanics)
    if own not in _KNOWN:
        for role, function in own._asdict().items():
            if function is not None:
                _require_compiled(role, function)
        _KNOWN.append(own)
    return _KNOWN.index(own)


def parts(number: int) -> dict[str, Callable[..., Any]]:
    """The user's functions, by the names of those whose places they take.

    Raises:
        WrongUse: This process has no functions of this number.
    """
    if not 0 <= number < len(_KNOWN):
        raise WrongUse(
            "the wheel has functions that another Python process knows",
            "call with_functions in this one",
        )
    own = _KNOWN[number]._asdict()
    return {_PLACES[role]: function for role, function in own.items() if function is not None}


def _place(error: Exception, function: FunctionType) -> str:
    """Where a function does not compile, and why, as far as the compiler says."""
    own = function.__code__
    name = re.escape(Path(own.co_filename).name)
    lines = re.findall(rf'{name}"?(?:, line | \()(\d+)', str(error))
    why = [line.strip(" .") for line in str(error).splitlines() if line.strip()]
    reason = why[1] if why[0].startswith("Failed in") and why[1:] else why[0]
    return f"line {lines[-1] if lines else own.co_firstlineno} of {own.co_filename}: {reason}"


def _require_compiled(role: str, function: Any) -> None:
    """Raise WrongUse if a function does not compile, or gives no finite number."""
    from numba.core.errors import NumbaError, UnsupportedBytecodeError

    from sim_motor.compiled import compiled

    signature, arguments = _TRIED[role]
    if not isinstance(function, FunctionType):
        raise WrongUse(
            f"{role} cannot be {function!r}", f"give a plain Python function of {signature}"
        )
    if function.__closure__:
        outside = ", ".join(function.__code__.co_freevars)
        raise WrongUse(
            f"{role} uses {outside} of the function around it",
            "define it at the top of a file or cell, with constants beside it or as default values",
        )
    try:
        value = compiled(function)(*arguments)
    except (
        NumbaError,
        UnsupportedBytecodeError,
        AttributeError,
        NameError,
        TypeError,
    ) as error:
        raise WrongUse(
            f"{role} does not compile, the function {function.__name__}, {_place(error, function)}",
            f"write a function of {signature}: numbers only, with functions of the module math;"
            " no arrays, texts, dictionaries or classes",
        ) from error
    if not isinstance(value, float) or not isfinite(value):
        raise WrongUse(
            f"{role} gave {value!r} for {signature} = {arguments}", "return one finite number"
        )
