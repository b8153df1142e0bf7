"""A section that no wheel crosses says so, and has nothing drawn across the words."""

import pytest

from host.figures.theory.section import draw
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.studies.registry import TABLE
from host.theory.studies.section_report import report
from host.theory.studies.section_rows import NOWHERE

RESTS = {
    **NOWHERE,
    "part": "points",
    "batch": 0,
    "wheel": 0,
    "number": 0,
    "kind": "at rest",
    "period": None,
    "period_s": None,
    "exponent": None,
}
MOVES = {
    **RESTS,
    "kind": "chaotic",
    "section_x1": 0.1,
    "section_x2": 0.2,
    "section_omega": 3.0,
}


@pytest.mark.parametrize(("row", "words", "lines"), [(RESTS, 1, 0), (MOVES, 0, 1)])
def test_the_diagonal_is_drawn_among_points_only(row, words, lines):
    setting = Setting(0, complete_options("section", TABLE["section"], {"k": 0.0}))
    rows = [row, {**row, "number": 1}]
    _, returns, *_ = draw(rows, report(rows, setting)).axes
    assert len(returns.texts) == words
    assert len([line for line in returns.lines if line.get_color() == "grey"]) == lines
