"""Pieces of pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table.

    Args:
        head: What stands above the columns.
        rows: The cells of each row.
    """
    first, *others = (
        "|" + "".join(f" {cell} |" if cell else " |" for cell in map(_in_table, row))
        for row in (head, *rows)
    )
    return "\n".join([first, "|" + "---|" * len(head), *others, ""])


def _in_table(cell: str) -> str:
    return cell.replace("|", "\\|")


def toctree(paths: Iterable[str], *, hidden: bool = True) -> str:
    """The pages that are below a page, in order.

    Args:
        paths: Their paths from the root.
        hidden: Whether only the navigation shows them, and not the page.
    """
    shown = ":hidden:" if hidden else ":maxdepth: 1"
    entries = "\n".join("/" + path.removesuffix(".md") for path in paths)
    return f"\n```{{toctree}}\n{shown}\n\n{entries}\n```\n"
