"""Names of a module that are loaded when they are first used."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from importlib import import_module


def load(module: str, name: str, promised: Iterable[str], place: str | None) -> object:
    """The value behind a public name of a module.

    Args:
        module: The module that promises it.
        name: The name.
        promised: All names that the module promises.
        place: Where the value is: "module" or "module:its name there".

    Raises:
        AttributeError: The module does not promise this name.
    """
    if place is None:
        close = get_close_matches(name, promised, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(promised)}"
        raise AttributeError(f"module '{module}' has no attribute '{name}'; {hint}", name=name)
    source, _, own_name = place.partition(":")
    value: object = getattr(import_module(source), own_name or name)
    return value
