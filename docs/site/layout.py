"""Lays out the pages that Sphinx reads: those of the checkout, and those that tables make."""

from __future__ import annotations

import posixpath
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from docs.site import ROOT
from docs.site.markdown import toctree
from docs.site.reference import pages as reference
from host.commands._help_tables import SOUGHT
from host.experiments.registry import TABLE as EXPERIMENTS
from host.theory.studies.registry import TABLE as STUDIES
from robot import __version__

INDEX = "docs/README.md"
_LINK = re.compile(r"(?<=\]\()(?!\w+:|#)[^)#\s]+(?=[)#])|(?<=src=\")(?!\w+:)[^\"]+")
# Tables whose first column people look for: words, and what a robot shows and says in a fault.
_LOOKED_UP = re.compile(r"^\| (?:word|what you see) \|.*\n\|[-|]+\n(?:\|.*\n)+", re.MULTILINE)
_RUN = re.compile(r"(?<=^\| )`([-\w]+)`(?= \|)", re.MULTILINE)
# What stands above the first picture of the first page.
_BEGIN = f"""\
**Begin with [the first kick in ten minutes](docs/first-kick.md).** These pages are those of release
{__version__}, and of what has come since, which stands first in [the changelog](CHANGELOG.md).

![The rods of a wheel, and a kick that reverses it](docs/rods.gif)

"""
_SECTION = re.compile(r"^## (.+)\n", re.MULTILINE)


def lay_out(target: Path) -> None:
    """Write all pages, and the files that they show or lead to, below a folder.

    Args:
        target: The folder. What else is in it is removed.
    """
    files = {path: text.encode() for path, text in {**_written(), **reference()}.items()}
    for path in tuple(files):
        files |= _linked(path, files)
    shutil.rmtree(target, ignore_errors=True)
    for path, content in files.items():
        file = target / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)


def _written() -> dict[str, str]:
    """The pages that people have written, by their paths; README.md is the first, index.md."""
    index = (ROOT / INDEX).read_text(encoding="utf-8")
    sections = dict(_sections(index))
    listed = [path for rows in sections.values() for path in _targets(INDEX, rows)]
    pages = {
        path: _with_entries(_with_runs((ROOT / path).read_text(encoding="utf-8")))
        for path in listed
    }
    folders = {
        _slug(title): _section(title, _moved(INDEX, rows)) for title, rows in sections.items()
    }
    front = (ROOT / "README.md").read_text(encoding="utf-8")
    return {
        **pages,
        **folders,
        INDEX: "---\norphan: true\n---\n" + index,
        "index.md": front.replace("![", _BEGIN + "![", 1)
        + toctree([*folders, "reference/index.md"]),
    }


def _with_runs(page: str) -> str:
    """A page whose tables lead from the name of an experiment or a study to its own page."""

    def link(found: re.Match[str]) -> str:
        for folder, table in (("experiment", EXPERIMENTS), ("theory", STUDIES)):
            if found[1] in table:
                return f"[{found[0]}](/reference/{folder}/{found[1]}.md)"
        return found[0]

    return _RUN.sub(link, page)


def _with_entries(page: str) -> str:
    """A page whose words the search shows first: those of comments, and of its tables."""

    def with_words(found: re.Match[str]) -> str:
        cells = (row.split("|")[1].strip() for row in found[0].splitlines()[2:])
        words = ",".join(cell.removeprefix("fault: ").replace("`", "") for cell in cells)
        return f"{_entries(words)}\n{found[0]}"

    page = SOUGHT.sub(lambda found: _entries(found[1]), page)
    return _LOOKED_UP.sub(with_words, page)


def _entries(words: str) -> str:
    """Main entries of the index, which the search counts most, for words between commas."""
    return f"```{{index}} {', '.join(f'! {word.strip()}' for word in words.split(','))}\n```\n"


def _sections(index: str) -> Iterator[tuple[str, str]]:
    """Title and text of each section of the index."""
    _, *parts = _SECTION.split(index)
    yield from zip(parts[::2], parts[1::2], strict=True)


def _section(title: str, text: str) -> str:
    return f"# {title}\n\n{text}\n{toctree(_targets('', text))}"


def _slug(title: str) -> str:
    return re.sub(r"\W+", "-", title.lower()) + ".md"


def _targets(page: str, text: str) -> list[str]:
    """The paths, from the root, that the links of a page lead to."""
    folder = posixpath.dirname(page)
    paths = (posixpath.join(folder, link) for link in _LINK.findall(text))
    return [posixpath.normpath(path).lstrip("/") for path in paths]


def _moved(page: str, text: str) -> str:
    """The text of a page as it must be at the root, with its links."""
    folder = posixpath.dirname(page)
    return _LINK.sub(lambda link: posixpath.normpath(posixpath.join(folder, link[0])), text)


def _linked(page: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files of the checkout that a page shows or leads to, by their paths."""
    targets = _targets(page, files[page].decode())
    return {
        path: (ROOT / path).read_bytes()
        for path in targets
        if path not in files and (ROOT / path).is_file()
    }
