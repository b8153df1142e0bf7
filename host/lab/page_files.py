"""The page's files as texts, for where no server has them: a replay in one file, and notebooks."""

from __future__ import annotations

import re
from pathlib import Path, PurePosixPath

PAGE_FOLDER = Path(__file__).parent / "page"
_IMPORT = re.compile(r'(\bfrom\s+|\bimport\s+)"(\./[\w./]+)"')


def page_text(name: str) -> str:
    """The text of one of the page's files."""
    return (PAGE_FOLDER / name).read_text(encoding="utf-8")


def page_modules(first: str) -> dict[str, str]:
    """A module of the page and all that it imports.

    Args:
        first: The module's path in the page's folder.

    Returns:
        Texts by path, each one behind all that it imports. They import each other by names that do
        not depend on the place: lab/PATH.
    """
    modules: dict[str, str] = {}
    _collect(first, modules)
    return modules


def _collect(name: str, modules: dict[str, str]) -> None:
    if name in modules:
        return
    needs: list[str] = []

    def named(found: re.Match[str]) -> str:
        needs.append(str(PurePosixPath(name).parent / found[2]))
        return f'{found[1]}"lab/{needs[-1]}"'

    modules[name] = _IMPORT.sub(named, page_text(name))
    for one in needs:
        _collect(one, modules)
    modules[name] = modules.pop(name)
