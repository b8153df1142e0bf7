"""Arguments of public functions: what is of the wrong kind is refused before anything happens."""

from __future__ import annotations

import os
import reprlib
from collections.abc import Callable, Mapping
from math import isnan
from numbers import Integral, Real
from typing import Any

from host.errors import WrongUse

# A seed of 128 random bits is shorter.
SEED_DIGITS = 40

_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = 60


def shown(value: object) -> str:
    """A value in a message: at most 60 letters of it, all printable."""
    try:
        return _short.repr(value)
    except Exception:  # noqa: BLE001 - its repr is the user's code
        return f"of type {type(value).__name__}"


def wrong(name: str, value: object, wanted: str) -> WrongUse:
    """The error for an argument that is of the wrong kind.

    Args:
        name: The argument's name.
        value: What was given.
        wanted: What to give instead, in words.
    """
    return WrongUse(f"{name} cannot be {shown(value)}", f"give {wanted}")


def need_text(name: str, value: object, wanted: str) -> str:
    """The value, if it is text that is not empty. Raises WrongUse."""
    if not isinstance(value, str) or not value:
        raise wrong(name, value, wanted)
    return value


def need_path(name: str, value: object) -> str:
    """The path of a file or folder as text. Raises WrongUse."""
    path = os.fspath(value) if isinstance(value, str | os.PathLike) else None
    if not isinstance(path, str) or not path or "\0" in path:
        raise wrong(name, value, "the path of a file, as text")
    return path


def need_whole(name: str, value: object, wanted: str) -> int:
    """The value as a whole number, 0 or more. Raises WrongUse."""
    if isinstance(value, bool) or not isinstance(value, Integral) or int(value) < 0:
        raise wrong(name, value, wanted)
    return int(value)


def need_seed(value: object) -> int | None:
    """The random seed, None if there is none. Raises WrongUse."""
    wanted = f"a whole number, 0 or more, of at most {SEED_DIGITS} digits"
    seed = None if value is None else need_whole("seed", value, wanted)
    if seed is not None and seed >= 10**SEED_DIGITS:
        raise wrong("seed", seed, wanted)
    return seed


def need_seconds(name: str, value: object) -> float:
    """The value as a time (s), 0 or more; it may be infinite. Raises WrongUse."""
    try:
        if isinstance(value, Real) and not isinstance(value, bool):
            seconds = float(value)
            if seconds >= 0.0 and not isnan(seconds):
                return seconds
    except OverflowError:
        pass
    raise wrong(name, value, "a number of seconds, 0 or more")


def need_function(name: str, value: object, wanted: str) -> Callable[..., Any]:
    """The value, if it can be called. Raises WrongUse."""
    if not callable(value):
        raise wrong(name, value, wanted)
    return value


def need_tap(value: object) -> None:
    """Raise WrongUse for what cannot be fed with records and events."""
    if not all(callable(getattr(value, name, None)) for name in ("take_records", "take_event")):
        raise wrong("tap", value, "an object with take_records(records) and take_event(event)")


def plain(value: object) -> Any:
    """A value as JSON has it: text, numbers (numpy's too), None, and lists and tables of them.

    Raises:
        TypeError: It is, or holds, something else.
    """
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value)
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, Mapping) and all(isinstance(name, str) for name in value):
        return {name: plain(item) for name, item in value.items()}
    raise TypeError(shown(value))
