"""The page's files as texts: each alone, and modules with all that they import."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path, PurePosixPath

PAGE_FOLDER = Path(__file__).parent / "page"
# The modules that a page itself names.
FIRST = ("main.js", "replay.js")
_IMPORT = re.compile(r'(\bfrom\s+|\bimport\s+)"(\./[\w./]+)"')
_TAKES = re.compile(r'^import (\{[^}]*\}) from ("[^"]+");$', re.MULTILINE)
_GIVES = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)


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


def one_module(first: str) -> str:
    """A module of the page and all that it imports, as one module.

    A browser that asks for each file by itself spends a fifth of a page's start on that, and over a
    network it waits for one after the other.

    Args:
        first: The module's path in the page's folder.

    Returns:
        The text: first the other modules, each as a function that is called once and returns what
        it exports, and then the module's own.
    """
    newest = max(path.stat().st_mtime_ns for path in PAGE_FOLDER.rglob("*.js"))
    return _one_module(first, newest)


# Of one time only: who changes a module sees that after a reload.
@lru_cache(maxsize=len(FIRST))
def _one_module(first: str, newest: int) -> str:
    *others, (_, own) = page_modules(first).items()
    parts = ["const modules = {};"]
    for name, text in others:
        given = ", ".join(_GIVES.findall(text))
        body = _GIVES.sub("", _taken(text))
        parts.append(f'modules["lab/{name}"] = (() => {{\n{body}return {{ {given} }};\n}})();')
    return "\n\n".join([*parts, _taken(own)])


def _taken(text: str) -> str:
    """A module's text that takes what it imports from the modules before it."""
    return _TAKES.sub(
        lambda found: f"const {found[1].replace(' as ', ': ')} = modules[{found[2]}];", text
    )
