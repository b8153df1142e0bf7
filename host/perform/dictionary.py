"""The data dictionary of all experiments and studies, as docs/data.md has it.

`python -m host.perform.dictionary > docs/data.md` writes it.
"""

from __future__ import annotations

from collections.abc import Iterator

from host.perform.catalogue import KINDS, find
from host.runs.columns import Kind, kinds_of

_BEGIN = """\
# The columns of all tables

Each run of `kickctl experiment NAME` and `kickctl theory NAME` writes its rows as CSV. Rows of
several kinds have a table each, NAME-KIND.csv. `columns.csv` beside them has what this page says
about its run. In notebooks `run_experiment(NAME).tables[KIND]` has the columns as arrays.

A number without a unit has the unit 1; words, whole numbers and what is true or false have none.
An empty field is unknown, or does not apply. Where a column has several numbers, they stand in
brackets; a complex number is [real part, imaginary part].
"""


def page() -> str:
    """The page, in Markdown."""
    return "\n".join([_BEGIN, *_sections()])


def _sections() -> Iterator[str]:
    for table, _, _ in KINDS.values():
        for name in table:
            yield f"## {name}\n"
            kinds = kinds_of(find(name).work)
            for kind in kinds:
                yield from _kind(f"{name}-{kind.name}" if len(kinds) > 1 else name, kind)


def _kind(name: str, kind: Kind) -> Iterator[str]:
    yield f"### {name}.csv\n\n{kind.meaning}\n"
    yield "| column | unit | meaning |\n|---|---|---|"
    for column in kind.columns:
        cells = (cell.replace("|", "\\|") for cell in column)
        yield f"| {' | '.join(cells)} |".replace("  ", " ")
    yield ""


if __name__ == "__main__":
    print(page(), end="")
