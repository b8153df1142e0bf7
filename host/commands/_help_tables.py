"""The tables that help looks words up in: words, letters, faults, and the pages of the docs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import host
import robot

_WORD = re.compile(r"^\| (.+?) \| (.+) \| `kickctl (.+)` \|$", re.MULTILINE)
_LETTERS = re.compile(r"^\| letter \|.*\n\|[-|]+\n(?:\|.*\n)+", re.MULTILINE)
_FAULT = re.compile(r"^\| (?!what you see)(.+?) \| (.+) \|$", re.MULTILINE)
_FAULTS = "## When it does not move"
_LINK = re.compile(r"\[([^]]+)\]\((?:\.\./)?([^)#]+)[^)]*\)")
_PAGE = re.compile(r"^\| \[(.+?)\]\((.+?)\) \| (.+) \|$", re.MULTILINE)
# Words by which people look for what stands below them, in a comment that pages do not show.
SOUGHT = re.compile(r"^<!-- search: ([^>]+) -->$", re.MULTILINE)
# An installed package has no docs, or another's.
_INDEX_BEGINS = "# The pages\n"


class Page(NamedTuple):
    """A page of the docs.

    Attributes:
        path: From the root of the checkout.
        text: Its title, and what it has.
        sought: More words by which people look for it.
    """

    path: str
    text: str
    sought: str


def words() -> Iterator[tuple[str, str, str]]:
    """Each word of the glossary: the word, its meaning, and a command that shows it."""
    for word, meaning, command in _WORD.findall(_read(host, "GLOSSARY.md")):
        yield word, _plain(meaning), command


def letters() -> Iterator[tuple[str, str]]:
    """Each letter of the model: how it is typed, with its name; what it is.

    The tables are those of docs/model.md, which is also in an installed package.
    """
    for table in _LETTERS.findall(_read(host, "LETTERS.md")):
        head, _, *rows = map(_cells, table.splitlines())
        for cells in rows:
            row = dict(zip(head, cells, strict=True))
            unit = "" if row["unit"] == "1" else row["unit"]
            default = f"{row['default']} if left out" if "default" in row else ""
            own = row.get("of the robot", "").replace("`", "")
            parts = (row["what it is"], unit, default, own and f"of the robot: {own}")
            name = f"{_typed(row['letter'])}, {row['name']}"
            yield name, "; ".join(part for part in parts if part)


def faults() -> Iterator[tuple[str, str]]:
    """What people see or the robot says, and why, and what to do."""
    for seen, remedy in _FAULT.findall(_read(robot, "README.md").partition(_FAULTS)[2]):
        yield seen, _LINK.sub(r"\1 (\2)", remedy)


def pages(root: Path | None = None) -> Iterator[Page]:
    """The pages of the docs; none where the docs are not.

    Args:
        root: The checkout; by default the one that this program runs in.
    """
    root = Path(host.__file__).parents[1] if root is None else root
    try:
        index = (root / "docs" / "README.md").read_text(encoding="utf-8")
    except OSError:
        return
    if not index.startswith(_INDEX_BEGINS):
        return
    for title, link, has in _PAGE.findall(index):
        path = link.removeprefix("../") if link.startswith("../") else f"docs/{link}"
        try:
            text = (root / path).read_text(encoding="utf-8")
        except OSError:
            continue
        yield Page(path, f"{title}: {has}", ", ".join(SOUGHT.findall(text)).replace("\n", " "))


def _read(package: object, name: str) -> str:
    return Path(package.__file__).with_name(name).read_text(encoding="utf-8")  # type: ignore[attr-defined]


def _plain(cell: str) -> str:
    return cell.replace("\\|", "|")


def _cells(row: str) -> list[str]:
    return [cell.strip() for cell in row.strip().strip("|").split("|")]


def _typed(letter: str) -> str:
    r"""A letter as it is typed: phi for 'phi, $\varphi$', F_tan for $F_\mathrm{tan}$."""
    text = re.sub(r"\$\\\w+\$", "", letter)
    text = re.sub(r"\\mathrm|[$^{}]|_(?=[0-9])", "", text)
    return ", ".join(part.strip() for part in text.split(",") if part.strip())
