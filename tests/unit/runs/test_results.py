"""A run's results in a notebook: the summary, tables as arrays, and what they show."""

import numpy as np

from host.perform.run import perform
from host.runs.results import Results
from tests.small_figures import small_figures


def test_tables_have_numbers_words_and_what_is_unknown():
    rows = [
        {"k": 1, "omega": None, "kind": "rest", "pairs": [[1.0, 2.0]], "why": None},
        {"k": 2, "omega": 2.5, "kind": "rolls", "pairs": [], "why": "slow"},
    ]
    table = Results(rows, [], {}).tables[""]
    assert table["k"].dtype.kind == "i"
    assert np.array_equal(table["omega"], [np.nan, 2.5], equal_nan=True)
    assert table["kind"].tolist() == ["rest", "rolls"]
    assert table["pairs"].tolist() == [[[1.0, 2.0]], []]
    assert table["why"].tolist() == [None, "slow"]


def test_a_run_returns_its_tables_beside_its_files(tmp_path):
    with small_figures():
        found = perform("hopf", out=tmp_path)
    assert sorted(path.name for path in tmp_path.glob("theory/*/*.csv")) == [
        "columns.csv",
        "hopf-line.csv",
        "hopf-point.csv",
    ]
    assert found["numbers"]["k_hopf"] == found.tables["point"]["k_hopf"][0]
    assert len(found.tables["line"]["tau"]) == 102
    assert "Hopf bifurcation at k" in repr(found)
    assert "table line: 102 rows" in repr(found)
    columns = next(tmp_path.glob("theory/*/columns.csv")).read_text(encoding="utf-8")
    assert "hopf-line.csv,tau,s,time constant of the membrane potentials" in columns
