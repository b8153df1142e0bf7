"""docs/claims.md and README.md say what `kickctl reproduce` has answered."""

import re

from docs.site.badges import FOLDER, badges
from docs.site.claims import PAGE, counted, load, rendered
from host.perform.reproduce import claim_ids
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import FAILS, HOLDS
from tests.lint.sources import ROOT


def test_the_page_has_what_was_measured():
    page = PAGE.read_text(encoding="utf-8")
    assert page == rendered(page), "write it by: python -m docs.site.claims"
    assert [number for number in claim_ids() if f"\n| {number} | " not in page] == []


def test_the_data_has_every_claim_and_where_it_comes_from():
    answer = load()
    assert [claim["id"] for claim in answer["claims"]] == claim_ids()
    assert answer["skipped"] == {}
    assert answer["commit"]
    assert answer["seed"] == 1


def test_help_has_the_same_sentences():
    assert {claim["id"]: claim["claim"] for claim in load()["claims"]} == SENTENCES


def test_the_readme_counts_them():
    verdicts = [claim["verdict"] for claim in load()["claims"]]
    assert counted() == f"{verdicts.count(HOLDS)} of {len(verdicts)} hold"
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert counted() in " ".join(readme.split())
    assert verdicts.count(FAILS) == 2
    assert "Two do not hold" in readme


def test_the_badges_are_true_and_all_are_shown():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    shown = dict(re.findall(r"!\[(.*?)\]\(docs/pictures/(badge-.*?)\)", readme))
    assert {*shown.values()} == {*badges()}
    for words, name in shown.items():
        svg = (FOLDER / name).read_text(encoding="utf-8")
        assert svg == badges()[name], "write it by: python -m docs.site.badges"
        assert f"<title>{words}</title>" in svg
