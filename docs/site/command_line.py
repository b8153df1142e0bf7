"""The pages of the command line, made from its parser: what `kickctl VERB --help` says."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from functools import partial
from typing import Any

from docs.site import ROOT
from docs.site.markdown import table, toctree
from host.cli import make_parser
from host.perform.catalogue import find
from host.perform.reproduce import claim_ids
from host.runs.columns import Kind, kinds_of

# As many as fit beside both columns of navigation.
COLUMNS = 76
# The verbs whose inner verbs have a page each.
RUNS = ("experiment", "theory")
PICTURES = ROOT / "docs" / "pictures"


def pages(folder: str) -> tuple[dict[str, str], dict[str, str]]:
    """The pages of the verbs, and those below them.

    Args:
        folder: Where they are.

    Returns:
        The overview by its path; all others by theirs.
    """
    parser = make_parser()
    verbs = {f"{folder}{name}.md": _verb(folder, name, verb) for name, verb in inner(parser)}
    runs = {
        f"{folder}{verb}/{name}.md": _run(name, run)
        for verb, parts in inner(parser)
        if verb in RUNS
        for name, run in inner(parts)
    }
    overview = f"# The command line\n\n{_help(parser)}{toctree(verbs)}"
    return {f"{folder}command-line.md": overview}, {**verbs, **runs}


def inner(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """The verbs of a parser, by name; none if it has none."""
    for action in parser._actions:  # noqa: SLF001 - argparse has no other way to list them
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            yield from action.choices.items()


def _verb(folder: str, name: str, parser: argparse.ArgumentParser) -> str:
    parts = [f"# kickctl {name}\n\n{_help(parser)}"]
    if name in RUNS:
        parts.append(toctree(f"{folder}{name}/{run}.md" for run, _ in inner(parser)))
    else:
        parts += (f"## kickctl {name} {part}\n\n{_help(verb)}" for part, verb in inner(parser))
    return "\n".join(parts)


def _help(parser: argparse.ArgumentParser) -> str:
    style: Any = parser.formatter_class
    parser.formatter_class = partial(style, width=COLUMNS)
    try:
        text = parser.format_help()
    finally:  # the program keeps its parser
        parser.formatter_class = style
    pages = re.findall(r"^page: +(\S+)$", text, re.MULTILINE)
    links = "".join(f"\nMore: [](/{page})\n" for page in pages)
    return f"```text\n{text}```\n{links}"


def _run(name: str, parser: argparse.ArgumentParser) -> str:
    found = find(name)
    parts = [f"# {name}\n"]
    if (PICTURES / f"{name}.png").is_file():
        parts.append(f"![What {name} draws](/{PICTURES.relative_to(ROOT)}/{name}.png)\n")
    parts.append(f"{found.entry.help[0].upper()}{found.entry.help[1:]}.\n")
    claims = [claim for claim in claim_ids() if claim in found.entry.claims]
    if claims:
        parts.append(f"[What the paper claims](/docs/claims.md) of it: {', '.join(claims)}.\n")
    kinds = kinds_of(found.work)
    parts.append("## Its tables\n")
    parts += (_kind(f"{name}-{kind.name}" if len(kinds) > 1 else name, kind) for kind in kinds)
    parts.append(f"## Its options\n\n{_help(parser)}")
    return "\n".join(parts)


def _kind(name: str, kind: Kind) -> str:
    columns = [(f"`{column.name}`", column.unit, column.meaning) for column in kind.columns]
    rows = table(("column", "unit", "meaning"), columns)
    return f"### {name}.csv\n\n{kind.meaning}\n\n{rows}"
