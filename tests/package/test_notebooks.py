"""The notebooks run as they are written, with public names only, and end with a picture."""

import ast
import os
import re
import sys

import matplotlib.pyplot as plt
import pytest

from tests.package.conftest import ROOT
from tests.small_figures import small_figures

NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.md"), key=lambda path: path.stem)
# What a reader has who has kickctl, beside Python's own modules.
PUBLIC = {"kickctl", "kickctl.theory", "numpy", "matplotlib.pyplot"}

every_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def cells(path, kind):
    """The texts of a notebook's cells of a kind, 'code' or 'markdown'."""
    # It takes a while, which those who test something else need not wait for.
    with pytest.MonkeyPatch.context() as patch:
        # Most of it would be the grammar of addresses, which jsonschema can do without.
        patch.setitem(sys.modules, "rfc3987_syntax", None)
        from myst_nb.core.read import read_myst_markdown_notebook

    notebook = read_myst_markdown_notebook(path.read_text(encoding="utf-8"))
    return [cell.source for cell in notebook.cells if cell.cell_type == kind]


@pytest.fixture
def pictures():
    """The axes of the pictures that are open; none are at first, nor afterwards."""
    plt.switch_backend("agg")
    yield lambda: [axes for number in plt.get_fignums() for axes in plt.figure(number).axes]
    plt.close("all")


@pytest.fixture
def _as_for_one_reader(monkeypatch):
    """What a notebook sets is forgotten, and a train needs no process of its own.

    Nor does anybody look at the figures beside a run's tables, which may fail in any way.
    """
    monkeypatch.setenv("KICK_MOTORS", "")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0})
    with small_figures():
        yield


@pytest.mark.usefixtures("_as_for_one_reader")
@every_notebook
def test_it_runs_and_ends_with_a_picture(path, pictures):
    names = {"__name__": "__main__"}
    for source in cells(path, "code"):
        plt.close("all")
        exec(compile(source, path.name, "exec"), names)  # noqa: S102 - this is what it is for
    assert pictures()
    for axes in pictures():
        assert axes.has_data()
        axes.figure.canvas.draw()


@every_notebook
def test_it_uses_public_names_only(path):
    tree = ast.parse("\n".join(cells(path, "code")))
    modules = {
        module
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for module in (
            [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names]
        )
    }
    assert {name for name in modules - PUBLIC if name not in sys.stdlib_module_names} == set()


@every_notebook
def test_it_says_what_is_to_be_seen_and_asks_two_questions_with_hints(path):
    first, *_, last = cells(path, "markdown")
    assert re.match(r"# .+\n\n\*\*What you will see:\*\* ", first)
    assert re.search(r"takes (a few|about) ", first)
    exercises = last.partition("## Exercises\n")[2]
    for number in (1, 2):
        assert f"**{number}.** " in exercises
    assert exercises.count("<details><summary>Hint</summary>\n\n") == 2
    assert exercises.count("\n\n</details>") == 2
