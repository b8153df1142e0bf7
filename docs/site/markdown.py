"""Pieces of pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table.

    Args:
        head: What stands above the columns.
        rows: The cells of each row.
    """
    lines = [head, ["---"] * len(head), *rows]
    cells = ([cell.replace("|", "\\|") for cell in line] for line in lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


def toctree(paths: Iterable[str], *, hidden: bool = True) -> str:
    """The pages that are below a page, in order.

    Args:
        paths: Their paths from the root.
        hidden: Whether only the navigation shows them, and not the page.
    """
    shown = ":hidden:" if hidden else ":maxdepth: 1"
    entries = "\n".join("/" + path.removesuffix(".md") for path in paths)
    return f"\n```{{toctree}}\n{shown}\n\n{entries}\n```\n"
